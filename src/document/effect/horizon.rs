//! What happens to samples below the surface.

use super::{Constant, Decision, Effect};
use crate::optics::lobe::{Horizon, Lobe};

pub(super) const EFFECT: Effect = Effect {
    name: "horizon",
    label: "Horizon",
    help: "What happens to samples of a lobe that point into the surface.",
    constant: Constant::choice("PLAN_HORIZON"),
    decide: |facts| {
        let crosses = |lobe: u32| !Lobe::ALL[lobe as usize].is_hemispherical();
        let shared = facts.shared(|m| m.horizon, |number| Horizon::ALL[number as usize].name());
        if facts.reflecting().all(|material| material.roughness == 0.0) {
            Decision {
                is_on: false,
                reason: "every lobe is a mirror: no sample points below the surface".to_owned(),
                ..shared
            }
        } else if facts.reflecting().any(|material| crosses(material.lobe)) {
            shared
        } else {
            Decision {
                is_on: false,
                reason: "no lobe draws samples below the surface".to_owned(),
                ..shared
            }
        }
    },
    remove: None,
};
