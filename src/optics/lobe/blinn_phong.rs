//! Blinn-Phong as a microfacet lobe: D = (n + 2)/(2π) cosⁿθh (Blinn 1977), n = 2/α² − 2, masked as GGX of the same α
//! (Walter et al. 2007 show the two to be close).

use super::*;
use crate::optics::{frame::world_from_local, microfacet::distribution_weight, numeric::expm1, numeric::log1p};

/// Properties of the lobe.
pub const TRAITS: LobeTraits = LobeTraits {
    // Single scattering.
    is_hemispherical: true,
    is_anisotropic: false,
    facets: Facets::All,
    width: Width::Alpha,
    has_curves: false,
    weighs_one: false,
    loses_light: false,
    peak: 0.0,
};

inlined! {
    pub fn exponent<T: Real>(roughness: T) -> T {
        let alpha = alpha_from_roughness(roughness);
        (T::TWO / (alpha * alpha) - T::TWO).max(T::ZERO)
    }

    /// The reflection at a normal drawn from D cosθ.
    pub fn sample<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, xi: [T; 3]) -> Vec3<T> {
        let power = (T::ONE - xi[0]).ln() / (exponent(shape.roughness) + T::TWO);
        let cosine = power.exp();
        let sine = (-expm1(T::TWO * power)).safe_sqrt();
        let phi_rad = T::TAU * xi[1];
        let h = vec3(sine * phi_rad.cos(), sine * phi_rad.sin(), cosine);
        world_from_local(frame, local_from_world(frame, wo).mirrored_about(h))
    }
}

inlined! {
    /// D h.z/(4 |wo·h|).
    pub fn density<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
        let facet = facet(frame, wo, wi);
        let n = exponent(shape.roughness);
        // ln cosθh: for narrow lobes from sin²θh by the tangential components, else from the cosine; each loses precision where
        // the other is used.
        let half = T::HALF;
        let sine2 = facet.h.x * facet.h.x + facet.h.y * facet.h.y;
        let near = half * log1p(-sine2.min(half));
        let log_cosine = T::select(sine2.less(half), near, facet.h.z.max(T::from_f64(1e-30)).ln());
        let power = ((n + T::ONE) * log_cosine).exp();
        let scale = (n + T::TWO) * T::from_f64(0.125 * std::f64::consts::FRAC_1_PI);
        let value = scale * power / facet.cosine.max(T::from_f64(1e-12));
        value.masked(facet.h.z.above_zero())
    }

    /// G2 (wo·h)/(cosθo h.z).
    pub fn weight<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
        distribution_weight(isotropic_alpha(shape), facet(frame, wo, wi))
    }
}
