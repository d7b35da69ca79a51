//! The curve D = ∛ξ.

use super::{CurveTraits, Integral};
use crate::optics::real::Real;

/// What is special about the curve.
pub const TRAITS: CurveTraits = CurveTraits {
    formula: "∛ξ",
    integral: Integral::Polynomial([0.0, 3.0, 0.0]),
    plotted_max: f64::INFINITY,
};

/// D(ξ).
#[inline(always)]
pub fn distance<T: Real>(_table: &[f32], xi: T) -> T {
    xi.powf(T::from_f64(1.0 / 3.0))
}

#[inline(always)]
pub fn distance_max<T: Real>(_table: &[f32]) -> T {
    T::one()
}

/// h(D).
#[inline(always)]
pub fn h<T: Real>(_table: &[f32], distance: T) -> T {
    T::from_f64(3.0) * distance
}
