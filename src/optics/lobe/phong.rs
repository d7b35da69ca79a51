//! The modified Phong lobe (Lafortune and Willems 1994): a cosine power around the mirror direction r.
//!
//! f = (n + 2)/(2π) cosⁿα, sampled with density (n + 1)/(2π) cosⁿα (paper, eqs. 2 and 5), n = (2/α² − 2)/4 with
//! α = roughness². What falls below the surface is lost: the model's own loss.

use super::*;
use crate::optics::{frame::frame_from_normal, frame::world_from_local, numeric::expm1, numeric::log1p};

/// Properties of the lobe.
pub const TRAITS: LobeTraits = LobeTraits {
    is_hemispherical: true,
    is_anisotropic: false,
    facets: Facets::None,
    width: Width::Alpha,
    has_curves: false,
    weighs_one: false,
    loses_light: false,
    peak: 0.0,
};

inlined! {
    /// The exponent n, never below 0.
    pub fn exponent<T: Real>(roughness: T) -> T {
        let alpha = alpha_from_roughness(roughness);
        (T::HALF / (alpha * alpha) - T::HALF).max(T::ZERO)
    }

    /// A direction around r with density (n + 1)/(2π) cosⁿα.
    pub fn sample<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, xi: [T; 3]) -> Vec3<T> {
        let power = (T::ONE - xi[0]).ln() / (exponent(shape.roughness) + T::ONE);
        let cosine = power.exp();
        let sine = (-expm1(T::TWO * power)).safe_sqrt();
        let phi_rad = T::TAU * xi[1];
        let around_mirror = frame_from_normal(wo.mirrored_about(frame.normal));
        world_from_local(&around_mirror, vec3(sine * phi_rad.cos(), sine * phi_rad.sin(), cosine))
    }

    /// (n + 1)/(2π) cosⁿα.
    pub fn density<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
        let apart = wi - wo.mirrored_about(frame.normal);
        // 1 − cosα from the difference of the two directions: exact for narrow lobes.
        let versine = T::HALF * apart.dot(apart);
        let in_lobe = versine.less(T::ONE);
        let n = exponent(shape.roughness);
        let power = (n * log1p(-versine.masked(in_lobe))).exp();
        let scale = (n + T::ONE) * T::from_f64(0.5 * std::f64::consts::FRAC_1_PI);
        (scale * power).masked(in_lobe)
    }

    /// (n + 2)/(n + 1) cosθ.
    pub fn weight<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, _wo: Vec3<T>, wi: Vec3<T>) -> T {
        let n = exponent(shape.roughness);
        (n + T::TWO) / (n + T::ONE) * frame.normal.dot(wi).max(T::ZERO)
    }
}
