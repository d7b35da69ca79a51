//! Which D(ξ) curve shapes the geometric lobe.

use super::{ANY, Constant, Decision, Effect};
use crate::optics::curve::Curve;
use crate::optics::lobe::Lobe;

pub(super) const EFFECT: Effect = Effect {
    name: "curve",
    label: "Choice of curve",
    help: "Code for every D(ξ) curve, the interception of the long tail's among it; with one curve, only that one's.",
    constant: Constant::choice("PLAN_CURVE"),
    decide: |facts| {
        let geometric = facts.reflecting().filter(|material| material.lobe == Lobe::Geometric as u32);
        let mut curves = geometric.map(|material| material.curve);
        let Some(first) = curves.next() else {
            // Any number will do; the first keeps the other curves' code out.
            return Decision {
                value: 0,
                ..Decision::off("no material has a geometric lobe")
            };
        };
        let label = |number: u32| Curve::ALL[number as usize].label();
        match curves.find(|&curve| curve != first) {
            None => Decision::which(first, format!("{} in every geometric lobe", label(first))),
            Some(other) => Decision::which(ANY, format!("{} and {} are mixed", label(first), label(other))),
        }
    },
    remove: None,
};
