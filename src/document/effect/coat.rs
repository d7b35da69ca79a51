//! A clear layer over everything.

use super::{Constant, Effect};

pub(super) const EFFECT: Effect = Effect {
    name: "coat",
    label: "Coat",
    help: "A clear layer over the other lobes, with a reflection of its own.",
    constant: Constant::flag("PLAN_COAT"),
    decide: |facts| facts.needed_by(|m| m.coat_weight > 0.0, "has a coat"),
    remove: Some(|document| {
        for material in &mut document.materials {
            material.coat_weight = 0.0;
        }
    }),
};
