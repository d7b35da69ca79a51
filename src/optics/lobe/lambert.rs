//! Lambert's lobe: density cosθ/π, drawn without a basis as the normal plus a uniform direction.

use super::*;
use crate::optics::{numeric::normalize_or, warp::uniform_sphere};

/// Properties of the lobe.
pub const TRAITS: LobeTraits = LobeTraits {
    is_hemispherical: true,
    is_anisotropic: false,
    facets: Facets::None,
    width: Width::Fixed,
    has_curves: false,
    weighs_one: true,
    loses_light: false,
    peak: 0.0,
};

inlined! {
    /// A direction with density cosθ/π.
    pub fn sample<T: Real>(_shape: &LobeShape<'_, T>, frame: &Frame<T>, _wo: Vec3<T>, xi: [T; 3]) -> Vec3<T> {
        normalize_or(frame.normal + uniform_sphere([xi[0], xi[1]]), frame.normal)
    }

    /// cosθ/π.
    pub fn density<T: Real>(_shape: &LobeShape<'_, T>, frame: &Frame<T>, _wo: Vec3<T>, wi: Vec3<T>) -> T {
        frame.normal.dot(wi).max(T::ZERO) * T::FRAC_1_PI
    }

    /// Always 1: the lobe is its density.
    pub fn weight<T: Real>(_shape: &LobeShape<'_, T>, _frame: &Frame<T>, _wo: Vec3<T>, _wi: Vec3<T>) -> T {
        T::ONE
    }
}
