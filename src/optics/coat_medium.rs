//! The medium of a coat that absorbs by the length of the way through it. Source: OpenPBR 1.1, "View-dependent absorption" and
//! "Emission".

use super::{material::Material, refraction::refracted_square};
use crate::optics::prelude::*;

/// Most of the light that a coat reflects back inside: at 1 nothing would get out.
pub const INNER_MAX: f64 = 0.9999;
/// Least cosine of the way through a coat.
pub const WAY_COSINE_MIN: f64 = 0.001;
/// Least colour of a coat, whose powers are finite.
pub const COLOR_MIN: f64 = 1e-12;

inlined! {
    /// Length of the way through the coat with this cosine outside, over that at right angles.
    pub fn way_length<T: Real>(material: &Material<T>, cosine: T) -> T {
        let behind = refracted_square(cosine, material.coat_ior).safe_sqrt() / material.coat_ior;
        T::ONE / behind.max(T::from_f64(WAY_COSINE_MIN))
    }

    /// The coat's colour, that of a way in and out at right angles, over a way of this length.
    pub fn color_over<T: Real>(material: &Material<T>, way: T) -> Vec3<T> {
        let half = T::HALF * way;
        material.coat_color.map(#[inline(always)] |channel: T| channel.max(T::from_f64(COLOR_MIN)).powf(half))
    }

    /// What such a coat leaves of the light that a surface emits at this cosine to its normal. `is_back`: lanes behind the
    /// surface.
    pub fn coat_over_emission<T: Real>(material: &Material<T>, cosine: T, is_back: T::Mask) -> Vec3<T> {
        let white = Vec3::ONE;
        let tint = white.mix(
            color_over(material, way_length(material, cosine.abs())),
            material.coat_weight,
        );
        Vec3::select(is_back & material.transmits(), white, tint)
    }
}
