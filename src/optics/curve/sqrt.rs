//! The curve D = √ξ: a disc, evenly filled.

use super::*;
use crate::optics::real::inlined;

/// What is special about the curve.
pub const TRAITS: CurveTraits = CurveTraits {
    formula: "√ξ",
    integral: Integral::Polynomial([2.0, 0.0, 0.0]),
    reach: Some(1.0),
    plotted_max: f64::INFINITY,
};

inlined! {
    /// D(ξ).
    pub fn distance<T: Real>(_table: &[f32], xi: T) -> T {
        xi.sqrt()
    }

    /// h(D).
    pub fn h<T: Real>(_table: &[f32], _distance: T) -> T {
        T::TWO
    }
}
