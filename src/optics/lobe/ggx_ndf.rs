//! GGX as in [`super::ggx`], all normals sampled in proportion to D cosθ (Walter et al. 2007, eqs. 35 and 36): kept to
//! be compared in noise.

use super::{Facets, LobeShape, LobeTraits, microfacet_alpha};
use crate::optics::frame::{Frame, local_from_world, world_from_local};
use crate::optics::microfacet::{distribution_weight, facet, ggx_distribution};
use crate::optics::numeric::normalize_or;
use crate::optics::real::Real;
use crate::optics::vector::{Vec3, vec3};

/// Properties of the lobe.
pub const TRAITS: LobeTraits = LobeTraits {
    facets: Facets::All,
    ..super::ggx::TRAITS
};

/// The reflection at a normal drawn from D cosθ.
#[inline(always)]
pub fn sample<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, xi: [T; 3]) -> Vec3<T> {
    let alpha = microfacet_alpha(shape);
    let slope = (xi[0] / (T::one() - xi[0])).sqrt();
    let phi_rad = T::from_f64(std::f64::consts::TAU) * xi[1];
    let up = vec3(T::zero(), T::zero(), T::one());
    let h = normalize_or(
        vec3(
            alpha.x * slope * phi_rad.cos(),
            alpha.y * slope * phi_rad.sin(),
            T::one(),
        ),
        up,
    );
    world_from_local(frame, local_from_world(frame, wo).mirrored_about(h))
}

/// D h.z/(4 |wo·h|).
#[inline(always)]
pub fn density<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
    let facet = facet(frame, wo, wi);
    let value = T::from_f64(0.25) * ggx_distribution(microfacet_alpha(shape), facet.h) * facet.h.z
        / facet.cosine.max(T::from_f64(1e-12));
    value.max(T::zero())
}

/// G2 (wo·h)/(cosθo h.z).
#[inline(always)]
pub fn weight<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
    distribution_weight(microfacet_alpha(shape), facet(frame, wo, wi))
}
