//! The diffuse base: Lambertian, or rough by a factor of both directions.
//!
//! Seen from within it is behind the interface, and its scattered light is refracted into the solid: a Lambertian lobe with
//! sines divided by the index of refraction. So it fills the cone from which light gets out again, and none is trapped by
//! total reflection. There it has besides what the facets of the interface reflect more than once; where nothing but the
//! interface is there, in all directions.

use super::*;
use crate::optics::{
    curve::Curve,
    lobe::{Horizon, Lobe, raw_sample},
    rough_diffuse::rough_diffuse,
    scattering::{scattered_within, scatters_within},
};

/// Rounding of a squared sine at the edge of the cone.
pub const BASE_EDGE: f64 = 1.00001;

/// The Lambertian base layer.
#[derive(Debug)]
pub struct Base;

impl<T: Real> LayerModel<T> for Base {
    const LAYER: Layer = Layer::Base;

    inlined! {
        fn is_there(material: &Material<T>, surface: &Surface<T>) -> T::Mask {
            material.has_base() | scatters_within(material, surface)
        }

        /// Lambert's lobe, its rare samples below the geometric surface mirrored.
        fn lobe<'a>(_: &Material<T>, _: &'a [f32], surface: &Surface<T>) -> LayerLobe<'a, T> {
            LayerLobe {
                shape: base_shape(),
                frame: surface.frame,
            }
        }

        /// A metal has no layer below.
        fn albedo(material: &Material<T>, tables: &[f32], surface: &Surface<T>, left: Vec3<T>) -> LayerAlbedo<T> {
            let (white, one) = (Vec3::ONE, T::ONE);
            let left_by_metal = left * (one - material.metalness);
            let mut albedo = LayerAlbedo {
                reflected: material.base_color * left_by_metal * (one - material.transmission_weight),
                transmittance: white,
            };
            if scatters_within(material, surface).any() {
                let again = scattered_within(material, surface, &material.shape(tables));
                albedo.reflected += again * (material.transmission_weight * (one - material.metalness));
                // The rest is refracted.
                let share = again * left.map(|left: T| one / left.max(T::from_f64(1e-9)));
                albedo.transmittance = (white - share).at_least_zero();
            }
            albedo
        }

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
            let is_rough = material.diffuse_roughness.above_zero() & !surface.is_within(material);
            if is_rough.any() {
                let cosines = mapped!([surface.wo, wi], |direction| surface.frame.normal.dot(direction));
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
        fn choose(_: &Material<T>, layers: &mut Layers<T>, below: T) -> T {
            layers[Layer::Base].albedo.luminance() + below
        }

        fn chance(layers: &Layers<T>) -> T {
            let (base, through) = (layers[Layer::Base].probability, layers[Layer::Transmission].probability);
            let share = base / (base + through).max(T::from_f64(1e-20));
            T::select(through.above_zero(), share, T::ONE)
        }

        fn refined_sample(material: &Material<T>, surface: &Surface<T>, xi: [T; 3], drawn: LobeSample<T>) -> LobeSample<T> {
            let spread = base_spread(material, surface);
            let is_narrow = spread.less(T::ONE);
            if !is_narrow.any() {
                return drawn;
            }
            let normal = surface.frame.normal;
            let wide = raw_sample(&base_shape(), &surface.frame, surface.wo, xi);
            let cosine = normal.dot(wide);
            let height = (T::ONE - spread * spread * (T::ONE - cosine * cosine)).safe_sqrt();
            let raw = wide * spread + normal * (height - spread * cosine);
            let below = surface.normal.dot(raw).below_zero();
            let wi = Vec3::select(below, raw.reflected_at_plane(surface.normal), raw);
            LobeSample {
                wi: Vec3::select(is_narrow, wi, drawn.wi),
                weight: T::select(is_narrow, T::ONE, drawn.weight),
            }
        }

        fn refined(material: &Material<T>, surface: &Surface<T>, wi: Vec3<T>, [value, density]: [T; 2]) -> [T; 2] {
            let spread = base_spread(material, surface);
            let is_narrow = spread.less(T::ONE);
            if !is_narrow.any() {
                return [value, density];
            }
            let folded = wi.reflected_at_plane(surface.normal);
            let narrow = mapped!([wi, folded], |light| narrow_density(surface.frame.normal.dot(light), spread));
            let is_above = surface.normal.dot(wi).above_zero();
            let narrow = (narrow[0] + narrow[1]).masked(is_above);
            mapped!([value, density], |wide| T::select(is_narrow, narrow, wide))
        }
    }
}

#[inline(always)]
pub fn base_shape<'a, T: Real>() -> LobeShape<'a, T> {
    LobeShape {
        lobe: Lobe::Lambert,
        curve: Curve::Sqrt,
        horizon: Horizon::Mirror,
        roughness: T::ONE,
        anisotropy: T::ZERO,
        eta: T::ZERO,
        table: &[],
    }
}

inlined! {
    /// The sine of the widest angle to which the base scatters: 1 but from within, behind the interface.
    fn base_spread<T: Real>(material: &Material<T>, surface: &Surface<T>) -> T {
        let is_behind = surface.is_within(material) & material.has_base();
        T::select(is_behind, material.ior_ahead(is_behind), T::ONE)
    }

    /// The density of Lambert's lobe with its sines multiplied by `spread`, at a cosine.
    fn narrow_density<T: Real>(cosine: T, spread: T) -> T {
        let square = spread * spread;
        let is_in_cone = (T::ONE - cosine * cosine).less(square * T::from_f64(BASE_EDGE));
        let density = cosine * T::FRAC_1_PI / square;
        density.masked(cosine.above_zero() & is_in_cone)
    }
}
