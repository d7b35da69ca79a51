//! Refraction at a dielectric interface: of a direction, and at the facets of a rough surface.
//!
//! `eta` is the relative index of refraction: behind the surface (the side away from `wo`) over before it. Paths carry basic
//! radiance, radiance over the square of the index of refraction. Refraction does not change it, so that no factor of `eta`²
//! appears (Nicodemus 1963; Veach 1997, section 5.2). Source of the facets' density and weight: Walter et al., "Microfacet
//! models for refraction through rough surfaces", EGSR 2007, equations 16, 17 and 21.

use super::{frame::Frame, numeric::normalize_or};
use crate::optics::prelude::*;

/// A refracted direction.
#[derive(Clone, Copy, Debug)]
pub struct Refracted<T: Real> {
    /// Unit direction behind the surface; undeviated under total reflection.
    pub wi: Vec3<T>,
    /// Lanes of total reflection.
    pub is_total: T::Mask,
}

inlined! {
    /// `eta`² cos² of the refracted angle, from the cosine before the surface; negative under total reflection. Written without
    /// cancellation for similar indices.
    pub fn refracted_square<T: Real>(cosine: T, eta: T) -> T {
        (eta - T::ONE) * (eta + T::ONE) + cosine * cosine
    }

    /// Snell's law for a surface with the unit normal `axis` on the side of `wo`.
    pub fn refracted<T: Real>(wo: Vec3<T>, axis: Vec3<T>, eta: T) -> Refracted<T> {
        let cosine = wo.dot(axis);
        let square = refracted_square(cosine, eta);
        let is_total = square.below_zero();
        Refracted {
            wi: Vec3::select(is_total, -wo, (axis * (cosine - square.safe_sqrt()) - wo) / eta),
            is_total,
        }
    }

    /// Refraction at the facet that mirrors `wo` to `mirrored`.
    pub fn facet_refracted<T: Real>(wo: Vec3<T>, mirrored: Vec3<T>, eta: T) -> Refracted<T> {
        refracted(wo, normalize_or(wo + mirrored, wo), eta)
    }

    /// Normal (not unit) of the facet that refracts `wo` to `wi`, on the side of `wo` if such a facet exists; its length is
    /// |wo·h + eta wi·h|.
    pub fn refracting_normal<T: Real>(wo: Vec3<T>, wi: Vec3<T>, eta: T) -> Vec3<T> {
        let sum = wo + wi * eta;
        Vec3::select(eta.less(T::ONE), sum, -sum)
    }

    /// The cosines between the normal of the facet that refracts the view to `wi` and either, before and behind it, in [0, 1].
    pub fn refracting_cosines<T: Real>(wo: Vec3<T>, wi: Vec3<T>, eta: T) -> [T; 2] {
        let h = normalize_or(refracting_normal(wo, wi, eta), wo);
        let (zero, one) = (T::ZERO, T::ONE);
        [wo.dot(h).clamp(zero, one), (-wi.dot(h)).clamp(zero, one)]
    }

    /// The direction that the facet which refracts `wo` to `wi` reflects `wo` to.
    pub fn facet_mirror<T: Real>(frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>, eta: T) -> Vec3<T> {
        wo.mirrored_about(normalize_or(refracting_normal(wo, wi, eta), frame.normal))
    }

    /// Factor from the density of a facet's mirror direction of `wo` to that of the refracted `wi`, per steradian: dωh/dωi =
    /// eta² |wi·h|/(wo·h + eta wi·h)² over dωh/dω of the mirrored one, 1/(4 wo·h). 0 if no facet refracts one to the other, and
    /// if `wi` is not below the shading normal's horizon: such samples are lost. `along`: that facet's [`refracting_normal`].
    pub fn facet_density_factor<T: Real>(frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>, eta: T, along: Vec3<T>) -> T {
        let square = along.dot(along).max(T::from_f64(1e-30));
        let h = along / square.sqrt();
        let (before, behind) = (wo.dot(h), -wi.dot(h));
        let value = T::from_f64(4.0) * before * eta * eta * behind / square;
        let is_behind = frame.normal.dot(wi).below_zero();
        let is_seen = before.above_zero() & frame.normal.dot(h).above_zero();
        let is_refracted = is_behind & is_seen & behind.above_zero();
        value.masked(is_refracted)
    }
}
