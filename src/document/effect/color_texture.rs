//! Colour from a texture.

use super::{Constant, Effect};
use crate::optics::material::NO_TEXTURE;

pub(super) const EFFECT: Effect = Effect {
    name: "color-texture",
    label: "Colour textures",
    help: "Base colours looked up in the model's pictures.",
    constant: Constant::flag("PLAN_COLOR_TEXTURES"),
    decide: |facts| facts.needed_by(|m| m.textures[0] != NO_TEXTURE, "takes its colour from a texture"),
    remove: Some(|document| {
        for material in &mut document.materials {
            material.textures.color = false;
        }
    }),
};
