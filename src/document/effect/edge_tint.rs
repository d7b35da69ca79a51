//! Metals tinted towards the edge.

use super::{Constant, Effect};
use crate::optics::vector::Vec3;

pub(super) const EFFECT: Effect = Effect {
    name: "edge-tint",
    label: "Edge tint",
    help: "Metals whose reflection is tinted towards grazing angles (F82).",
    constant: Constant::flag("PLAN_EDGE_TINT"),
    decide: |facts| facts.needed_by(|m| m.has_specular() && m.edge_tint != Vec3::splat(1.0), "tints its edge"),
    remove: Some(|document| {
        for material in &mut document.materials {
            material.edge_tint = [1.0; 3];
        }
    }),
};
