//! Directions drawn from the environment.

use super::{Constant, Decision, Effect, Switch};
use crate::document::Strategy;
use crate::optics::material::Material;

pub(super) const EFFECT: Effect = Effect {
    name: "light-sampling",
    label: "Sampling the environment",
    help: "Directions drawn where the environment is bright, a shadow ray for each.",
    constant: Constant::flag("PLAN_LIGHT_SAMPLING"),
    decide: |facts| {
        let environment = facts.environment;
        if environment.is_black || facts.settings.environment_strength == 0.0 {
            Decision::off("the environment is black")
        } else if environment.is_constant {
            Decision::off("the environment is equally bright everywhere")
        } else if facts.settings.strategy == Strategy::Lobe {
            Decision::off("light is found by the lobes alone")
        } else if facts.materials.iter().all(Material::is_mirror) {
            Decision::off("every surface is a mirror, which meets light in one direction only")
        } else {
            Decision::on("the environment is brighter here than there")
        }
    },
    remove: Some(|document| document.render.effects.set("light-sampling", Switch::Off)),
};
