//! f32 and f64 as [`Real`] numbers.

use super::elementary::by_arithmetic;
use super::real::{Mask, Real, Scalar};

impl Mask for bool {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        value
    }
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        bits & 1 == 1
    }
    #[inline(always)]
    fn to_bits(self) -> u32 {
        u32::from(self)
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn all(self) -> bool {
        self
    }
}

macro_rules! real {
    ($type:ident, $functions:path) => {
        impl Scalar for $type {
            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
        }

        impl Real for $type {
            type Mask = bool;
            type Scalar = Self;
            type Each<E: Copy + Default> = [E; 1];
            const LANES: usize = 1;
            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $type
            }
            #[inline(always)]
            fn from_count(value: u32) -> Self {
                value as $type
            }
            #[inline(always)]
            fn less(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
                if mask { if_true } else { if_false }
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if self < other { self } else { other }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if self > other { self } else { other }
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $type::abs(self)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $type::sqrt(self)
            }
            #[inline(always)]
            fn floor(self) -> Self {
                $type::floor(self)
            }
            #[inline(always)]
            fn each<E: Copy + Default>(mut f: impl FnMut(usize) -> E) -> [E; 1] {
                [f(0)]
            }
            #[inline(always)]
            fn from_each(numbers: &[Self; 1]) -> Self {
                numbers[0]
            }
            #[inline(always)]
            fn to_each(self) -> [Self; 1] {
                [self]
            }
            #[inline(always)]
            fn load(numbers: &[Self]) -> Self {
                numbers[0]
            }
            #[inline(always)]
            fn store(self, numbers: &mut [Self]) {
                numbers[0] = self;
            }
            #[inline(always)]
            fn vectorize<R>(f: impl FnOnce() -> R) -> R {
                f()
            }
            $functions! { $type }
        }
    };
}

/// The system's functions.
macro_rules! by_the_system {
    ($type:ident) => {
        by_the_system! { $type: sin() cos() exp() ln() powf(exponent) atan2(other) }
    };
    ($type:ident: $($name:ident($($argument:ident)?))*) => {
        $(
            #[inline(always)]
            fn $name(self $(, $argument: Self)?) -> Self {
                $type::$name(self $(, $argument)?)
            }
        )*
    };
}

real!(f32, by_arithmetic);
real!(f64, by_the_system);
