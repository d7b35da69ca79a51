//! What is written beside the light.

use super::{Decision, Effect};

pub(super) const EFFECT: Effect = Effect {
    name: "picture-layers",
    label: "Picture layers (AOVs)",
    help: "Albedo, normal and distance of what is seen, by a pass of their own.",
    constant: None,
    decide: |_| Decision::off("drawn only when a picture with layers is saved"),
    remove: None,
};
