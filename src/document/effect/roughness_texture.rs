//! Roughness and metalness from a texture.

use super::{Constant, Effect};
use crate::optics::material::NO_TEXTURE;

pub(super) const EFFECT: Effect = Effect {
    name: "roughness-texture",
    label: "Roughness textures",
    help: "Roughness and metalness looked up in the model's pictures.",
    constant: Constant::flag("PLAN_ROUGHNESS_TEXTURES"),
    decide: |facts| facts.needed_by(|m| m.textures[1] != NO_TEXTURE, "takes its roughness from a texture"),
    remove: Some(|document| {
        for material in &mut document.materials {
            material.textures.roughness = false;
        }
    }),
};
