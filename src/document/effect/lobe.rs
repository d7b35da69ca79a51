//! Which lobe reflects.

use super::{Constant, Effect};
use crate::optics::lobe::Lobe;

pub(super) const EFFECT: Effect = Effect {
    name: "lobe",
    label: "Choice of lobe",
    help: "Code for every lobe, chosen from at each hit; with one lobe in the scene, only that one's.",
    constant: Constant::choice("PLAN_LOBE"),
    decide: |facts| facts.shared(|material| material.lobe, |number| Lobe::ALL[number as usize].label()),
    remove: None,
};
