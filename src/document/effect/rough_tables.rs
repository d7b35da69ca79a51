//! Albedos over the roughness.

use super::{Constant, Effect};

pub(super) const EFFECT: Effect = Effect {
    name: "rough-tables",
    label: "Albedos over roughness",
    help: "What the base is left with, looked up by the roughness where a texture changes it.",
    constant: Constant::flag("PLAN_ROUGH_TABLES"),
    decide: |facts| facts.needed_by(|m| m.has_rough_tables == 1, "has a base under a lobe whose roughness changes"),
    remove: None,
};
