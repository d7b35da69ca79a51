//! The Lambertian base. Seen from within it lies behind the interface, and what it scatters is refracted into the solid: a
//! Lambertian lobe whose sines are divided by the index of refraction. So it fills the cone from which light gets out again,
//! and none of it is caught by total reflection.

use super::{Material, Surface};
use crate::optics::curve::Curve;
use crate::optics::lobe::{Horizon, Lobe, LobeSample, LobeShape, lobe_evaluate, lobe_sample, raw_sample};
use crate::optics::real::{Mask, Real};
use crate::optics::vector::Vec3;

/// Rounding of a squared sine at the edge of the cone.
pub const BASE_EDGE: f64 = 1.00001;

/// Lambert's lobe, its rare samples below the geometric surface mirrored.
#[inline(always)]
fn base_shape<'a, T: Real>() -> LobeShape<'a, T> {
    LobeShape {
        lobe: Lobe::Lambert,
        curve: Curve::Sqrt,
        horizon: Horizon::Mirror,
        roughness: T::one(),
        anisotropy: T::zero(),
        eta: T::zero(),
        table: &[],
    }
}

/// The sine of the widest angle to which the base scatters: 1 but from within.
#[inline(always)]
fn base_spread<T: Real>(material: &Material<T>, surface: &Surface<T>) -> T {
    let is_within = surface.is_inside & material.transmits();
    T::select(is_within, material.ior_ahead(is_within), T::one())
}

/// A direction drawn from the base.
#[inline(always)]
pub(super) fn base_sample<T: Real>(material: &Material<T>, surface: &Surface<T>, xi: [T; 3]) -> LobeSample<T> {
    let (shape, normal) = (base_shape(), surface.frame.normal);
    let drawn = lobe_sample(&shape, &surface.frame, surface.normal, surface.wo, xi);
    let spread = base_spread(material, surface);
    let is_narrow = spread.less(T::one());
    if !is_narrow.any() {
        return drawn;
    }
    let wide = raw_sample(&shape, &surface.frame, surface.wo, xi);
    let cosine = normal.dot(wide);
    let height = (T::one() - spread * spread * (T::one() - cosine * cosine)).safe_sqrt();
    let raw = wide * spread + normal * (height - spread * cosine);
    let below = surface.normal.dot(raw).less(T::zero());
    let wi = Vec3::select(below, raw.reflected_at_plane(surface.normal), raw);
    LobeSample {
        wi: Vec3::select(is_narrow, wi, drawn.wi),
        weight: T::select(is_narrow, T::one(), drawn.weight),
    }
}

/// (evaluate, density) of [`base_sample`] for a direction.
#[inline(always)]
pub(super) fn base_evaluate<T: Real>(material: &Material<T>, surface: &Surface<T>, wi: Vec3<T>) -> [T; 2] {
    let [value, density] = lobe_evaluate(&base_shape(), &surface.frame, surface.normal, surface.wo, wi);
    let spread = base_spread(material, surface);
    let is_narrow = spread.less(T::one());
    if !is_narrow.any() {
        return [value, density];
    }
    let folded = wi.reflected_at_plane(surface.normal);
    let narrow = [wi, folded].map(|wi| narrow_density(surface.frame.normal.dot(wi), spread));
    let is_above = T::zero().less(surface.normal.dot(wi));
    let narrow = T::select(is_above, narrow[0] + narrow[1], T::zero());
    [value, density].map(|wide| T::select(is_narrow, narrow, wide))
}

/// The density of Lambert's lobe with its sines multiplied by `spread`, at a cosine.
#[inline(always)]
fn narrow_density<T: Real>(cosine: T, spread: T) -> T {
    let square = spread * spread;
    let is_in_cone = (T::one() - cosine * cosine).less(square * T::from_f64(BASE_EDGE));
    let density = cosine * T::from_f64(std::f64::consts::FRAC_1_PI) / square;
    T::select(T::zero().less(cosine) & is_in_cone, density, T::zero())
}
