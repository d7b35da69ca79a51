//! A lens that is open.

use super::{Constant, Decision, Effect};

pub(super) const EFFECT: Effect = Effect {
    name: "depth-of-field",
    label: "Depth of field",
    help: "Rays from all over the lens: sharp only at the distance of focus.",
    constant: Constant::flag("PLAN_LENS"),
    decide: |facts| {
        if facts.settings.camera.lens_radius > 0.0 {
            Decision::on("the lens is open")
        } else {
            Decision::off("the camera is a pinhole")
        }
    },
    remove: Some(|document| document.camera.aperture = 0.0),
};
