//! Tiles that rest.

use super::{Decision, Effect};

pub(super) const EFFECT: Effect = Effect {
    name: "adaptive-sampling",
    label: "Adaptive sampling",
    help: "Tiles rest while others need samples more, so that time goes where the error is.",
    constant: None,
    decide: |facts| {
        let render = &facts.document.render;
        match (render.is_adaptive(), render.noise) {
            (false, _) => Decision::off("every pixel gets as many samples"),
            (true, Some(noise)) => Decision::on(format!("samples go where the error is, until the noise is {noise}")),
            (true, None) => Decision::on("samples go where the error is"),
        }
    },
    remove: Some(|document| document.render.adaptive = Some(false)),
};
