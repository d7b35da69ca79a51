//! The curve D = ∛ξ.

use super::*;
use crate::optics::real::inlined;

/// What is special about the curve.
pub const TRAITS: CurveTraits = CurveTraits {
    formula: "∛ξ",
    integral: Integral::Polynomial([0.0, 3.0, 0.0]),
    reach: Some(1.0),
    plotted_max: f64::INFINITY,
};

inlined! {
    /// D(ξ).
    pub fn distance<T: Real>(_table: &[f32], xi: T) -> T {
        xi.powf(T::from_f64(1.0 / 3.0))
    }

    /// h(D).
    pub fn h<T: Real>(_table: &[f32], distance: T) -> T {
        T::from_f64(3.0) * distance
    }
}
