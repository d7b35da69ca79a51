//! The parameters of a material's coat.

use super::{number, of, unit_number};
use crate::document::CoatLobe;
use crate::document::parameter::accessors::{choice, field};
use crate::document::parameter::{Kind, Parameter, choices};
use crate::scene::texture::TextureTarget as On;

/// The parameters of a material's coat, in the order of the panels.
#[rustfmt::skip]
pub(super) fn parameters() -> Vec<Parameter> {
    vec![
        of("coat.weight", "Weight", "A layer of clear lacquer over everything else.", unit_number(), field!(Number coat_weight))
            .applies(|_| true),
        of("coat.weight_texture", "Weight texture", "Multiplies the weight by a texture.", Kind::Toggle, field!(Toggle textures[On::Coat])),
        of("coat.lobe", "Lobe", "The model of how the coat spreads reflected light.", choices::<CoatLobe>(), choice!(coat_lobe)),
        of("coat.roughness", "Roughness", "How far the coat spreads its reflection.", unit_number(), field!(Number coat_roughness))
            .symbol("R"),
        of("coat.roughness_texture", "Roughness texture", "Multiplies GGX's roughness of the coat by a texture.", Kind::Toggle, field!(Toggle textures[On::CoatRoughness])),
        of("coat.anisotropy", "Anisotropy", "Stretches the coat's reflection along the tangent of what lies below, or across it below 0.", number([-1.0, 1.0], ""), field!(Number coat_anisotropy)),
        of("coat.ior", "Index of refraction", "How strongly the coat reflects: lacquer 1.5, oil 1.4, at 1 nothing.", number([1.0, 4.0], ""), field!(Number coat_ior))
            .symbol("n").bar(1.0, 2.5),
        of("coat.color", "Colour", "Colours what is seen through the coat.", Kind::Color, field!(Color coat_color)),
        of("coat.color_texture", "Colour texture", "Multiplies the colour of the coat by a texture.", Kind::Toggle, field!(Toggle textures[On::CoatColor])),
        of("coat.darkening", "Darkening", "How much darker a base gets by light that the coat reflects back onto it: varnish on wood. A white base stays white.", unit_number(), field!(Number coat_darkening)),
        of("coat.on_base", "On the base", "The coat changes what lies below, as in OpenPBR: its reflection, roughness, emission and colour by angle. Off, as in glTF, it does not.", Kind::Toggle, field!(Toggle coat_on_base)),
        of("coat.normal_strength", "Normal strength", "Scales the slopes of the coat's normal texture.", number([-10.0, 10.0], ""), field!(Number coat_normal_strength))
            .applies(|material| material.coat_weight > 0.0 && material.textures[On::CoatNormal]).bar(0.0, 2.0),
        of("coat.normal_texture", "Normal texture", "Bends the coat's normal by a texture.", Kind::Toggle, field!(Toggle textures[On::CoatNormal])),
    ]
}
