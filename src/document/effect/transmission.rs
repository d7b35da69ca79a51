//! Light that passes through surfaces.

use super::{Constant, Effect};
use crate::optics::material::Material;

pub(super) const EFFECT: Effect = Effect {
    name: "transmission",
    label: "Refraction",
    help: "Light that passes through surfaces and is refracted there.",
    constant: Constant::flag("PLAN_TRANSMISSION"),
    decide: |facts| facts.needed_by(Material::transmits, "transmits light"),
    remove: Some(|document| {
        for material in &mut document.materials {
            material.transmission_weight = 0.0;
        }
    }),
};
