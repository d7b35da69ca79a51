//! Albedos over the roughness.

use super::{Constant, Effect};

pub(super) const EFFECT: Effect = Effect {
    name: "rough-tables",
    label: "Albedos over roughness",
    help: "What the base is left with where a texture changes the roughness, or the surface is metal in part.",
    constant: Constant::flag("PLAN_ROUGH_TABLES"),
    decide: |facts| facts.needed_by(|m| m.has_rough_tables == 1, "is metal in part, or its roughness changes over a base"),
    remove: None,
};
