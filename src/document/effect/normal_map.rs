//! Normals from a texture.

use super::{Constant, Effect};
use crate::optics::material::NO_TEXTURE;

pub(super) const EFFECT: Effect = Effect {
    name: "normal-map",
    label: "Normal maps",
    help: "Shading normals bent by the model's pictures.",
    constant: Constant::flag("PLAN_NORMAL_MAPS"),
    decide: |facts| facts.needed_by(|m| m.textures[2] != NO_TEXTURE, "has a normal map"),
    remove: Some(|document| {
        for material in &mut document.materials {
            material.textures.normal = false;
        }
    }),
};
