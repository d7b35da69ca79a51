//! Surfaces that shine.

use super::{Constant, Effect};

pub(super) const EFFECT: Effect = Effect {
    name: "emission",
    label: "Emission",
    help: "Light that surfaces give off.",
    constant: Constant::flag("PLAN_EMISSION"),
    decide: |facts| facts.needed_by(|material| material.emission.max_component() > 0.0, "emits light"),
    remove: Some(|document| {
        document.lighting.area_lights.clear();
        for material in &mut document.materials {
            material.emission_strength = 0.0;
        }
    }),
};
