//! How a material reflects, to be compared with what a format has.

use crate::document::MaterialSettings;
use crate::optics::fresnel::{Fresnel, FresnelTerms, fresnel_f0, weighted_ior};
use crate::optics::thin_film::FilmTerms;
use crate::optics::vector::Vec3;

/// The Fresnel factor's terms of a material as it is edited.
pub(super) fn fresnel_terms(material: &MaterialSettings) -> FresnelTerms<f64> {
    let tint = Vec3::from_f32(shown_tint(material));
    let weight = f64::from(material.specular_weight);
    FresnelTerms {
        model: material.fresnel_model(),
        metal_f0: Vec3::from_f32(material.base_color) * f64::from(material.base_weight),
        metalness: f64::from(material.metalness),
        tint,
        metal_tint: if material.specular_on_metal {
            tint * weight
        } else {
            Vec3::splat(1.0)
        },
        edge_tint: Vec3::from_f32(material.edge_tint),
        weight: if material.has_weight_in_index() { 1.0 } else { weight },
        ior: match material.has_weight_in_index() {
            true => weighted_ior(material.ior.into(), weight),
            false => f64::from(material.ior),
        },
        eta: Vec3::from_f32(material.eta),
        k: Vec3::from_f32(material.k),
        // A thin film is reported as a part of its own.
        has_film: false,
        film: FilmTerms::none(),
    }
}

/// The tint that shows: only Schlick's reflectance head-on can be raised, up to 1.
pub(super) fn shown_tint(material: &MaterialSettings) -> [f32; 3] {
    let most = match material.fresnel_model() {
        Fresnel::Schlick => fresnel_f0(material.ior).recip(),
        _ => 1.0,
    };
    material.specular_color.map(|x| x.min(most))
}
