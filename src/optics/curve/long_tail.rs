//! The curve D = −ln(1 − √ξ), without an edge.

use super::*;
use crate::optics::{numeric::expm1, numeric::log1p, real::inlined};

/// What is special about the curve.
pub const TRAITS: CurveTraits = CurveTraits {
    formula: "−ln(1 − √ξ)",
    integral: Integral::Quadrature,
    reach: Some(LONG_TAIL_MAX),
    plotted_max: 5.0,
};

/// Largest distance, reached at the largest 24-bit number below 1: 25 ln 2.
pub const LONG_TAIL_MAX: f64 = 17.328_679_513_998_632;

inlined! {
    /// D(ξ).
    pub fn distance<T: Real>(_table: &[f32], xi: T) -> T {
        // 1 − √ξ = (1 − ξ)/(1 + √ξ): stays above zero for the largest number below 1.
        let root = xi.sqrt();
        let complement = ((T::ONE - xi) / (T::ONE + root)).max(T::from_f64(0.5 / 16_777_216.0));
        T::select(root.less(T::HALF), -log1p(-root), -complement.ln())
    }

    /// h(D).
    pub fn h<T: Real>(_table: &[f32], distance: T) -> T {
        // 2 e^(−D) (1 − e^(−D))/D; the last factor goes to 1 at D = 0.
        let d = distance.max(T::from_f64(1e-6));
        T::from_f64(-2.0) * (-d).exp() * expm1(-d) / d
    }
}
