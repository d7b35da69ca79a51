//! Emission from a texture.

use super::{Constant, Effect};
use crate::optics::material::NO_TEXTURE;

pub(super) const EFFECT: Effect = Effect {
    name: "emission-texture",
    label: "Emission textures",
    help: "Emission looked up in the model's pictures.",
    constant: Constant::flag("PLAN_EMISSION_TEXTURES"),
    decide: |facts| facts.needed_by(|m| m.textures[3] != NO_TEXTURE, "takes its emission from a texture"),
    remove: Some(|document| {
        for material in &mut document.materials {
            material.textures.emission = false;
        }
    }),
};
