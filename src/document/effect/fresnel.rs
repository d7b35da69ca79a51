//! Which Fresnel term.

use super::{Constant, Effect};
use crate::optics::fresnel::Fresnel;

pub(super) const EFFECT: Effect = Effect {
    name: "fresnel",
    label: "Fresnel",
    help: "Code for every Fresnel term, chosen from at each hit; with one term in the scene, only that one's.",
    constant: Constant::choice("PLAN_FRESNEL"),
    decide: |facts| facts.shared(|m| m.fresnel, |number| Fresnel::ALL[number as usize].label()),
    remove: None,
};
