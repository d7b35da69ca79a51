//! A clear dielectric coat over all other layers: OpenPBR's coat, glTF's clearcoat.
//!
//! Its lobe is the isotropic geometric lobe with the curve `smooth`, for any lobe below, with the exact Fresnel equations of
//! a dielectric. The rest reaches the layers below, tinted by its colour: coat + (1 − albedo of the coat) · colour · below,
//! so that no energy is created (the layering of OpenPBR 1.1, section on the coat). It neither blurs the layers below nor
//! follows a normal map. It is absent from within a solid.

use super::{Layer, LayerAlbedo, LayerLobe, LayerModel, LayerToward, LayerTraits, Layers};
use crate::optics::albedo::albedo_lookup;
use crate::optics::curve::Curve;
use crate::optics::frame::frame_from_normal;
use crate::optics::fresnel::{fresnel_dielectric, half_vector_cosine};
use crate::optics::lobe::{Horizon, Lobe, LobeSample, LobeShape};
use crate::optics::material::{Material, Surface};
use crate::optics::real::Real;
use crate::optics::vector::Vec3;

/// The clear coat layer.
#[derive(Debug)]
pub struct Coat;

impl<T: Real> LayerModel<T> for Coat {
    const LAYER: Layer = Layer::Coat;
    const TRAITS: LayerTraits = LayerTraits {
        is_cover: true,
        refines: true,
        ..LayerTraits::PLAIN
    };

    #[inline(always)]
    fn is_there(material: &Material<T>, surface: &Surface<T>) -> T::Mask {
        T::zero().less(material.coat_weight) & !surface.is_within(material)
    }

    #[inline(always)]
    fn lobe<'a>(material: &Material<T>, _: &'a [f32], surface: &Surface<T>) -> LayerLobe<'a, T> {
        LayerLobe {
            shape: coat_shape(material),
            frame: frame_from_normal(surface.coat_normal),
        }
    }

    #[inline(always)]
    fn albedo(material: &Material<T>, tables: &[f32], surface: &Surface<T>, _: Vec3<T>) -> LayerAlbedo<T> {
        let cosine = surface.coat_normal.dot(surface.wo);
        let share = material.coat_weight * albedo_lookup(tables, material.coat_table, cosine).x;
        let color = Vec3::splat(T::one()).mix(material.coat_color, material.coat_weight);
        LayerAlbedo {
            reflected: Vec3::splat(share),
            transmittance: color * (T::one() - share).max(T::zero()),
        }
    }

    #[inline(always)]
    fn toward(_: &Material<T>, layers: &Layers<T>, _: &Surface<T>, _: &LobeShape<'_, T>, _: Vec3<T>) -> LayerToward<T> {
        LayerToward {
            color: Vec3::splat(T::one()),
            probability: layers[Layer::Coat].probability,
        }
    }

    #[inline(always)]
    fn refined_sample(material: &Material<T>, surface: &Surface<T>, _: [T; 3], drawn: LobeSample<T>) -> LobeSample<T> {
        LobeSample {
            weight: coat_fresnel(material, surface.wo, drawn.wi) * drawn.weight,
            ..drawn
        }
    }

    #[inline(always)]
    fn refined(material: &Material<T>, surface: &Surface<T>, wi: Vec3<T>, [value, density]: [T; 2]) -> [T; 2] {
        [value * coat_fresnel(material, surface.wo, wi), density]
    }
}

/// The coat's lobe.
#[inline(always)]
pub fn coat_shape<T: Real>(material: &Material<T>) -> LobeShape<'static, T> {
    LobeShape {
        lobe: Lobe::Geometric,
        curve: Curve::Smooth,
        horizon: Horizon::Mirror,
        roughness: material.coat_roughness,
        anisotropy: T::zero(),
        eta: T::zero(),
        table: &[],
    }
}

/// The share that the coat reflects into a direction of its lobe.
#[inline(always)]
fn coat_fresnel<T: Real>(material: &Material<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
    material.coat_weight * fresnel_dielectric(half_vector_cosine(wo, wi), material.coat_ior)
}
