//! Directions drawn from the triangles that emit.

use super::{Constant, Decision, Effect, Switch};
use crate::document::Strategy;
use crate::optics::material::Material;

pub(super) const EFFECT: Effect = Effect {
    name: "emitter-sampling",
    label: "Sampling emitters",
    help: "Directions drawn towards the triangles that emit, a shadow ray for each.",
    constant: Constant::flag("PLAN_EMITTER_SAMPLING"),
    decide: |facts| {
        if facts.settings.light_choice.density_per_luminance <= 0.0 {
            Decision::off("no triangle emits light")
        } else if facts.settings.strategy == Strategy::Lobe {
            Decision::off("light is found by the lobes alone")
        } else if facts.materials.iter().all(Material::is_mirror) {
            Decision::off("every surface is a mirror, which meets light in one direction only")
        } else {
            Decision::on("some triangles emit light")
        }
    },
    remove: Some(|document| document.render.effects.set("emitter-sampling", Switch::Off)),
};
