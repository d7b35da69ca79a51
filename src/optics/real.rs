//! The number type of the optics: f32 to render with, f64 as the tests' oracle, and SIMD lanes of eight or sixteen f32
//! ([`lanes`](super::lanes)), with which the CPU renders.
//!
//! Comparisons return a [`Mask`], and selections use [`Real::select`]. Code generic over [`Real`] serves all three: its
//! branches test whether a mask holds in *any* lane, and `select` keeps each lane's value. Code for one number at a time is
//! generic over [`Scalar`]; lanes call it one by one.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Index, Mul, Neg, Not, Sub};

/// Functions of numbers, each of them inlined into what is compiled for the lanes' instruction set ([`Real::vectorize`]):
/// elsewhere an operation on lanes is a call.
macro_rules! inlined {
    ($($(#[$doc:meta])* $of:vis fn $name:ident
        $(<$lifetime:lifetime>)? $(<$($generic:ident $(: $bound:ident $(+ $more:ident)*)?),+>)? ($($argument:tt)*) $(-> $result:ty)?
        $body:block)*) => {
        $(
            $(#[$doc])*
            #[inline(always)]
            $of fn $name $(<$lifetime>)? $(<$($generic $(: $bound $(+ $more)*)?),+>)? ($($argument)*) $(-> $result)? $body
        )*
    };
}
pub(crate) use inlined;

/// [`Real::vectorize`] for an expression.
macro_rules! vectorized {
    ($number:ident, $body:expr) => {
        $number::vectorize(
            #[inline(always)]
            || $body,
        )
    };
}
pub(crate) use vectorized;

/// A list whose items an expression follows from. The library's `map` of an array may not be inlined, and then falls out of
/// lanes.
macro_rules! mapped {
    ([$($item:expr),+ $(,)?], |$of:pat_param| $value:expr) => {
        [$({
            let $of = $item;
            $value
        }),+]
    };
}
pub(crate) use mapped;

/// [`Real::out_of_line`] for an expression.
macro_rules! out_of_line {
    ($number:ident, $body:expr) => {
        $number::out_of_line(
            #[inline(always)]
            || $body,
        )
    };
}
pub(crate) use out_of_line;

/// The outcome of a comparison: `bool`, or one truth value a lane.
pub trait Mask:
    Copy + Debug + Send + Sync + 'static + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// The same in each lane.
    fn splat(value: bool) -> Self;
    /// The truth values of the lanes, the first one in the lowest bit.
    fn from_bits(bits: u32) -> Self;
    /// The inverse of [`Mask::from_bits`]; 0 beyond the last lane.
    fn to_bits(self) -> u32;
    /// True where any lane is true.
    fn any(self) -> bool;
    /// True where all lanes are.
    fn all(self) -> bool;
}

/// A real number, or one per lane, with the elementary functions that the optics need.
pub trait Real:
    Copy
    + Debug
    + Default
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
{
    /// Result type of comparisons.
    type Mask: Mask;
    /// The number in one lane.
    type Scalar: Scalar;
    /// Something for each lane.
    type Each<E: Copy + Default>: Copy + AsRef<[E]> + Index<usize, Output = E>;

    const LANES: usize;
    const ZERO: Self;
    const ONE: Self;
    const TWO: Self;
    const HALF: Self;
    const TAU: Self;
    const FRAC_1_PI: Self;

    /// The nearest value of this type, the same in each lane.
    fn from_f64(value: f64) -> Self;
    /// `self < other`.
    fn less(self, other: Self) -> Self::Mask;
    /// `if_true` where the mask holds, else `if_false`.
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self;
    /// Minimum; `other` if either is NaN, as a single instruction computes it.
    fn min(self, other: Self) -> Self;
    /// Maximum; `other` if either is NaN.
    fn max(self, other: Self) -> Self;
    fn abs(self) -> Self;
    /// Square root of a number that is not negative.
    fn sqrt(self) -> Self;
    /// Sine of an angle in radians, of some turns at most.
    fn sin(self) -> Self;
    /// Cosine of an angle in radians, of some turns at most.
    fn cos(self) -> Self;
    /// e to the power of `self`.
    fn exp(self) -> Self;
    fn ln(self) -> Self;
    /// Positive `self` to the power of `exponent`.
    fn powf(self, exponent: Self) -> Self;
    /// The angle of the vector (`other`, `self`), both finite, in radians, in [−π, π].
    fn atan2(self, other: Self) -> Self;
    /// The largest integer that is not above `self`.
    fn floor(self) -> Self;

    /// The results of `f` per lane.
    fn each<E: Copy + Default>(f: impl FnMut(usize) -> E) -> Self::Each<E>;
    /// The numbers of the lanes.
    fn from_each(numbers: &Self::Each<Self::Scalar>) -> Self;
    /// The numbers of the lanes.
    fn to_each(self) -> Self::Each<Self::Scalar>;
    /// The numbers towards zero as whole ones, limited to their range; 0 for NaN.
    fn to_integers(self) -> Self::Each<i32>;
    /// The first numbers of a list, which has as many as there are lanes or more.
    fn load(numbers: &[Self::Scalar]) -> Self;
    /// Stores the lanes at the start of a slice.
    fn store(self, numbers: &mut [Self::Scalar]);
    /// Runs `f`, compiled for the lanes' instruction set. A function that is not inlined must start with it, because its
    /// caller is compiled for other instructions; all that it calls must be inlined (`benches/lanes`).
    fn vectorize<R>(f: impl FnOnce() -> R) -> R;

    /// Runs `f` out of line: it is compiled once per number type, however many callers it has. A compiler's time grows
    /// faster than the size of a function (docs/BUILD.md).
    #[inline(never)]
    fn out_of_line<R>(f: impl FnOnce() -> R) -> R {
        Self::vectorize(f)
    }

    inlined! {
        /// A whole number, exact below 2²⁴.
        fn from_count(value: u32) -> Self {
            Self::from_f64(f64::from(value))
        }
        /// `self` limited to [`low`, `high`].
        fn clamp(self, low: Self, high: Self) -> Self {
            self.max(low).min(high)
        }
        /// √max(0, x), for values that rounding may have made negative.
        fn safe_sqrt(self) -> Self {
            self.max(Self::ZERO).sqrt()
        }
        fn above_zero(self) -> Self::Mask {
            Self::ZERO.less(self)
        }
        fn below_zero(self) -> Self::Mask {
            self.less(Self::ZERO)
        }
        /// The number where the mask holds, else 0.
        fn masked(self, mask: Self::Mask) -> Self {
            Self::select(mask, self, Self::ZERO)
        }
        /// `self ≠ other`; false if either is NaN.
        fn differs(self, other: Self) -> Self::Mask {
            self.less(other) | other.less(self)
        }
        fn is_nan(self) -> Self::Mask {
            !(self.less(Self::ONE) | self.above_zero())
        }
        /// The number of one lane.
        fn lane(self, lane: usize) -> Self::Scalar {
            self.to_each()[lane]
        }
        /// The numbers that `f` says for the lanes.
        fn from_lanes(f: impl FnMut(usize) -> Self::Scalar) -> Self {
            Self::from_each(&Self::each(f))
        }
        /// The numbers of a table at places that are whole and within it.
        fn look_up(table: &[f32], place: Self) -> Self {
            let places = place.to_integers();
            Self::from_lanes(|lane| Self::Scalar::from_f64(f64::from(table[places[lane] as usize])))
        }
    }
}

/// A single number.
pub trait Scalar: Real<Mask = bool, Scalar = Self, Each<Self> = [Self; 1]> + PartialOrd {
    /// The value as f64, exact for f32.
    fn to_f64(self) -> f64;
}
