//! KHR_materials_anisotropy: a highlight of two widths, given by the roughness of the narrower one and a strength.
//!
//! Across the direction of anisotropy α is roughness², along it mix(roughness², 1, strength²).

use crate::{
    optics::lobe::{anisotropy_from_ratio, stretch_from_anisotropy},
    scene::{
        Slot, Texture, TextureRef,
        texture::{TextureTarget, texture_mean},
    },
};

/// Two widths in one of the two parametrisations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Widths {
    /// glTF's is that of the narrower width, Glossmith's that of the mean of both.
    pub roughness: f32,
    /// glTF's strength in [0, 1], or Glossmith's anisotropy in [0, 1].
    pub stretch: f32,
    /// True if the conversion is exact.
    pub is_exact: bool,
}

/// Relative tolerance for rounding.
const ROUNDING: f64 = 1e-6;

/// Glossmith's widths from glTF's roughness and strength. Beyond Glossmith's limit, the longer width is kept.
pub fn widths_from_gltf(roughness: f32, strength: f32) -> Widths {
    let across = f64::from(roughness.clamp(0.0, 1.0)).powi(2);
    let along = across + (1.0 - across) * f64::from(strength.clamp(0.0, 1.0)).powi(2);
    if along <= across {
        return Widths {
            roughness,
            stretch: 0.0,
            is_exact: true,
        };
    }
    let ratio_min = stretch_from_anisotropy(1.0_f64).powi(-2);
    let is_exact = across >= along * ratio_min * (1.0 - ROUNDING);
    let across = across.max(along * ratio_min);
    Widths {
        roughness: (along * across).powf(0.25) as f32,
        stretch: anisotropy_from_ratio(across / along) as f32,
        is_exact,
    }
}

/// glTF's widths of Glossmith's roughness and anisotropy, whichever its sign. α is at most 1 there.
pub fn gltf_from_widths(roughness: f32, anisotropy: f32) -> Widths {
    let stretch = stretch_from_anisotropy(f64::from(anisotropy.abs()));
    let alpha = f64::from(roughness).powi(2);
    let [along, across] = [alpha * stretch, alpha / stretch];
    let strength_squared = if along > across {
        (along - across) / (1.0 - across)
    } else {
        0.0
    };
    Widths {
        roughness: across.sqrt() as f32,
        stretch: strength_squared.min(1.0).sqrt() as f32,
        is_exact: strength_squared <= 1.0 + ROUNDING,
    }
}

/// Converts a slot from glTF's roughness and strength to ours. A varying roughness texture is copied with the wider
/// highlight per texel; the anisotropy is that of its mean. Returns whether both widths are exact.
pub fn convert_widths(slot: &mut Slot, textures: &mut Vec<Texture>) -> bool {
    let [roughness, strength] = ["specular.roughness", "specular.anisotropy"].map(|key| slot.number(key));
    let Some(place) = slot.texture(TextureTarget::Roughness) else {
        let widths = widths_from_gltf(roughness, strength);
        slot.set("specular.roughness", widths.roughness);
        slot.set("specular.anisotropy", widths.stretch);
        return widths.is_exact;
    };
    let mut widened = textures[place.texture].clone();
    let mean = widths_from_gltf(roughness * texture_mean(&widened).codes[1], strength);
    widened.rgba16.clear();
    for texel in widened.rgba8.as_chunks_mut::<4>().0 {
        let roughness = roughness * f32::from(texel[1]) / 255.0;
        texel[1] = (255.0 * widths_from_gltf(roughness, strength).roughness).round() as u8;
    }
    let texture = textures.len();
    *slot.texture_mut(TextureTarget::Roughness) = Some(TextureRef { texture, ..place });
    textures.push(widened);
    slot.set("specular.roughness", 1.0);
    slot.set("specular.anisotropy", mean.stretch);
    mean.is_exact
}
