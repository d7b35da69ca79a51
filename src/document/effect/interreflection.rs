//! Surfaces that see other surfaces.

use super::{Constant, Decision, Effect};

pub(super) const EFFECT: Effect = Effect {
    name: "interreflection",
    label: "Shadows and interreflection",
    help: "Rays that leave a surface and may meet another one.",
    constant: Constant::flag("PLAN_INTERREFLECTION"),
    decide: |facts| {
        if facts.geometry.is_convex {
            Decision::off("the scene is one convex body: what leaves its outside meets nothing")
        } else if facts.settings.bounces <= 1 {
            Decision::on("paths end at the first surface, but shadows are cast")
        } else {
            Decision::on("surfaces may see each other")
        }
    },
    remove: None,
};
