//! SIMD lanes: vectors of eight or sixteen f32, with which the CPU renders if it has AVX2 or better, or NEON. Each lane
//! equals f32 to the last bit with any instruction set.
//!
//! Code on lanes must be compiled for their instruction set, or each operation is a call and costs ten times as much:
//! [`in_lanes`] is the entry, and [`Real::vectorize`] is for functions within.

use std::fmt;
use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use fearless_simd::{Bytes, Level, Select, Simd, SimdBase, SimdFloat, SimdInt, SimdMask};

use super::elementary::{self, Bits, Single, functions};
use super::real::{Mask, Real, inlined};

/// A computation that is generic over SIMD lanes. A trait, because closures cannot be generic.
pub trait InLanes {
    /// Result type.
    type Output;
    /// Runs the computation with `T` as lanes.
    fn run<T: Single>(self) -> Self::Output;
}

/// Does something with numbers in lanes, computed by the instruction set of `level`.
pub fn in_lanes<I: InLanes>(level: Level, what: I) -> I::Output {
    match level {
        #[cfg(target_arch = "x86_64")]
        Level::Avx512(_) => what.run::<sixteen::Lanes<fearless_simd::Avx512>>(),
        // Sixteen lanes would take two of AVX2's sixteen registers each, too few for shading.
        #[cfg(target_arch = "x86_64")]
        Level::Avx2(_) => what.run::<eight::Lanes<fearless_simd::Avx2>>(),
        #[cfg(target_arch = "aarch64")]
        Level::Neon(_) => what.run::<sixteen::Lanes<fearless_simd::Neon>>(),
        // Lanes of four numbers would gain little over one, and take four times the code.
        _ => what.run::<f32>(),
    }
}

/// The proof that an instruction set is there, which [`in_lanes`] was given.
#[inline(always)]
fn token<S: Simd>() -> S {
    const { assert!(size_of::<S>() == 0) };
    // SAFETY: the token has no bytes. Only `in_lanes` names `Lanes<S>`, where the level proves that S is available.
    unsafe { std::mem::zeroed() }
}

/// What has one function of two, by an operator.
macro_rules! operators {
    ($of:ident: $($trait:ident $function:ident $operator:tt)*) => {
        $(
            impl<S: Simd> $trait for $of<S> {
                type Output = Self;
                inlined! {
                    fn $function(self, other: Self) -> Self { Self(self.0 $operator other.0) }
                }
            }
        )*
    };
}

/// A module of as many numbers, by the types of the numbers, their whole numbers, their bits and their truth values.
macro_rules! lanes {
    ($module:ident: $lanes:literal $numbers:ident $whole:ident $words:ident $truths:ident) => {
        mod $module {
            use fearless_simd::{$numbers, $truths, $whole, $words};

            use super::*;

            /// Numbers that go side by side.
            const LANES: usize = $lanes;

            /// The numbers. Only [`in_lanes`] makes them, for an instruction set that is there.
            #[derive(Clone, Copy)]
            pub struct Lanes<S: Simd>($numbers<S>);

            /// One truth value a lane.
            #[derive(Clone, Copy)]
            pub struct Truths<S: Simd>($truths<S>);

            /// The bits of the numbers.
            #[derive(Clone, Copy)]
            pub struct Words<S: Simd>($words<S>);

            operators!(Lanes: Add add + Sub sub - Mul mul * Div div /);
            operators!(Truths: BitAnd bitand & BitOr bitor |);

            impl<S: Simd> Not for Truths<S> {
                type Output = Self;
                inlined! {
                    fn not(self) -> Self { Self(!self.0) }
                }
            }

            impl<S: Simd> fmt::Debug for Truths<S> {
                fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                    write!(f, "{:0LANES$b}", self.0.to_bitmask())
                }
            }

            impl<S: Simd> Mask for Truths<S> {
                inlined! {
                    fn splat(value: bool) -> Self { Self($truths::splat(token(), value)) }
                    fn from_bits(bits: u32) -> Self { Self($truths::from_bitmask(token(), u64::from(bits))) }
                    fn to_bits(self) -> u32 { self.0.to_bitmask() as u32 }
                    fn any(self) -> bool { self.0.any_true() }
                    fn all(self) -> bool { self.0.all_true() }
                }
            }

            impl<S: Simd> Neg for Lanes<S> {
                type Output = Self;
                inlined! {
                    fn neg(self) -> Self { Self(-self.0) }
                }
            }

            impl<S: Simd> AddAssign for Lanes<S> {
                inlined! {
                    fn add_assign(&mut self, other: Self) { *self = *self + other; }
                }
            }

            impl<S: Simd> Default for Lanes<S> {
                inlined! {
                    fn default() -> Self { Self::ZERO }
                }
            }

            impl<S: Simd> fmt::Debug for Lanes<S> {
                fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                    self.0.as_slice().fmt(f)
                }
            }

            impl<S: Simd> Lanes<S> {
                /// The same number in each lane, as a constant.
                const fn constant(value: f32) -> Self {
                    const { assert!(size_of::<Self>() == size_of::<[f32; LANES]>()) };
                    // SAFETY: of the same size, which the numbers fill, as the token has no bytes.
                    unsafe { std::mem::transmute_copy(&[value; LANES]) }
                }
            }

            impl<S: Simd> Real for Lanes<S> {
                type Mask = Truths<S>;
                type Scalar = f32;
                type Each<E: Copy + Default> = [E; LANES];
                const LANES: usize = LANES;
                const ZERO: Self = Self::constant(0.0);
                const ONE: Self = Self::constant(1.0);
                const TWO: Self = Self::constant(2.0);
                const HALF: Self = Self::constant(0.5);
                const TAU: Self = Self::constant(std::f64::consts::TAU as f32);
                const FRAC_1_PI: Self = Self::constant(std::f64::consts::FRAC_1_PI as f32);

                inlined! {
                    fn from_f64(value: f64) -> Self { Self($numbers::splat(token(), value as f32)) }
                    fn less(self, other: Self) -> Truths<S> { Truths(self.0.simd_lt(other.0)) }
                    fn select(mask: Truths<S>, if_true: Self, if_false: Self) -> Self {
                        Self(mask.0.select(if_true.0, if_false.0))
                    }
                    fn min(self, other: Self) -> Self {
                        // Other CPUs' instructions return NaN for a NaN on either side.
                        if cfg!(target_arch = "x86_64") {
                            Self(self.0.min(other.0))
                        } else {
                            Self::select(self.less(other), self, other)
                        }
                    }
                    fn max(self, other: Self) -> Self {
                        if cfg!(target_arch = "x86_64") {
                            Self(self.0.max(other.0))
                        } else {
                            Self::select(other.less(self), self, other)
                        }
                    }
                    fn abs(self) -> Self { Self(self.0.abs()) }
                    fn sqrt(self) -> Self { Self(self.0.sqrt()) }
                    fn floor(self) -> Self { Self(self.0.floor()) }
                    fn each<E: Copy + Default>(mut f: impl FnMut(usize) -> E) -> [E; LANES] {
                        let mut all = [E::default(); LANES];
                        let mut lane = 0;
                        while lane < LANES {
                            all[lane] = f(lane);
                            lane += 1;
                        }
                        all
                    }
                    fn from_each(numbers: &[f32; LANES]) -> Self { Self($numbers::load_array_ref(token(), numbers)) }
                    fn to_each(self) -> [f32; LANES] { self.0.to_array() }
                    fn to_integers(self) -> [i32; LANES] {
                        let whole: $whole<S> = self.0.to_int_precise();
                        whole.to_array()
                    }
                    fn load(numbers: &[f32]) -> Self { Self($numbers::from_slice(token(), &numbers[..LANES])) }
                    fn store(self, numbers: &mut [f32]) { self.0.store_slice(&mut numbers[..LANES]); }
                    fn vectorize<R>(f: impl FnOnce() -> R) -> R { token::<S>().vectorize(f) }
                }
                functions!(elementary);
            }

            impl<S: Simd> Single for Lanes<S> {
                type Bits = Words<S>;
                inlined! {
                    fn to_bits(self) -> Words<S> { Words(self.0.bitcast()) }
                    fn from_bits(bits: Words<S>) -> Self { Self(bits.0.bitcast()) }
                    fn to_whole(self) -> Words<S> {
                        let whole: $whole<S> = self.0.to_int();
                        Words(whole.bitcast())
                    }
                    fn from_whole(whole: Words<S>) -> Self {
                        let whole: $whole<S> = whole.0.bitcast();
                        Self(whole.to_float())
                    }
                    fn round_ties_even(self) -> Self { Self(self.0.round_ties_even()) }
                }
            }

            impl<S: Simd> Bits for Words<S> {
                inlined! {
                    fn splat(word: u32) -> Self { Self($words::splat(token(), word)) }
                    fn plus(self, other: Self) -> Self { Self(self.0 + other.0) }
                    fn and(self, other: Self) -> Self { Self(self.0 & other.0) }
                    fn or(self, other: Self) -> Self { Self(self.0 | other.0) }
                    fn xor(self, other: Self) -> Self { Self(self.0 ^ other.0) }
                    fn left(self, by: u32) -> Self { Self(self.0 << by) }
                    fn right(self, by: u32) -> Self { Self(self.0 >> by) }
                }
            }
        }
    };
}

lanes!(eight: 8 f32x8 i32x8 u32x8 mask32x8);
lanes!(sixteen: 16 f32x16 i32x16 u32x16 mask32x16);
