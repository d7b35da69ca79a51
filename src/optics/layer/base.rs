//! The diffuse base: Lambertian, or rough by a factor of both directions.
//!
//! Seen from within it is behind the interface, and its scattered light is refracted into the solid: a Lambertian lobe with
//! sines divided by the index of refraction. So it fills the cone from which light gets out again, and none is trapped by
//! total reflection.

use super::{Layer, LayerAlbedo, LayerLobe, LayerModel, LayerToward, Layers};
use crate::optics::curve::Curve;
use crate::optics::lobe::{Horizon, Lobe, LobeSample, LobeShape, raw_sample};
use crate::optics::material::{Material, Surface};
use crate::optics::real::{Mask, Real};
use crate::optics::rough_diffuse::rough_diffuse;
use crate::optics::vector::Vec3;

/// Rounding of a squared sine at the edge of the cone.
pub const BASE_EDGE: f64 = 1.00001;

/// The Lambertian base layer.
#[derive(Debug)]
pub struct Base;

impl<T: Real> LayerModel<T> for Base {
    const LAYER: Layer = Layer::Base;

    #[inline(always)]
    fn is_there(material: &Material<T>, _: &Surface<T>) -> T::Mask {
        material.has_base()
    }

    /// Lambert's lobe, its rare samples below the geometric surface mirrored.
    #[inline(always)]
    fn lobe<'a>(_: &Material<T>, _: &'a [f32], surface: &Surface<T>) -> LayerLobe<'a, T> {
        LayerLobe {
            shape: base_shape(),
            frame: surface.frame,
        }
    }

    /// A metal has no layer below.
    #[inline(always)]
    fn albedo(material: &Material<T>, _: &[f32], _: &Surface<T>, left: Vec3<T>) -> LayerAlbedo<T> {
        let left_by_metal = left * (T::one() - material.metalness);
        LayerAlbedo {
            reflected: material.base_color * left_by_metal * (T::one() - material.transmission_weight),
            transmittance: Vec3::splat(T::one()),
        }
    }

    #[inline(always)]
    fn toward(
        material: &Material<T>,
        layers: &Layers<T>,
        surface: &Surface<T>,
        _: &LobeShape<'_, T>,
        wi: Vec3<T>,
    ) -> LayerToward<T> {
        let share = &layers[Layer::Base];
        let mut color = share.albedo;
        // From within light fills a cone, for which there is no such model.
        let is_rough = T::zero().less(material.diffuse_roughness) & !surface.is_within(material);
        if is_rough.any() {
            let cosines = [surface.wo, wi].map(|direction| surface.frame.normal.dot(direction));
            let between = surface.wo.dot(wi);
            let factor = rough_diffuse(material.base_color, material.diffuse_roughness, cosines, between);
            color = Vec3::select(is_rough, color * factor, color);
        }
        LayerToward {
            color,
            probability: share.probability,
        }
    }

    /// The specular lobe sets how often its rest is sampled.
    #[inline(always)]
    fn choose(_: &Material<T>, layers: &mut Layers<T>, below: T) -> T {
        layers[Layer::Base].albedo.luminance() + below
    }

    #[inline(always)]
    fn chance(layers: &Layers<T>) -> T {
        let (base, through) = (layers[Layer::Base].probability, layers[Layer::Transmission].probability);
        let share = base / (base + through).max(T::from_f64(1e-20));
        T::select(T::zero().less(through), share, T::one())
    }

    #[inline(always)]
    fn refined_sample(material: &Material<T>, surface: &Surface<T>, xi: [T; 3], drawn: LobeSample<T>) -> LobeSample<T> {
        let spread = base_spread(material, surface);
        let is_narrow = spread.less(T::one());
        if !is_narrow.any() {
            return drawn;
        }
        let normal = surface.frame.normal;
        let wide = raw_sample(&base_shape(), &surface.frame, surface.wo, xi);
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

    #[inline(always)]
    fn refined(material: &Material<T>, surface: &Surface<T>, wi: Vec3<T>, evaluated: [T; 2]) -> [T; 2] {
        let spread = base_spread(material, surface);
        let is_narrow = spread.less(T::one());
        if !is_narrow.any() {
            return evaluated;
        }
        let folded = wi.reflected_at_plane(surface.normal);
        let narrow = [wi, folded].map(|wi| narrow_density(surface.frame.normal.dot(wi), spread));
        let is_above = T::zero().less(surface.normal.dot(wi));
        let narrow = T::select(is_above, narrow[0] + narrow[1], T::zero());
        evaluated.map(|wide| T::select(is_narrow, narrow, wide))
    }
}

#[inline(always)]
pub(super) fn base_shape<'a, T: Real>() -> LobeShape<'a, T> {
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
    let is_within = surface.is_within(material);
    T::select(is_within, material.ior_ahead(is_within), T::one())
}

/// The density of Lambert's lobe with its sines multiplied by `spread`, at a cosine.
#[inline(always)]
fn narrow_density<T: Real>(cosine: T, spread: T) -> T {
    let square = spread * spread;
    let is_in_cone = (T::one() - cosine * cosine).less(square * T::from_f64(BASE_EDGE));
    let density = cosine * T::from_f64(std::f64::consts::FRAC_1_PI) / square;
    T::select(T::zero().less(cosine) & is_in_cone, density, T::zero())
}
