//! Rectangles that shine.

use super::{Decision, Effect};

pub(super) const EFFECT: Effect = Effect {
    name: "area-lights",
    label: "Area lights",
    help: "Rectangles that shine beside the model.",
    constant: None,
    decide: |facts| match facts.document.lighting.area_lights.len() {
        0 => Decision::off("there is no area light"),
        1 => Decision::on("there is one area light"),
        lights => Decision::on(format!("there are {lights} area lights")),
    },
    remove: Some(|document| document.lighting.area_lights.clear()),
};
