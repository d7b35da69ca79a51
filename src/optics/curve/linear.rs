//! The curve D = ξ.

use super::{CurveTraits, Integral};
use crate::optics::real::Real;

/// What is special about the curve.
pub const TRAITS: CurveTraits = CurveTraits {
    formula: "ξ",
    integral: Integral::Reciprocal,
    plotted_max: f64::INFINITY,
};

/// D(ξ).
#[inline(always)]
pub fn distance<T: Real>(_table: &[f32], xi: T) -> T {
    xi
}

#[inline(always)]
pub fn distance_max<T: Real>(_table: &[f32]) -> T {
    T::one()
}

/// h(D).
#[inline(always)]
pub fn h<T: Real>(_table: &[f32], distance: T) -> T {
    T::one() / distance.max(T::from_f64(1e-12))
}
