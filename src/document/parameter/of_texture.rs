//! How an image of the user's own is mapped onto a material.

use std::sync::LazyLock;

use super::accessors::{choice, field};
use super::{Kind, Parameter, Stage, choices};
use crate::scene::texture::{TextureChannel, TextureProjection, TextureSpace, UserTexture};

/// Every parameter of an image on a material, in the order of its rows; the keys are those inside its object in files, and on
/// the command line behind that of the parameter that it textures.
pub static TEXTURE_PARAMETERS: LazyLock<Vec<Parameter<UserTexture>>> = LazyLock::new(all);

type Accessors = super::Accessors<UserTexture>;

#[rustfmt::skip]
fn all() -> Vec<Parameter<UserTexture>> {
    vec![
        of("strength", "Strength", "Blend amount. 0 leaves the parameter unchanged. Bumps have a strength of their own.", range([0.0, 1.0], ""), field!(Number strength)).bar(0.0, 1.0),
        of("scale", "Scale", "Repetitions across the texture coordinates, or across the model.", range([1e-3, 1e3], ""), field!(Number scale)).bar(0.1, 10.0),
        of("stretch", "Stretch", "Vertical tiling relative to horizontal.", range([1e-2, 1e2], ""), field!(Number stretch)).bar(0.1, 10.0),
        of("rotation", "Rotation", "Turns the image anticlockwise about its centre.", range([-360.0, 360.0], "°"), field!(Number rotation_deg)).bar(-180.0, 180.0).decimals(1),
        of("offset_u", "Offset right", "Offset to the right, in image widths.", range([-100.0, 100.0], ""), field!(Number offset[0])).bar(-1.0, 1.0),
        of("offset_v", "Offset up", "Offset upwards, in image heights.", range([-100.0, 100.0], ""), field!(Number offset[1])).bar(-1.0, 1.0),
        of("projection", "Projection", "Projection onto the surface.", choices::<TextureProjection>(), choice!(projection)),
        of("channel", "Channel", "Channel to use for a single number.", choices::<TextureChannel>(), choice!(channel)),
        of("color_space", "Colour space", "Colour space of the image.", choices::<TextureSpace>(), choice!(space)),
        of("inverted", "Inverted", "Dark counts as bright: gloss for roughness. Of a normal map, green points downwards, as DirectX has it.", Kind::Toggle, field!(Toggle inverted)),
    ]
}

fn range(range: [f32; 2], unit: &'static str) -> Kind {
    Kind::Number { range, unit }
}

fn of(
    key: &'static str,
    label: &'static str,
    help: &'static str,
    kind: Kind,
    accessors: Accessors,
) -> Parameter<UserTexture> {
    Parameter {
        group: "Texture",
        ..Parameter::plain(key, label, help, kind, Stage::Materials, accessors)
    }
}
