//! How a picture of the user's own is put on a material.

use std::sync::LazyLock;

use super::{Kind, Parameter, Stage, Value, choices};
use crate::named::Named;
use crate::scene::texture::{OwnTexture, TextureChannel, TextureProjection, TextureSpace};

/// Every parameter of a picture on a material, in the order of its rows; the keys are those inside its object in files, and on
/// the command line behind that of what it is put on.
pub static TEXTURE_PARAMETERS: LazyLock<Vec<Parameter<OwnTexture>>> = LazyLock::new(all);

type Accessors = super::Accessors<OwnTexture>;

/// Reads and writes a number.
macro_rules! number {
    ($($field:tt)*) => {
        (
            |texture: &OwnTexture| Value::Number(texture.$($field)*),
            |texture: &mut OwnTexture, value: Value| {
                if let Value::Number(value) = value {
                    texture.$($field)* = value;
                }
            },
        )
    };
}

/// Reads and writes one of a closed list.
macro_rules! choice {
    ($field:ident) => {
        (
            |texture: &OwnTexture| Value::Choice(texture.$field.name()),
            |texture: &mut OwnTexture, value: Value| {
                if let Value::Choice(name) = value
                    && let Some(choice) = Named::by_name(name)
                {
                    texture.$field = choice;
                }
            },
        )
    };
}

#[rustfmt::skip]
fn all() -> Vec<Parameter<OwnTexture>> {
    let inverted: Accessors = (
        |texture| Value::Toggle(texture.inverted),
        |texture, value| {
            if let Value::Toggle(is_on) = value {
                texture.inverted = is_on;
            }
        },
    );
    vec![
        of("strength", "Strength", "Blend amount. 0 leaves the parameter unchanged. Bumps have a strength of their own.", range([0.0, 1.0], ""), number!(strength)).row([0.0, 1.0], 3),
        of("scale", "Scale", "Repetitions across the texture coordinates, or across the model.", range([1e-3, 1e3], ""), number!(scale)).row([0.1, 10.0], 3),
        of("stretch", "Stretch", "Vertical tiling relative to horizontal.", range([1e-2, 1e2], ""), number!(stretch)).row([0.1, 10.0], 3),
        of("rotation", "Rotation", "Turns the image anticlockwise about its centre.", range([-360.0, 360.0], "°"), number!(rotation_deg)).row([-180.0, 180.0], 1),
        of("offset_u", "Offset right", "Offset to the right, in image widths.", range([-100.0, 100.0], ""), number!(offset[0])).row([-1.0, 1.0], 3),
        of("offset_v", "Offset up", "Offset upwards, in image heights.", range([-100.0, 100.0], ""), number!(offset[1])).row([-1.0, 1.0], 3),
        of("projection", "Projection", "Projection onto the surface.", choices::<TextureProjection>(), choice!(projection)),
        of("channel", "Channel", "Channel to use for a single number.", choices::<TextureChannel>(), choice!(channel)),
        of("color_space", "Colour space", "Colour space of the image.", choices::<TextureSpace>(), choice!(space)),
        of("inverted", "Inverted", "Dark counts as bright: gloss for roughness. Of a normal map, green points downwards, as DirectX has it.", Kind::Toggle, inverted),
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
) -> Parameter<OwnTexture> {
    Parameter {
        group: "Texture",
        ..Parameter::plain(key, label, help, kind, Stage::Materials, accessors)
    }
}
