//! Light from far away.

use super::{Decision, Effect};

pub(super) const EFFECT: Effect = Effect {
    name: "environment",
    label: "Environment light",
    help: "Light that arrives from the environment map.",
    constant: None,
    decide: |facts| {
        if facts.environment.is_black || facts.settings.environment_strength == 0.0 {
            Decision::off("the environment is black")
        } else {
            Decision::on("the environment shines")
        }
    },
    remove: Some(|document| document.lighting.strength = 0.0),
};
