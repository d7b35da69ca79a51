//! SIMD lanes: vectors of eight or sixteen f32, with which the CPU renders if it has AVX2 or better, or NEON. Each lane
//! equals f32 to the last bit with any instruction set.
//!
//! Code on lanes must be compiled for their instruction set, or each operation is a call and costs ten times as much:
//! [`in_lanes`] is the entry, and [`Real::vectorize`] is for functions within.

use std::fmt;
use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use fearless_simd::{Bytes, Level, Select, Simd, SimdBase, SimdFloat, SimdInt, SimdMask};

use super::elementary::{Bits, Single, by_arithmetic};
use super::real::{Mask, Real};

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

macro_rules! operator {
    ($trait:ident, $function:ident, $operator:tt) => {
        impl<S: Simd> $trait for Lanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                Self(self.0 $operator other.0)
            }
        }
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
            pub(super) struct Lanes<S: Simd>($numbers<S>);

            /// One truth value a lane.
            #[derive(Clone, Copy)]
            pub(super) struct Truths<S: Simd>($truths<S>);

            impl<S: Simd> BitAnd for Truths<S> {
                type Output = Self;
                #[inline(always)]
                fn bitand(self, other: Self) -> Self {
                    Self(self.0 & other.0)
                }
            }

            impl<S: Simd> BitOr for Truths<S> {
                type Output = Self;
                #[inline(always)]
                fn bitor(self, other: Self) -> Self {
                    Self(self.0 | other.0)
                }
            }

            impl<S: Simd> Not for Truths<S> {
                type Output = Self;
                #[inline(always)]
                fn not(self) -> Self {
                    Self(!self.0)
                }
            }

            impl<S: Simd> fmt::Debug for Truths<S> {
                fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                    write!(f, "{:0LANES$b}", self.0.to_bitmask())
                }
            }

            impl<S: Simd> Mask for Truths<S> {
                #[inline(always)]
                fn splat(value: bool) -> Self {
                    Self($truths::splat(token(), value))
                }
                #[inline(always)]
                fn from_bits(bits: u32) -> Self {
                    Self($truths::from_bitmask(token(), u64::from(bits)))
                }
                #[inline(always)]
                fn to_bits(self) -> u32 {
                    self.0.to_bitmask() as u32
                }
                #[inline(always)]
                fn any(self) -> bool {
                    self.0.any_true()
                }
                #[inline(always)]
                fn all(self) -> bool {
                    self.0.all_true()
                }
            }

            operator!(Add, add, +);
            operator!(Sub, sub, -);
            operator!(Mul, mul, *);
            operator!(Div, div, /);

            impl<S: Simd> Neg for Lanes<S> {
                type Output = Self;
                #[inline(always)]
                fn neg(self) -> Self {
                    Self(-self.0)
                }
            }

            impl<S: Simd> AddAssign for Lanes<S> {
                #[inline(always)]
                fn add_assign(&mut self, other: Self) {
                    *self = *self + other;
                }
            }

            impl<S: Simd> Default for Lanes<S> {
                #[inline(always)]
                fn default() -> Self {
                    Self::from_f64(0.0)
                }
            }

            impl<S: Simd> fmt::Debug for Lanes<S> {
                fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                    self.0.as_slice().fmt(f)
                }
            }

            impl<S: Simd> Real for Lanes<S> {
                type Mask = Truths<S>;
                type Scalar = f32;
                type Each<E: Copy + Default> = [E; LANES];
                const LANES: usize = LANES;

                #[inline(always)]
                fn from_f64(value: f64) -> Self {
                    Self($numbers::splat(token(), value as f32))
                }
                #[inline(always)]
                fn less(self, other: Self) -> Truths<S> {
                    Truths(self.0.simd_lt(other.0))
                }
                #[inline(always)]
                fn select(mask: Truths<S>, if_true: Self, if_false: Self) -> Self {
                    Self(mask.0.select(if_true.0, if_false.0))
                }
                #[inline(always)]
                fn min(self, other: Self) -> Self {
                    // Other CPUs' instructions return NaN for a NaN on either side.
                    if cfg!(target_arch = "x86_64") {
                        Self(self.0.min(other.0))
                    } else {
                        Self::select(self.less(other), self, other)
                    }
                }
                #[inline(always)]
                fn max(self, other: Self) -> Self {
                    if cfg!(target_arch = "x86_64") {
                        Self(self.0.max(other.0))
                    } else {
                        Self::select(other.less(self), self, other)
                    }
                }
                #[inline(always)]
                fn abs(self) -> Self {
                    Self(self.0.abs())
                }
                #[inline(always)]
                fn sqrt(self) -> Self {
                    Self(self.0.sqrt())
                }
                #[inline(always)]
                fn floor(self) -> Self {
                    Self(self.0.floor())
                }
                #[inline(always)]
                fn each<E: Copy + Default>(mut f: impl FnMut(usize) -> E) -> [E; LANES] {
                    let mut all = [E::default(); LANES];
                    let mut lane = 0;
                    while lane < LANES {
                        all[lane] = f(lane);
                        lane += 1;
                    }
                    all
                }
                #[inline(always)]
                fn from_each(numbers: &[f32; LANES]) -> Self {
                    Self($numbers::load_array_ref(token(), numbers))
                }
                #[inline(always)]
                fn to_each(self) -> [f32; LANES] {
                    self.0.to_array()
                }
                #[inline(always)]
                fn load(numbers: &[f32]) -> Self {
                    Self($numbers::from_slice(token(), &numbers[..LANES]))
                }
                #[inline(always)]
                fn store(self, numbers: &mut [f32]) {
                    self.0.store_slice(&mut numbers[..LANES]);
                }
                #[inline(always)]
                fn vectorize<R>(f: impl FnOnce() -> R) -> R {
                    token::<S>().vectorize(f)
                }
                by_arithmetic! { Self }
            }

            impl<S: Simd> Single for Lanes<S> {
                type Bits = Words<S>;
                #[inline(always)]
                fn to_bits(self) -> Words<S> {
                    Words(self.0.bitcast())
                }
                #[inline(always)]
                fn from_bits(bits: Words<S>) -> Self {
                    Self(bits.0.bitcast())
                }
                #[inline(always)]
                fn to_whole(self) -> Words<S> {
                    let whole: $whole<S> = self.0.to_int();
                    Words(whole.bitcast())
                }
                #[inline(always)]
                fn from_whole(whole: Words<S>) -> Self {
                    let whole: $whole<S> = whole.0.bitcast();
                    Self(whole.to_float())
                }
                #[inline(always)]
                fn round_ties_even(self) -> Self {
                    Self(self.0.round_ties_even())
                }
            }

            /// The bits of the numbers.
            #[derive(Clone, Copy)]
            pub(super) struct Words<S: Simd>($words<S>);

            impl<S: Simd> Bits for Words<S> {
                #[inline(always)]
                fn splat(word: u32) -> Self {
                    Self($words::splat(token(), word))
                }
                #[inline(always)]
                fn plus(self, other: Self) -> Self {
                    Self(self.0 + other.0)
                }
                #[inline(always)]
                fn and(self, other: Self) -> Self {
                    Self(self.0 & other.0)
                }
                #[inline(always)]
                fn or(self, other: Self) -> Self {
                    Self(self.0 | other.0)
                }
                #[inline(always)]
                fn xor(self, other: Self) -> Self {
                    Self(self.0 ^ other.0)
                }
                #[inline(always)]
                fn left<const BY: u32>(self) -> Self {
                    Self(self.0 << BY)
                }
                #[inline(always)]
                fn right<const BY: u32>(self) -> Self {
                    Self(self.0 >> BY)
                }
            }
        }
    };
}

lanes!(eight: 8 f32x8 i32x8 u32x8 mask32x8);
lanes!(sixteen: 16 f32x16 i32x16 u32x16 mask32x16);
