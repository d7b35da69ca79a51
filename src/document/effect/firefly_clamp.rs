//! A limit on the radiance of indirect light.

use super::{Constant, Decision, Effect};

pub(super) const EFFECT: Effect = Effect {
    name: "firefly-clamp",
    label: "Firefly clamp",
    help: "Light that was reflected twice or more is limited: less noise, and less energy than there is.",
    constant: Constant::flag("PLAN_FIREFLY_CLAMP"),
    decide: |facts| match facts.document.render.firefly_clamp {
        Some(limit) => Decision::on(format!("limited to a radiance of {limit}")),
        None => Decision::off("no limit is set"),
    },
    remove: Some(|document| document.render.firefly_clamp = None),
};
