//! GGX with height-correlated Smith masking, single scattering; visible normals sampled by spherical caps.
//! Source: Dupuy and Benyoub, "Sampling visible GGX normals with spherical caps", HPG 2023, listing 3.

use super::*;
use crate::optics::{
    frame::world_from_local,
    microfacet::{visible_density, visible_weight},
    numeric::normalize_or,
};

/// Properties of the lobe.
pub const TRAITS: LobeTraits = LobeTraits {
    // Single scattering.
    is_hemispherical: true,
    is_anisotropic: true,
    facets: Facets::Visible,
    width: Width::Alpha,
    has_curves: false,
    weighs_one: false,
    loses_light: true,
    peak: 0.0,
};

inlined! {
    /// The reflection at a visible normal: a uniform point on the spherical cap of the stretched view direction.
    pub fn sample<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, xi: [T; 3]) -> Vec3<T> {
        let wo = local_from_world(frame, wo);
        world_from_local(
            frame,
            wo.mirrored_about(visible_normal(microfacet_alpha(shape), wo, xi)),
        )
    }

    /// A facet's normal that the view sees, both in the local frame.
    pub fn visible_normal<T: Real>(alpha: Alpha<T>, wo: Vec3<T>, xi: [T; 3]) -> Vec3<T> {
        let up = vec3(T::ZERO, T::ZERO, T::ONE);
        let stretched = normalize_or(vec3(wo.x * alpha.x, wo.y * alpha.y, wo.z), up);
        let phi_rad = T::TAU * xi[0];
        let z = (T::ONE - xi[1]) * (T::ONE + stretched.z) - stretched.z;
        let sine = (T::ONE - z * z).safe_sqrt();
        let cap = vec3(sine * phi_rad.cos(), sine * phi_rad.sin(), z) + stretched;
        normalize_or(vec3(cap.x * alpha.x, cap.y * alpha.y, cap.z.max(T::ZERO)), up)
    }

    /// D G1/(4 cosθo).
    pub fn density<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
        visible_density(microfacet_alpha(shape), frame, wo, wi)
    }

    /// G2/G1.
    pub fn weight<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
        visible_weight(microfacet_alpha(shape), frame, wo, wi)
    }
}
