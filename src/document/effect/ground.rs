//! The plane that the model stands on.

use super::{Decision, Effect};

pub(super) const EFFECT: Effect = Effect {
    name: "ground",
    label: "Ground",
    help: "A plane that catches shadows and reflections.",
    constant: None,
    decide: |facts| {
        if facts.document.ground {
            Decision::on("the model stands on a ground")
        } else {
            Decision::off("there is no ground")
        }
    },
    remove: Some(|document| document.ground = false),
};
