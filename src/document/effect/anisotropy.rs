//! Stretched lobes.

use super::{Constant, Effect};

pub(super) const EFFECT: Effect = Effect {
    name: "anisotropy",
    label: "Anisotropy",
    help: "Lobes stretched along the surface's tangent.",
    constant: Constant::flag("PLAN_ANISOTROPY"),
    decide: |facts| facts.needed_by(|m| m.has_specular() && m.anisotropy != 0.0, "stretches its lobe"),
    remove: Some(|document| {
        for material in &mut document.materials {
            material.anisotropy = 0.0;
        }
    }),
};
