//! The inputs of OpenPBR's surface, wherever they are written.

use super::surface::{Surface, Takes};

/// Luminance of radiance 1, cd/m²: OpenPBR's emission is in nits.
pub(super) const NITS: f32 = 1000.0;

/// What an input is set to.
pub(super) enum Value {
    Number(f32),
    /// A colour, linear.
    Color([f32; 3]),
}

/// Its roughness and anisotropy a: α's along and across are r² √(2/(1 + (1 − a)²)) and (1 − a) times that.
fn roughness_and_anisotropy(surface: &Surface) -> (f32, f32) {
    let (ratio, _) = surface.ratio_and_rotation();
    let roughness = surface.roughness * widening(ratio);
    (roughness.min(1.0), 1.0 - ratio)
}

/// Its roughness over the one of the mean of both widths, by their ratio.
pub(super) fn widening(ratio: f32) -> f32 {
    ((1.0 + ratio * ratio) / (2.0 * ratio)).powf(0.25)
}

/// The widths that are shown: roughness is 1 at most.
pub(super) fn widths(surface: &Surface) -> [f32; 2] {
    let (roughness, anisotropy) = roughness_and_anisotropy(surface);
    let ratio = 1.0 - anisotropy;
    let along = roughness * roughness * (2.0 / (1.0 + ratio * ratio)).sqrt();
    [along, along * ratio]
}

impl Takes {
    /// What OpenPBR has a place for.
    pub const OPEN_PBR: Self = Self {
        law: super::surface::Law::Exact,
        widths,
        lacks: [&["specular.eta", "base.color_texture", "transmission.roughness"], &[]],
    };
}

/// The inputs with their values.
pub(super) fn inputs(surface: &Surface) -> Vec<(&'static str, Value)> {
    use Value::{Color, Number};
    let mut surface = surface.clone();
    surface.counter_coat();
    let surface = &surface;
    let (roughness, anisotropy) = roughness_and_anisotropy(surface);
    let coat_ratio = surface.coat_ratio();
    let (coat_roughness, coat_anisotropy) = (
        (surface.coat_roughness * widening(coat_ratio)).min(1.0),
        1.0 - coat_ratio,
    );
    let (strength, emission) = surface.strength_and_color();
    vec![
        ("base_weight", Number(1.0)),
        ("base_color", Color(surface.base_color)),
        ("base_diffuse_roughness", Number(surface.diffuse_roughness)),
        ("base_metalness", Number(surface.metalness)),
        ("specular_weight", Number(surface.specular_weight)),
        ("specular_color", Color(surface.tint())),
        ("specular_roughness", Number(roughness)),
        ("specular_ior", Number(surface.ior)),
        ("specular_roughness_anisotropy", Number(anisotropy)),
        ("transmission_weight", Number(surface.transmission_weight)),
        ("transmission_color", Color(surface.transmission_color)),
        ("transmission_depth", Number(surface.transmission_depth)),
        ("fuzz_weight", Number(surface.fuzz_weight)),
        ("fuzz_color", Color(surface.fuzz_color)),
        ("fuzz_roughness", Number(surface.fuzz_roughness)),
        ("thin_film_weight", Number(surface.film_weight)),
        ("thin_film_thickness", Number(surface.film_thickness)),
        ("thin_film_ior", Number(surface.film_ior)),
        ("coat_weight", Number(surface.coat_weight)),
        ("coat_color", Color(surface.coat_color)),
        ("coat_roughness", Number(coat_roughness)),
        ("coat_roughness_anisotropy", Number(coat_anisotropy)),
        ("coat_ior", Number(surface.coat_ior)),
        ("coat_darkening", Number(surface.coat_darkening)),
        ("emission_luminance", Number(strength * NITS)),
        ("emission_color", Color(emission)),
        ("geometry_opacity", Number(surface.opacity)),
    ]
}
