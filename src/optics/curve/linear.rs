//! The curve D = ξ.

use super::*;
use crate::optics::real::inlined;

/// What is special about the curve.
pub const TRAITS: CurveTraits = CurveTraits {
    formula: "ξ",
    integral: Integral::Reciprocal,
    reach: Some(1.0),
    plotted_max: f64::INFINITY,
};

inlined! {
    /// D(ξ).
    pub fn distance<T: Real>(_table: &[f32], xi: T) -> T {
        xi
    }

    /// h(D).
    pub fn h<T: Real>(_table: &[f32], distance: T) -> T {
        T::ONE / distance.max(T::from_f64(1e-12))
    }
}
