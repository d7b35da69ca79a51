//! Rough diffuse reflection that keeps its energy. Source: Portsmouth, Kutz and Hill, "EON: A practical energy-preserving
//! rough diffuse BRDF" (2024): Oren and Nayar's model as Fujii has it, with what is scattered more than once. A white surface
//! reflects all light at every roughness, and the value is the same in both directions.

use std::f64::consts::{FRAC_1_PI, PI};

use crate::optics::prelude::*;

/// What roughness takes of single scattering, head-on.
pub const HEAD_ON: f64 = 0.5 - 2.0 * FRAC_1_PI / 3.0;
/// What it gives to the mean over all views.
pub const MEAN: f64 = 2.0 / 3.0 - 28.0 * FRAC_1_PI / 15.0;
/// The least cosine at which directions are compared.
pub const ROUGH_COSINE_MIN: f64 = 0.0001;

inlined! {
    /// The value over that of Lambert's model with the same albedo, linear RGB: from the cosines of both directions to the normal
    /// and the cosine between them. 1 at roughness 0.
    pub fn rough_diffuse<T: Real>(albedo: Vec3<T>, roughness: T, [view, light]: [T; 2], between: T) -> Vec3<T> {
        let (zero, one) = (T::ZERO, T::ONE);
        let [cosine_o, cosine_i] = mapped!([view, light], |cosine| cosine.clamp(T::from_f64(ROUGH_COSINE_MIN), one));
        let head_on = one / (one + roughness * T::from_f64(HEAD_ON));
        let across = between - cosine_o * cosine_i;
        let across = T::select(across.above_zero(), across / cosine_o.max(cosine_i), across);
        let once = head_on * (one + roughness * across);
        let mean = head_on * (one + roughness * T::from_f64(MEAN));
        let lost = mapped!([cosine_o, cosine_i], |cosine| (one - single_albedo(cosine, roughness)).max(zero));
        let again = mean * lost[0] * lost[1] / (one - mean).max(T::from_f64(1e-6));
        let of_channel = |albedo: T| once + again * albedo / (one - albedo * (one - mean));
        vec3(of_channel(albedo.x), of_channel(albedo.y), of_channel(albedo.z))
    }

    /// Directional albedo of single scattering on a white surface.
    pub fn single_albedo<T: Real>(cosine: T, roughness: T) -> T {
        let number = T::from_f64;
        let sine = ((T::ONE - cosine) * (T::ONE + cosine)).safe_sqrt();
        // (1 − s³) s/c without cancellation, as 1 − s = c²/(1 + s).
        let rest = sine * cosine * (T::ONE + sine + sine * sine) / (T::ONE + sine);
        let bent = sine * (sine.atan2(cosine) - sine * cosine) + number(2.0 / 3.0) * (rest - sine);
        (T::ONE + roughness * number(1.0 / PI) * bent) / (T::ONE + roughness * number(HEAD_ON))
    }
}
