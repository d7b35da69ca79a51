//! How an image of the user's own is mapped onto a material.

use std::sync::LazyLock;

use super::{
    Parameter, Stage, Takes,
    accessors::{choice, field, rows, toggle},
    line::single,
};
use crate::scene::texture::{TextureChannel, TextureProjection, TextureSpace, UserTexture};

/// Every parameter of an image on a material, in the order of its rows; the keys are those inside its object in files, and on
/// the command line behind that of the parameter that it textures.
pub static TEXTURE_PARAMETERS: LazyLock<Vec<Parameter<UserTexture>>> = LazyLock::new(|| {
    rows! {
        "strength" "Strength" "Blend amount. 0 leaves the parameter unchanged. Bumps have a strength of their own." field(strength, single(0.0..=1.0, "")).bar(0.0, 1.0);
        "scale" "Scale" "Repetitions across the texture coordinates, or across the model." field(scale, single(1e-3..=1e3, "")).bar(0.1, 10.0);
        "stretch" "Stretch" "Vertical tiling relative to horizontal." field(stretch, single(1e-2..=1e2, "")).bar(0.1, 10.0);
        "rotation" "Rotation" "Turns the image anticlockwise about its centre." field(rotation_deg, single(-360.0..=360.0, "°")).bar(-180.0, 180.0).decimals(1);
        "offset_u" "Offset right" "Offset to the right, in image widths." field(offset[0], single(-100.0..=100.0, "")).bar(-1.0, 1.0);
        "offset_v" "Offset up" "Offset upwards, in image heights." field(offset[1], single(-100.0..=100.0, "")).bar(-1.0, 1.0);
        "projection" "Projection" "Projection onto the surface." choice(TextureProjection projection);
        "channel" "Channel" "Channel to use for a single number." choice(TextureChannel channel);
        "color_space" "Colour space" "Colour space of the image." choice(TextureSpace space);
        "inverted" "Inverted" "Dark counts as bright: gloss for roughness. Of a normal map, green points downwards, as DirectX has it." toggle(inverted);
    }
});

fn of(key: &'static str, label: &'static str, help: &'static str, takes: Takes<UserTexture>) -> Parameter<UserTexture> {
    Parameter {
        group: "Texture",
        ..Parameter::plain(key, label, help, takes, Stage::Materials)
    }
}
