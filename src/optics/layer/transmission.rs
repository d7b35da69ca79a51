//! The refracting lobe: for microfacet lobes the share that the facet does not reflect, for others the mean share that the
//! specular lobe leaves.

use super::facet::{bends, left_by_facet, mirrored_share, shares_facets};
use super::*;
use crate::optics::{
    fresnel::fresnel, lobe::refracts_at_facets, refraction::refracting_cosines, scattering::interface_kept,
};

/// The refracting lobe.
#[derive(Debug)]
pub struct Transmission;

impl<T: Real> LayerModel<T> for Transmission {
    const LAYER: Layer = Layer::Transmission;

    inlined! {
        fn is_there(material: &Material<T>, _: &Surface<T>) -> T::Mask {
            material.transmits()
        }

        fn lobe<'a>(material: &Material<T>, tables: &'a [f32], surface: &Surface<T>) -> LayerLobe<'a, T> {
            LayerLobe {
                shape: material.transmission_shape(tables, surface.is_inside),
                frame: surface.frame,
            }
        }

        fn albedo(material: &Material<T>, _: &[f32], _: &Surface<T>, left: Vec3<T>) -> LayerAlbedo<T> {
            let left_by_metal = left * (T::ONE - material.metalness);
            LayerAlbedo {
                reflected: material.transmission_tint * left_by_metal * material.transmission_weight,
                transmittance: Vec3::ONE,
            }
        }

        fn toward(
            material: &Material<T>,
            layers: &Layers<T>,
            surface: &Surface<T>,
            shape: &LobeShape<'_, T>,
            wi: Vec3<T>,
        ) -> LayerToward<T> {
            let share = &layers[Layer::Transmission];
            let mut toward = LayerToward {
                color: share.albedo,
                probability: share.probability,
            };
            if !refracts_at_facets(shape) {
                return toward;
            }
            let cosines = refracting_cosines(surface.wo, wi, shape.eta);
            let straight = toward.color;
            toward.color = left_by_facet(material, surface, cosines);
            let is_shared = shares_facets(material);
            if is_shared.any() {
                let reflected = fresnel(&material.fresnel_terms(surface.is_inside), cosines[0]).luminance();
                let refracted = toward.color.luminance();
                let of_facets = T::ONE - layers[Layer::Base].probability;
                let share = T::ONE - mirrored_share(reflected, refracted);
                toward.probability = T::select(is_shared, of_facets * share, toward.probability);
            }
            let by_facet = toward.color * interface_kept(material, surface, shape, false).map(|kept| T::ONE / kept);
            toward.color = Vec3::select(bends(material), by_facet, straight);
            toward
        }

        /// The specular lobe sets how often its rest is sampled. Facets of another roughness let light through where the mean
        /// of the specular lobe's lets none: beyond its critical angle.
        fn choose(material: &Material<T>, layers: &mut Layers<T>, _below: T) -> T {
            transmission_estimate(material, layers)
        }

        /// It takes the rest of the samples.
        fn chance(_: &Layers<T>) -> T {
            T::ONE
        }
    }
}

/// The least share of samples for a refraction of another roughness than the reflection.
pub const APART_LEAST: f64 = 0.1;

/// Luminance of the refracting lobe, as samples are shared by it.
#[inline(always)]
pub fn transmission_estimate<T: Real>(material: &Material<T>, layers: &Layers<T>) -> T {
    let mean = layers[Layer::Transmission].albedo.luminance();
    let is_apart = material.transmits() & material.transmission_roughness.differs(material.roughness);
    T::select(is_apart, mean.max(T::from_f64(APART_LEAST)), mean)
}
