//! GGX as in [`super::ggx`], all normals sampled in proportion to D cosθ (Walter et al. 2007, eqs. 35 and 36): kept to
//! be compared in noise.

use super::*;
use crate::optics::{
    frame::world_from_local,
    microfacet::{distribution_weight, ggx_distribution},
    numeric::normalize_or,
};

/// Properties of the lobe.
pub const TRAITS: LobeTraits = LobeTraits {
    facets: Facets::All,
    ..super::ggx::TRAITS
};

inlined! {
    /// The reflection at a normal drawn from D cosθ.
    pub fn sample<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, xi: [T; 3]) -> Vec3<T> {
        let alpha = microfacet_alpha(shape);
        let slope = (xi[0] / (T::ONE - xi[0])).sqrt();
        let phi_rad = T::TAU * xi[1];
        let up = vec3(T::ZERO, T::ZERO, T::ONE);
        let h = normalize_or(
            vec3(alpha.x * slope * phi_rad.cos(), alpha.y * slope * phi_rad.sin(), T::ONE),
            up,
        );
        world_from_local(frame, local_from_world(frame, wo).mirrored_about(h))
    }

    /// D h.z/(4 |wo·h|).
    pub fn density<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
        let facet = facet(frame, wo, wi);
        let value = T::from_f64(0.25) * ggx_distribution(microfacet_alpha(shape), facet.h) * facet.h.z
            / facet.cosine.max(T::from_f64(1e-12));
        value.max(T::ZERO)
    }

    /// G2 (wo·h)/(cosθo h.z).
    pub fn weight<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
        distribution_weight(microfacet_alpha(shape), facet(frame, wo, wi))
    }
}
