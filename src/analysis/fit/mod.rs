//! "Match look": the lobe with the closest shape to another, or to a measured one.
//!
//! Shapes are compared by the total variation distance TV = ½ ∫ |p − q| over the hemisphere, p and q normalised to the
//! integral 1: the share of light in other directions, 0 for equal shapes and 1 for disjoint ones.

pub mod basis;
pub mod curve;
pub mod merl;
mod non_negative;
pub mod roughness;

pub use curve::{CurveFit, CurveTarget, fit_curve};
pub use merl::{Merl, MerlError};
pub use roughness::{Nearest, nearest_roughness};

use super::sphere_grid::{Profile, Side, SphereGrid};
use crate::optics::{lobe::model::LobeModel, lobe::model::view_direction, vector::Vec3};

/// Function of a lobe to compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Appearance: evaluate with the cosine, normalised to the integral 1.
    Evaluate,
    /// Sampling: the density, without normalisation. Light that a model loses below the horizon is missing.
    Density,
}

impl Measure {
    /// This of a lobe, not yet normalised.
    pub fn of(self, model: &LobeModel, wo: Vec3<f64>, wi: Vec3<f64>) -> f64 {
        let [value, density] = model.evaluate(wo, wi);
        match self {
            Measure::Evaluate => value,
            Measure::Density => density,
        }
    }
}

/// The total variation distance between a target and a lobe's [`Measure`], both seen under `view_angle_rad` and the same
/// on both sides of the plane of incidence. 1 where one of them is zero everywhere.
pub fn total_variation(target: Profile, model: &LobeModel, view_angle_rad: f64, measure: Measure) -> f64 {
    let wo = view_direction(view_angle_rad);
    let profile = |wi| measure.of(model, wo, wi);
    let grid = SphereGrid::adapted(view_angle_rad, Side::Above, model.is_symmetric(), &[target, &profile]);
    let (p, q) = (grid.values(target), grid.values(&profile));
    let (p_total, q_total) = match measure {
        Measure::Evaluate => (grid.integral(&p), grid.integral(&q)),
        Measure::Density => (1.0, 1.0),
    };
    if !(p_total > 0.0 && q_total > 0.0) {
        return 1.0;
    }
    let apart: Vec<f64> = p
        .iter()
        .zip(q)
        .map(|(p, q)| (p / p_total - q / q_total).abs())
        .collect();
    0.5 * grid.integral(&apart)
}
