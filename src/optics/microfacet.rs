//! Common part of the microfacet lobes: GGX's distribution and its height-correlated Smith masking. All vectors in the local
//! frame, n = +z. Source: Walter et al. 2007; Heitz 2014 and 2018.

use super::{frame::Frame, frame::local_from_world, fresnel::half_vector_cosine, numeric::normalize_or};
use crate::optics::prelude::*;

/// The widths along tangent and bitangent.
#[derive(Clone, Copy, Debug)]
pub struct Alpha<T> {
    /// α along the tangent.
    pub x: T,
    /// α along the bitangent.
    pub y: T,
}

/// View, light and half vector in the local frame.
#[derive(Clone, Copy, Debug)]
pub struct Facet<T> {
    /// Unit direction to the viewer.
    pub wo: Vec3<T>,
    /// Unit direction to the light.
    pub wi: Vec3<T>,
    /// Unit normal of the facet.
    pub h: Vec3<T>,
    /// The cosine between the facet's normal and either direction, in [0, 1].
    pub cosine: T,
}

inlined! {
    /// The facet that reflects `wi` to `wo`. For nearly opposite directions their sum is short: it is computed before the
    /// rounding of the frame, which would rotate it.
    pub fn facet<T: Real>(frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>) -> Facet<T> {
        let h = normalize_or(wo + wi, frame.normal);
        Facet {
            wo: local_from_world(frame, wo),
            wi: local_from_world(frame, wi),
            h: local_from_world(frame, h),
            cosine: half_vector_cosine(wo, wi),
        }
    }

    /// D(h) of GGX, written to keep the tangential components' precision for small α.
    pub fn ggx_distribution<T: Real>(alpha: Alpha<T>, h: Vec3<T>) -> T {
        let (x, y) = (h.x / alpha.x, h.y / alpha.y);
        let square = x * x + y * y + h.z * h.z;
        T::FRAC_1_PI / (alpha.x * alpha.y * square * square)
    }

    /// √(z² + αx²x² + αy²y²): Smith's Λ is (that over |z| − 1)/2.
    pub fn smith_length<T: Real>(alpha: Alpha<T>, w: Vec3<T>) -> T {
        let (x, y) = (alpha.x * w.x, alpha.y * w.y);
        (w.z * w.z + x * x + y * y).sqrt()
    }

    /// Masking of the view alone over its cosine: G1(wo)/cosθo = 2/(cosθo + smith_length).
    pub fn smith_g1_over_cosine<T: Real>(alpha: Alpha<T>, wo: Vec3<T>) -> T {
        T::TWO / (wo.z.abs() + smith_length(alpha, wo)).max(T::from_f64(1e-12))
    }

    /// Height-correlated masking and shadowing over cosθo: G2/cosθo; 0 if either direction is below the horizon.
    pub fn smith_g2_over_cosine<T: Real>(alpha: Alpha<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
        let sum = wo.z * smith_length(alpha, wi) + wi.z * smith_length(alpha, wo);
        let value = T::TWO * wi.z / sum.max(T::from_f64(1e-12));
        let above = wo.z.above_zero() & wi.z.above_zero();
        value.masked(above)
    }

    /// The density of a direction whose facet was drawn by visible normals: D G1/(4 cosθo).
    pub fn visible_density<T: Real>(alpha: Alpha<T>, frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
        let facet = facet(frame, wo, wi);
        let value = T::from_f64(0.25) * ggx_distribution(alpha, facet.h) * smith_g1_over_cosine(alpha, facet.wo);
        value.masked(facet.h.z.above_zero())
    }

    /// The weight of such a direction: G2/G1.
    pub fn visible_weight<T: Real>(alpha: Alpha<T>, frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
        let (wo, wi) = (local_from_world(frame, wo), local_from_world(frame, wi));
        smith_g2_over_cosine(alpha, wo, wi) / smith_g1_over_cosine(alpha, wo)
    }

    /// The weight of a direction whose facet was drawn in proportion to D cosθ: G2 (wo·h)/(cosθo h.z).
    pub fn distribution_weight<T: Real>(alpha: Alpha<T>, facet: Facet<T>) -> T {
        let ratio = facet.cosine / facet.h.z.max(T::from_f64(1e-6));
        smith_g2_over_cosine(alpha, facet.wo, facet.wi) * ratio
    }
}
