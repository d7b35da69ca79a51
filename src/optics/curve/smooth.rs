//! The curve D = 1 − √(1 − √ξ), whose density vanishes at the edge.

use super::{CurveTraits, Integral};
use crate::optics::real::Real;

/// What is special about the curve.
pub const TRAITS: CurveTraits = CurveTraits {
    formula: "1 − √(1 − √ξ)",
    integral: Integral::PolynomialToZero([8.0, -12.0, 4.0]),
    plotted_max: f64::INFINITY,
};

/// D(ξ).
#[inline(always)]
pub fn distance<T: Real>(_table: &[f32], xi: T) -> T {
    // Written without the cancellation near ξ = 0.
    let root = xi.sqrt();
    root / (T::one() + (T::one() - root).safe_sqrt())
}

#[inline(always)]
pub fn distance_max<T: Real>(_table: &[f32]) -> T {
    T::one()
}

/// h(D).
#[inline(always)]
pub fn h<T: Real>(_table: &[f32], distance: T) -> T {
    T::from_f64(4.0) * (T::from_f64(2.0) - distance) * (T::one() - distance).max(T::zero())
}
