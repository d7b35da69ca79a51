//! Elementary functions of f32 in plain arithmetic: the same bits on every CPU, scalar and in SIMD lanes, and faster than
//! the system's, whose calls block inlining and vectorisation. The GPU has its own; f64, the oracle, uses the system's.
//!
//! No operations are fused, so that results do not depend on FMA support. Polynomials for the exponential, the logarithm,
//! sine and cosine: Moshier's Cephes library (1989).

use std::f32::consts::{FRAC_2_PI, FRAC_PI_2, LOG2_E, PI};

use super::real::{Real, inlined};

/// A number in single precision, or several in lanes, with its bits.
pub trait Single: Real<Scalar = f32> {
    /// Unsigned integer with the number's bits.
    type Bits: Bits;
    fn to_bits(self) -> Self::Bits;
    /// The inverse of [`Single::to_bits`].
    fn from_bits(bits: Self::Bits) -> Self;
    /// An integral number as a signed integer; arbitrary if it does not fit.
    fn to_whole(self) -> Self::Bits;
    /// The inverse of [`Single::to_whole`].
    fn from_whole(whole: Self::Bits) -> Self;
    /// The nearest whole number.
    fn round_ties_even(self) -> Self;
}

/// 32 bits, or those of each lane.
pub trait Bits: Copy {
    /// The same in each lane.
    fn splat(word: u32) -> Self;
    /// The sum modulo 2³².
    fn plus(self, other: Self) -> Self;
    /// The bits that both have.
    fn and(self, other: Self) -> Self;
    /// The bits that either has.
    fn or(self, other: Self) -> Self;
    /// The bits that one of the two has.
    fn xor(self, other: Self) -> Self;
    /// Moved towards the high end.
    fn left(self, by: u32) -> Self;
    /// Moved towards the low end, zeros behind.
    fn right(self, by: u32) -> Self;
}

impl Single for f32 {
    type Bits = u32;
    inlined! {
        fn to_bits(self) -> u32 { f32::to_bits(self) }
        fn from_bits(bits: u32) -> Self { f32::from_bits(bits) }
        fn to_whole(self) -> u32 { self as i32 as u32 }
        fn from_whole(whole: u32) -> Self { whole as i32 as f32 }
        fn round_ties_even(self) -> Self { f32::round_ties_even(self) }
    }
}

impl Bits for u32 {
    inlined! {
        fn splat(word: u32) -> Self { word }
        fn plus(self, other: Self) -> Self { self.wrapping_add(other) }
        fn and(self, other: Self) -> Self { self & other }
        fn or(self, other: Self) -> Self { self | other }
        fn xor(self, other: Self) -> Self { self ^ other }
        fn left(self, by: u32) -> Self { self << by }
        fn right(self, by: u32) -> Self { self >> by }
    }
}

const SIGN: u32 = 1 << 31;

#[inline(always)]
fn c<T: Real>(value: f32) -> T {
    T::from_f64(f64::from(value))
}

/// A polynomial, its coefficients from the highest power down to that of x⁰.
#[inline(always)]
fn polynomial<T: Real, const N: usize>(x: T, coefficients: [f32; N]) -> T {
    let mut sum = c::<T>(coefficients[0]);
    let mut i = 1;
    while i < N {
        sum = sum * x + c(coefficients[i]);
        i += 1;
    }
    sum
}

/// π/2 in three parts, of which multiples by small whole numbers are exact.
const FRAC_PI_2_PARTS: [f32; 3] = [1.570_312_5, 4.837_513e-4, 7.549_79e-8];

inlined! {
    /// Sine and cosine of an angle in radians, of some turns at most: within two units in the last place.
    fn sin_cos<T: Single>(angle: T) -> [T; 2] {
        let quarters = (angle * c(FRAC_2_PI)).round_ties_even();
        let [high, middle, low] = FRAC_PI_2_PARTS;
        let x = ((angle - quarters * c(high)) - quarters * c(middle)) - quarters * c(low);
        let square = x * x;
        let sine = polynomial(square, [-1.951_529_6e-4, 8.332_161e-3, -0.166_666_55]) * square * x + x;
        let cosine = polynomial(square, [2.443_315_7e-5, -1.388_731_6e-3, 4.166_664_6e-2]) * (square * square)
            - c::<T>(0.5) * square
            + T::ONE;
        let quarter = quarters.to_whole();
        let is_odd = T::from_whole(quarter.and(Bits::splat(1))).above_zero();
        // The second half of the turn is negative; of the cosine a quarter sooner.
        let sine_sign = quarter.and(Bits::splat(2)).left(30);
        let cosine_sign = quarter.plus(Bits::splat(1)).and(Bits::splat(2)).left(30);
        [
            T::from_bits(T::select(is_odd, cosine, sine).to_bits().xor(sine_sign)),
            T::from_bits(T::select(is_odd, sine, cosine).to_bits().xor(cosine_sign)),
        ]
    }

    /// See [`Real::sin`].
    pub fn sin<T: Single>(angle: T) -> T {
        sin_cos(angle)[0]
    }

    /// See [`Real::cos`].
    pub fn cos<T: Single>(angle: T) -> T {
        sin_cos(angle)[1]
    }
}

/// The exponents between which e to their power is a normal number.
const EXPONENTS: [f32; 2] = [-87.336_54, 88.722_83];

inlined! {
    /// Exponential, within two units in the last place; 0 below the smallest normal number.
    pub fn exp<T: Single>(x: T) -> T {
        let [low, high] = EXPONENTS;
        let within = x.max(c(low)).min(c(high));
        let doublings = (within * c(LOG2_E)).round_ties_even();
        let rest = (within - doublings * c(0.693_359_4)) - doublings * c(-2.121_944_4e-4);
        let series = polynomial(
            rest,
            [
                1.987_569_2e-4,
                1.398_2e-3,
                8.333_452e-3,
                4.166_579_6e-2,
                0.166_666_65,
                0.5,
            ],
        );
        let grown = series * (rest * rest) + rest + T::ONE;
        // In two steps, because one factor alone would overflow.
        let first = (doublings * c(0.5)).floor();
        let value = grown * power_of_two(first) * power_of_two(doublings - first);
        let value = T::select(x.less(c(low)), T::ZERO, value);
        let value = T::select(c::<T>(high).less(x), c(f32::INFINITY), value);
        T::select(x.is_nan(), x, value)
    }

    /// 2 to a whole power of at most 127 and at least -126.
    fn power_of_two<T: Single>(power: T) -> T {
        T::from_bits(power.to_whole().plus(Bits::splat(127)).left(23))
    }
}

/// The mantissa's bits, and those of √½, where its range starts.
const MANTISSA: u32 = 0x007f_ffff;
const ROOT_HALF: u32 = 0x3f35_04f3;

inlined! {
    /// The natural logarithm, within two units in the last place; minus infinity for 0, no number for less.
    pub fn ln<T: Single>(x: T) -> T {
        // Numbers that are not normal are made so.
        let is_small = x.less(c(f32::MIN_POSITIVE));
        let raised = T::select(is_small, x * c(8_388_608.0), x);
        let bits = raised.to_bits().plus(Bits::splat(0_u32.wrapping_sub(ROOT_HALF)));
        // The exponent is negative if the sum above wrapped: an offset keeps its sign.
        let exponent = T::from_whole(bits.plus(Bits::splat(1 << 30)).right(23)) - c(128.0);
        let exponent = T::select(is_small, exponent - c(23.0), exponent);
        let m = T::from_bits(bits.and(Bits::splat(MANTISSA)).plus(Bits::splat(ROOT_HALF))) - T::ONE;
        let square = m * m;
        let series = polynomial(
            m,
            [
                7.037_683_6e-2,
                -0.115_146_1,
                0.116_769_99,
                -0.124_201_41,
                0.142_493_23,
                -0.166_680_58,
                0.200_007_15,
                -0.249_999_94,
                0.333_333_3,
            ],
        );
        let tail = series * m * square + exponent * c(-2.121_944_4e-4) - c::<T>(0.5) * square;
        let value = m + tail + exponent * c(0.693_359_4);
        let value = T::select(x.less(c(f32::INFINITY)), value, x);
        let is_positive = x.above_zero();
        let is_zero = !(x.differs(T::ZERO) | x.is_nan());
        let nothing = T::select(is_zero, c(f32::NEG_INFINITY), c(f32::NAN));
        T::select(is_positive, value, nothing)
    }

    /// Positive `base` to the power of `exponent`, within two units in the last place.
    pub fn powf<T: Single>(base: T, exponent: T) -> T {
        let (bases, exponents) = (base.to_each(), exponent.to_each());
        T::from_lanes(|lane| power(f64::from(bases[lane]), f64::from(exponents[lane])) as f32)
    }
}

/// The same in f64, because an exponent of a thousand would magnify the error of an f32 logarithm as much. Branchless, so
/// that compilers vectorise it.
#[inline(always)]
fn power(base: f64, exponent: f64) -> f64 {
    /// 1.5 · 2⁵²: adding it leaves the nearest integer in the lowest bits.
    const WHOLE: f64 = 6_755_399_441_055_744.0;
    const ROOT_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
    const LN_2: f64 = std::f64::consts::LN_2;
    let bits = base.to_bits().wrapping_sub(ROOT_HALF);
    let doublings = ((bits as i64) >> 52) as i32;
    let mantissa = f64::from_bits((bits & 0x000f_ffff_ffff_ffff).wrapping_add(ROOT_HALF));
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let z = s * s;
    // 2 artanh s: the next term is below 1e-12.
    let series = 1.0 + z * (1.0 / 3.0 + z * (0.2 + z * (1.0 / 7.0 + z * (1.0 / 9.0 + z * (1.0 / 11.0 + z / 13.0)))));
    let logarithm = 2.0 * s * series + f64::from(doublings) * LN_2;
    let power = (exponent * logarithm).clamp(-200.0, 200.0);
    let whole = power * std::f64::consts::LOG2_E + WHOLE;
    let rest = power - (whole - WHOLE) * LN_2;
    let mut grown = 1.0 + rest / 10.0;
    for n in [9.0, 8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0] {
        grown = 1.0 + rest / n * grown;
    }
    let value = grown * f64::from_bits(whole.to_bits().wrapping_add(1023) << 52);
    if base.is_nan() || exponent.is_nan() {
        f64::NAN
    } else {
        value
    }
}

/// Excess of π/2 in f32; twice that for π.
const FRAC_PI_2_EXCESS: f32 = 4.371_139e-8;

/// Angle of the vector (`x`, `y`), both finite, in radians, in [−π, π], within two units in the last place; 0 for the zero
/// vector.
#[inline(always)]
pub fn atan2<T: Single>(y: T, x: T) -> T {
    let (width, height) = (x.abs(), y.abs());
    let is_steep = width.less(height);
    let less = T::select(is_steep, width, height);
    let more = T::select(is_steep, height, width);
    let t = less / more.max(c(f32::MIN_POSITIVE));
    let square = t * t;
    let fourth = square * square;
    // Minimax polynomial of (atan(t)/t − 1)/t² over t² in [0, 1].
    let low = (c::<T>(-0.333_331_02) + c::<T>(0.199_926_96) * square)
        + (c::<T>(-0.142_027_36) + c::<T>(0.106_347_93) * square) * fourth;
    let high = (c::<T>(-0.074_890_09) + c::<T>(0.042_504_99) * square)
        + (c::<T>(-0.015_956_903) + c::<T>(0.002_823_639) * square) * fourth;
    let angle = t + t * (square * (low + high * (fourth * fourth)));
    let angle = T::select(is_steep, c::<T>(FRAC_PI_2) - (angle + c(FRAC_PI_2_EXCESS)), angle);
    let angle = T::select(x.below_zero(), c::<T>(PI) - (angle + c(2.0 * FRAC_PI_2_EXCESS)), angle);
    T::from_bits(angle.to_bits().or(y.to_bits().and(Bits::splat(SIGN))))
}

/// The elementary functions of a number type, from a module or type that has them.
macro_rules! functions {
    ($from:ident) => {
        functions! { $from: sin() cos() exp() ln() powf(exponent) atan2(other) }
    };
    ($from:ident: $($name:ident($($argument:ident)?))*) => {
        crate::optics::real::inlined! {
            $(fn $name(self $(, $argument: Self)?) -> Self { $from::$name(self $(, $argument)?) })*
        }
    };
}
pub(super) use functions;
