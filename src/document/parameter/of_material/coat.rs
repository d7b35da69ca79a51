//! The parameters of a material's coat.

use super::{bar, number, of, unit_number};
use crate::document::CoatLobe;
use crate::document::parameter::accessors::{choice, field};
use crate::document::parameter::{Kind, Parameter, choices};

/// The parameters of a material's coat, in the order of the panels.
pub(super) fn parameters() -> Vec<Parameter> {
    vec![
        Parameter {
            label: "Weight",
            help: "A layer of clear lacquer over everything else.",
            applies: |_| true,
            ..of("coat.weight", unit_number(), field!(Number coat_weight))
        },
        Parameter {
            label: "Weight texture",
            help: "Multiplies the weight by a texture.",
            ..of("coat.weight_texture", Kind::Toggle, field!(Toggle textures.coat))
        },
        Parameter {
            label: "Lobe",
            help: "The model of how the coat spreads reflected light.",
            ..of("coat.lobe", choices::<CoatLobe>(), choice!(coat_lobe))
        },
        Parameter {
            label: "Roughness",
            symbol: "R",
            help: "How far the coat spreads its reflection.",
            ..of("coat.roughness", unit_number(), field!(Number coat_roughness))
        },
        Parameter {
            label: "Roughness texture",
            help: "Multiplies GGX's roughness of the coat by a texture.",
            ..of(
                "coat.roughness_texture",
                Kind::Toggle,
                field!(Toggle textures.coat_roughness),
            )
        },
        Parameter {
            label: "Anisotropy",
            help: "Stretches the coat's reflection along the tangent of what lies below, or across it below 0.",
            ..of(
                "coat.anisotropy",
                number([-1.0, 1.0], ""),
                field!(Number coat_anisotropy),
            )
        },
        Parameter {
            label: "Index of refraction",
            symbol: "n",
            help: "How strongly the coat reflects: lacquer 1.5, oil 1.4, at 1 nothing.",
            row: bar(1.0, 2.5),
            ..of("coat.ior", number([1.0, 4.0], ""), field!(Number coat_ior))
        },
        Parameter {
            label: "Colour",
            help: "Colours what is seen through the coat.",
            ..of("coat.color", Kind::Color, field!(Color coat_color))
        },
        Parameter {
            label: "Colour texture",
            help: "Multiplies the colour of the coat by a texture.",
            ..of("coat.color_texture", Kind::Toggle, field!(Toggle textures.coat_color))
        },
        Parameter {
            label: "Darkening",
            help: "How much darker a base gets by light that the coat reflects back onto it: varnish on wood. A white base stays white.",
            ..of("coat.darkening", unit_number(), field!(Number coat_darkening))
        },
        Parameter {
            label: "On the base",
            help: "The coat changes what lies below, as in OpenPBR: its reflection, roughness, emission and colour by angle. Off, as in glTF, it does not.",
            ..of("coat.on_base", Kind::Toggle, field!(Toggle coat_on_base))
        },
        Parameter {
            label: "Normal strength",
            help: "Scales the slopes of the coat's normal texture.",
            applies: |material| material.coat_weight > 0.0 && material.textures.coat_normal,
            row: bar(0.0, 2.0),
            ..of(
                "coat.normal_strength",
                number([-10.0, 10.0], ""),
                field!(Number coat_normal_strength),
            )
        },
        Parameter {
            label: "Normal texture",
            help: "Bends the coat's normal by a texture.",
            ..of("coat.normal_texture", Kind::Toggle, field!(Toggle textures.coat_normal))
        },
    ]
}
