//! Sums of squares.

use super::{Decision, Effect};

pub(super) const EFFECT: Effect = Effect {
    name: "variance",
    label: "Variance",
    help: "Sums of squares beside those of the light: the error of the picture is told from them.",
    constant: None,
    decide: |_| Decision::on("the error of the picture is told from them"),
    remove: None,
};
