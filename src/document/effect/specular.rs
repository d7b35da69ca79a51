//! The reflecting lobe.

use super::{Constant, Effect};
use crate::optics::material::Material;

pub(super) const EFFECT: Effect = Effect {
    name: "specular",
    label: "Specular lobe",
    help: "Light that the surface reflects around the mirror direction.",
    constant: Constant::flag("PLAN_SPECULAR"),
    decide: |facts| facts.needed_by(Material::has_specular, "reflects"),
    remove: Some(|document| {
        for material in &mut document.materials {
            material.specular_weight = 0.0;
            material.transmission_weight = 0.0;
        }
    }),
};
