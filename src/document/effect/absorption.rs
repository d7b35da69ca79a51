//! Light that is absorbed inside solids.

use super::{Constant, Effect};

pub(super) const EFFECT: Effect = Effect {
    name: "absorption",
    label: "Absorption",
    help: "Light that fades on its way through a clear solid (Beer and Lambert).",
    constant: Constant::flag("PLAN_ABSORPTION"),
    decide: |facts| {
        facts.needed_by(
            |material| material.transmits() && material.absorption.max_component() > 0.0,
            "absorbs light inside",
        )
    },
    remove: Some(|document| {
        for material in &mut document.materials {
            // Without a depth the colour tints the surface: white is what absorbs nothing.
            if material.transmission_depth > 0.0 {
                material.transmission_color = [1.0; 3];
            }
        }
    }),
};
