//! Surfaces with holes.

use super::{Constant, Effect};
use crate::optics::material::Material;

pub(super) const EFFECT: Effect = Effect {
    name: "alpha",
    label: "Opacity",
    help: "Surfaces that let some light go straight on.",
    constant: Constant::flag("PLAN_ALPHA"),
    decide: |facts| facts.needed_by(Material::has_holes, "is not opaque everywhere"),
    remove: Some(|document| {
        for material in &mut document.materials {
            material.textures.opacity = false;
            material.opacity = 1.0;
        }
    }),
};
