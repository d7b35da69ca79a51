//! What the camera sees beside the model.

use super::{Decision, Effect};
use crate::document::Background;

pub(super) const EFFECT: Effect = Effect {
    name: "background",
    label: "Background",
    help: "The environment, seen by the camera where it meets nothing.",
    constant: None,
    decide: |facts| match facts.document.lighting.background {
        Background::Environment => Decision::on("the environment is visible"),
        Background::Transparent => Decision::off("the background is transparent"),
        Background::Color(_) => Decision::off("the background is one colour"),
    },
    remove: Some(|document| document.lighting.background = Background::Transparent),
};
