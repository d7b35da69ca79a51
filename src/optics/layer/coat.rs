//! A clear dielectric coat over all other layers: OpenPBR's coat, glTF's clearcoat.
//!
//! Its lobe is the geometric lobe with the curve `smooth`, or GGX, with the exact Fresnel equations of a dielectric. The rest
//! reaches the layers below: coat + (1 − albedo of the coat) · below, so that no energy is created. It has a normal
//! map of its own, and is absent from within a solid.
//!
//! A coat that changes what lies below ([`COATS_BASE`]) is OpenPBR 1.1's. Its index and roughness are in the material's
//! own; here are its darkening by light that it reflects back inside, and its absorption along the way of the light. Any
//! other coat is glTF's: its colour is that of every direction.

use super::*;
use crate::optics::{
    albedo::{albedo_number, azimuth_place, rough_albedo_number},
    coat_medium::{INNER_MAX, color_over, way_length},
    curve::Curve,
    frame::{frame_from_normal, frame_from_tangent},
    fresnel::{fresnel, fresnel_dielectric, half_vector_cosine},
    lobe::{Horizon, Lobe},
    material::{COAT_ABSORBS, COAT_IS_GGX, COATS_BASE},
    target::TextureTarget,
};

/// The clear coat layer.
#[derive(Debug)]
pub struct Coat;

impl<T: Real> LayerModel<T> for Coat {
    const LAYER: Layer = Layer::Coat;
    const IS_COVER: bool = true;

    inlined! {
        fn is_there(material: &Material<T>, surface: &Surface<T>) -> T::Mask {
            material.coat_weight.above_zero() & !surface.is_within(material)
        }

        /// Stretched along the tangent of the layers below.
        fn lobe<'a>(material: &Material<T>, _: &'a [f32], surface: &Surface<T>) -> LayerLobe<'a, T> {
            LayerLobe {
                shape: coat_shape(material),
                frame: coat_frame(material, surface),
            }
        }

        fn albedo(material: &Material<T>, tables: &[f32], surface: &Surface<T>, _: Vec3<T>) -> LayerAlbedo<T> {
            let cosine = surface.coat_normal.dot(surface.wo);
            let share = material.coat_weight * coat_albedo(material, tables, surface, cosine);
            let left = (T::ONE - share).max(T::ZERO);
            let white = Vec3::ONE;
            let mut transmittance = if material.has_flag(COATS_BASE) {
                white * left
            } else {
                white.mix(material.coat_color, material.coat_weight) * left
            };
            if material.coat_darkening.above_zero().any() {
                transmittance = transmittance * darkened(material, surface, cosine);
            }
            LayerAlbedo {
                reflected: Vec3::splat(share),
                transmittance,
            }
        }

        fn toward(_: &Material<T>, layers: &Layers<T>, _: &Surface<T>, _: &LobeShape<'_, T>, _: Vec3<T>) -> LayerToward<T> {
            LayerToward {
                color: Vec3::ONE,
                probability: layers[Layer::Coat].probability,
            }
        }

        fn refined_sample(material: &Material<T>, surface: &Surface<T>, _: [T; 3], drawn: LobeSample<T>) -> LobeSample<T> {
            LobeSample {
                weight: coat_fresnel(material, surface.wo, drawn.wi) * drawn.weight,
                ..drawn
            }
        }

        fn refined(material: &Material<T>, surface: &Surface<T>, wi: Vec3<T>, [value, density]: [T; 2]) -> [T; 2] {
            [value * coat_fresnel(material, surface.wo, wi), density]
        }
    }
}

inlined! {
    pub fn coat_shape<T: Real>(material: &Material<T>) -> LobeShape<'static, T> {
        let is_ggx = material.has_flag(COAT_IS_GGX);
        LobeShape {
            lobe: if is_ggx { Lobe::Ggx } else { Lobe::Geometric },
            curve: Curve::Smooth,
            horizon: Horizon::Mirror,
            roughness: material.coat_roughness,
            anisotropy: material.coat_anisotropy,
            eta: T::ZERO,
            table: &[],
        }
    }

    /// Albedo of a coat of weight 1.
    fn coat_albedo<T: Real>(material: &Material<T>, tables: &[f32], surface: &Surface<T>, cosine: T) -> T {
        let row = if material.has_texture(&[TextureTarget::CoatRoughness]) {
            material.coat_roughness
        } else if material.coat_anisotropy.differs(T::ZERO).any() {
            azimuth_place(material.coat_anisotropy, &coat_frame(material, surface), surface.wo)
        } else {
            return albedo_number(tables, material.coat_table, 0, cosine);
        };
        rough_albedo_number(tables, material.coat_table, 0, [cosine, row])
    }

    fn coat_frame<T: Real>(material: &Material<T>, surface: &Surface<T>) -> Frame<T> {
        if material.coat_anisotropy.differs(T::ZERO).any() {
            frame_from_tangent(surface.coat_normal, surface.frame.tangent, T::ZERO)
        } else {
            frame_from_normal(surface.coat_normal)
        }
    }

    /// The share that the coat reflects into a direction of its lobe.
    fn coat_fresnel<T: Real>(material: &Material<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
        material.coat_weight * fresnel_dielectric(half_vector_cosine(wo, wi), material.coat_ior)
    }

    /// What the layers below keep of their light if the coat reflects some of it back onto them each time: 1 over a white base.
    /// `cosine` is that of the view (OpenPBR 1.1, "Darkening").
    pub fn darkened<T: Real>(material: &Material<T>, surface: &Surface<T>, cosine: T) -> Vec3<T> {
        let (one, white) = (T::ONE, Vec3::ONE);
        let terms = material.fresnel_terms(surface.is_inside);
        let of_dielectric = fresnel(&terms.of_dielectric(), one);
        // What is refracted into the solid is not lost.
        let deeper = material
            .base_color
            .mix(material.transmission_tint, material.transmission_weight);
        let base = fresnel(&terms, one) + (white - of_dielectric) * deeper * (one - material.metalness);
        // Light of a rough base meets the coat from all directions, that of a smooth one at the angle of the view.
        let rough = material.ggx_roughness;
        let of_gloss = one + (rough - one) * of_dielectric.luminance().min(one);
        let spread = of_gloss + (rough - of_gloss) * material.metalness;
        let smooth = fresnel_dielectric(cosine, material.coat_ior);
        let inner = (smooth + (material.coat_inner - smooth) * spread).min(T::from_f64(INNER_MAX));
        let kept = base.map(|base: T| (one - inner) / (one - base.min(one) * inner));
        white.mix(kept, material.coat_weight * material.coat_darkening)
    }
}

/// What a diffuse base under the coat gets back of its own light: 1 − (1 − F̄)/η², F̄ the mean of the Fresnel factor over
/// all directions.
pub fn inner_reflection(ior: f64) -> f64 {
    const STEPS: u32 = 256;
    let step = 1.0 / f64::from(STEPS);
    let mean = (0..STEPS).map(|i| {
        let cosine = (f64::from(i) + 0.5) * step;
        2.0 * cosine * fresnel_dielectric(cosine, ior) * step
    });
    1.0 - (1.0 - mean.sum::<f64>()) / (ior * ior)
}

inlined! {
    /// What the coat's medium leaves of the light of the layers below, by its directions; for coats that absorb by their length
    /// of way. Light that goes on into the solid takes the way of the view twice, for it finds no coat on its way out.
    pub fn coat_tint<T: Real>(material: &Material<T>, layers: &Layers<T>, surface: &Surface<T>, wi: Vec3<T>) -> Vec3<T> {
        let white = Vec3::ONE;
        let reflected = layers[Layer::Coat].albedo.x;
        let left = (T::ONE - reflected).max(T::from_f64(1e-9));
        let share = (material.coat_weight - reflected).max(T::ZERO) / left;
        let out = surface.coat_normal.dot(surface.wo);
        let is_through = surface.normal.dot(wi).below_zero();
        let back = T::select(is_through, out, surface.coat_normal.dot(wi).abs());
        let way = way_length(material, out) + way_length(material, back);
        let tint = white.mix(color_over(material, way), share);
        Vec3::select(Coat::is_there(material, surface), tint, white)
    }

    /// True if the coat takes light of a layer below by the way through it.
    pub fn absorbs_over<T: Real>(material: &Material<T>, layer: Layer) -> bool {
        layer as u32 > Layer::Coat as u32 && material.has_flag(COAT_ABSORBS)
    }
}
