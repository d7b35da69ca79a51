//! The curve D = 1 − √(1 − √ξ), whose density vanishes at the edge.

use super::*;
use crate::optics::real::inlined;

/// What is special about the curve.
pub const TRAITS: CurveTraits = CurveTraits {
    formula: "1 − √(1 − √ξ)",
    integral: Integral::PolynomialToZero([8.0, -12.0, 4.0]),
    reach: Some(1.0),
    plotted_max: f64::INFINITY,
};

inlined! {
    /// D(ξ).
    pub fn distance<T: Real>(_table: &[f32], xi: T) -> T {
        // Written without the cancellation near ξ = 0.
        let root = xi.sqrt();
        root / (T::ONE + (T::ONE - root).safe_sqrt())
    }

    /// h(D).
    pub fn h<T: Real>(_table: &[f32], distance: T) -> T {
        T::from_f64(4.0) * (T::TWO - distance) * (T::ONE - distance).max(T::ZERO)
    }
}
