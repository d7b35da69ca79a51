//! GGX as in [`super::ggx`], visible normals sampled as by Heitz, "Sampling the GGX distribution of visible normals",
//! JCGT 2018: kept to be compared in time.

use super::*;
use crate::optics::{
    frame::world_from_local,
    microfacet::{visible_density, visible_weight},
    numeric::normalize_or,
};

/// Properties of the lobe: those of GGX, since only the sampling differs.
pub const TRAITS: LobeTraits = super::ggx::TRAITS;

inlined! {
    /// The reflection at a visible normal: a uniform point on the projected half disc of the stretched hemisphere.
    pub fn sample<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, xi: [T; 3]) -> Vec3<T> {
        let alpha = microfacet_alpha(shape);
        let up = vec3(T::ZERO, T::ZERO, T::ONE);
        let wo = local_from_world(frame, wo);
        let v = normalize_or(vec3(wo.x * alpha.x, wo.y * alpha.y, wo.z), up);
        let t1 = normalize_or(vec3(-v.y, v.x, T::ZERO), vec3(T::ONE, T::ZERO, T::ZERO));
        let t2 = v.cross(t1);
        let radius = xi[0].safe_sqrt();
        let phi_rad = T::TAU * xi[1];
        let p1 = radius * phi_rad.cos();
        let s = T::HALF * (T::ONE + v.z);
        let p2 = (T::ONE - s) * (T::ONE - p1 * p1).safe_sqrt() + s * radius * phi_rad.sin();
        let p3 = (T::ONE - p1 * p1 - p2 * p2).safe_sqrt();
        let n = t1 * p1 + t2 * p2 + v * p3;
        let h = normalize_or(vec3(n.x * alpha.x, n.y * alpha.y, n.z.max(T::ZERO)), up);
        world_from_local(frame, wo.mirrored_about(h))
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
