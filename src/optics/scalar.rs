//! f32 and f64 as [`Real`] numbers.

use super::{
    elementary,
    elementary::functions,
    real::{Mask, Real, Scalar, inlined},
};

impl Mask for bool {
    inlined! {
        fn splat(value: bool) -> Self { value }
        fn from_bits(bits: u32) -> Self { bits & 1 == 1 }
        fn to_bits(self) -> u32 { u32::from(self) }
        fn any(self) -> bool { self }
        fn all(self) -> bool { self }
    }
}

/// A number type, and what has its elementary functions: for f64 the system's.
macro_rules! real {
    ($type:ident, $functions:ident) => {
        impl Scalar for $type {
            inlined! {
                fn to_f64(self) -> f64 { f64::from(self) }
            }
        }

        impl Real for $type {
            type Mask = bool;
            type Scalar = Self;
            type Each<E: Copy + Default> = [E; 1];
            const LANES: usize = 1;
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const TWO: Self = 2.0;
            const HALF: Self = 0.5;
            const TAU: Self = std::f64::consts::TAU as $type;
            const FRAC_1_PI: Self = std::f64::consts::FRAC_1_PI as $type;
            inlined! {
                fn from_f64(value: f64) -> Self { value as $type }
                fn from_count(value: u32) -> Self { value as $type }
                fn less(self, other: Self) -> bool { self < other }
                fn select(mask: bool, if_true: Self, if_false: Self) -> Self { if mask { if_true } else { if_false } }
                fn min(self, other: Self) -> Self { if self < other { self } else { other } }
                fn max(self, other: Self) -> Self { if self > other { self } else { other } }
                fn abs(self) -> Self { $type::abs(self) }
                fn sqrt(self) -> Self { $type::sqrt(self) }
                fn floor(self) -> Self { $type::floor(self) }
                fn each<E: Copy + Default>(mut f: impl FnMut(usize) -> E) -> [E; 1] { [f(0)] }
                fn from_each(numbers: &[Self; 1]) -> Self { numbers[0] }
                fn to_each(self) -> [Self; 1] { [self] }
                fn to_integers(self) -> [i32; 1] { [self as i32] }
                fn load(numbers: &[Self]) -> Self { numbers[0] }
                fn store(self, numbers: &mut [Self]) { numbers[0] = self; }
                fn vectorize<R>(f: impl FnOnce() -> R) -> R { f() }
            }
            functions!($functions);
        }
    };
}

real!(f32, elementary);
real!(f64, f64);
