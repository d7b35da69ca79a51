//! The diffuse base.

use super::{Constant, Effect};
use crate::optics::material::Material;

pub(super) const EFFECT: Effect = Effect {
    name: "base",
    label: "Diffuse base",
    help: "Light that enters the surface and leaves it in all directions (Lambert).",
    constant: Constant::flag("PLAN_BASE"),
    decide: |facts| facts.needed_by(Material::has_base, "has a diffuse base"),
    remove: Some(|document| {
        for material in &mut document.materials {
            material.base_weight = 0.0;
        }
        document.lighting.ground_color = [0.0; 3];
    }),
};
