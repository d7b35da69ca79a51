//! Fit of the geometric lobe's curve to a target: a non-negative least-squares fit of h over hat functions (Lawson and
//! Hanson 1974). It is iteratively reweighted so that squares become absolute values, because the goal is the total
//! variation distance.

use std::f64::consts::FRAC_1_PI;

use super::{basis::Hats, non_negative::non_negative};
use crate::{
    analysis::sphere_grid::{Profile, Side, SphereGrid},
    optics::lobe::{Horizon, model::NORMAL, model::view_direction},
    optics::vector::Vec3,
    parallel,
};

/// Hat functions of h.
const HATS: usize = 22;
/// Solutions with corrected weights.
const REWEIGHTINGS: usize = 5;
/// Density per steradian below which differences do not matter more than others.
const DENSITY_FLOOR: f64 = 0.001;

/// A target at the points of a grid, for one view.
#[derive(Clone, Debug)]
pub struct CurveTarget {
    grid: SphereGrid,
    /// Values at the points, their integral 1.
    values: Vec<f64>,
    /// Divisor of the values.
    total: f64,
    mirror: Vec3<f64>,
}

impl CurveTarget {
    /// `profile` for the view under `view_angle_rad`, which looks the same on both sides of the plane of incidence.
    /// `None` where it is zero everywhere.
    pub fn new(profile: Profile, view_angle_rad: f64) -> Option<Self> {
        let grid = SphereGrid::adapted(view_angle_rad, Side::Above, true, &[profile]);
        let values = grid.values(profile);
        let total = grid.integral(&values);
        (total > 0.0 && total.is_finite()).then(|| Self {
            values: values.iter().map(|value| value / total).collect(),
            grid,
            total,
            mirror: view_direction(view_angle_rad).mirrored_about(NORMAL),
        })
    }
}

/// A curve that was fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveFit {
    /// The roughness R that it belongs to.
    pub roughness: f64,
    /// Distances D, rising from 0.
    pub nodes: Vec<f64>,
    /// h at the nodes, linear between them; scaled so that f_D = D h has the integral 1.
    pub h: Vec<f64>,
    /// Albedo of the lobe, in the target's scale.
    pub lobe_albedo: f64,
    /// Albedo of the Lambertian part, in the target's scale; 0 if not requested.
    pub base_albedo: f64,
    /// ½ ∫ |fit − target| / ∫ target.
    pub residual: f64,
}

impl CurveFit {
    /// The cumulative distribution of D.
    pub fn cumulative(&self, distance: f64) -> f64 {
        let pieces = self.nodes.windows(2).zip(self.h.windows(2));
        pieces
            .map(|(d, h)| mass([d[0], d[1].min(distance)], [d[0], d[1]], [h[0], h[1]]))
            .sum()
    }
}

/// ∫ D h(D) dD over a range within a piece in which h is linear: Simpson's rule, exact for it.
fn mass(range: [f64; 2], piece: [f64; 2], h: [f64; 2]) -> f64 {
    let [low, high] = range;
    if high <= low {
        return 0.0;
    }
    let density = |d: f64| d * (h[0] + (h[1] - h[0]) * (d - piece[0]) / (piece[1] - piece[0]));
    (high - low) / 6.0 * (density(low) + 4.0 * density(0.5 * (low + high)) + density(high))
}

/// The best curve at a roughness in (0, 1) with distances up to `distance_max`, plus a Lambertian part if `has_base`. `None`
/// if the solver fails.
pub fn fit_curve(
    target: &CurveTarget,
    roughness: f64,
    distance_max: f64,
    horizon: Horizon,
    has_base: bool,
) -> Option<CurveFit> {
    let hats = Hats::new(HATS, distance_max);
    let rows = rows(target, &hats, roughness, horizon, has_base);
    let mut weights: Vec<f64> = target
        .values
        .iter()
        .map(|value| 1.0 / (value + DENSITY_FLOOR))
        .collect();
    let mut best: Option<(f64, Vec<f64>)> = None;
    for _ in 0..REWEIGHTINGS {
        let solution = solve(target, &rows, &weights)?;
        let apart: Vec<f64> = rows
            .iter()
            .zip(&target.values)
            .map(|(row, value)| (dot(row, &solution) - value).abs())
            .collect();
        let residual = 0.5 * target.grid.integral(&apart);
        weights = apart
            .iter()
            .zip(&target.values)
            .map(|(r, value)| 1.0 / (r + 0.003 * value + 0.1 * DENSITY_FLOOR))
            .collect();
        if best.as_ref().is_none_or(|(least, _)| residual < *least) {
            best = Some((residual, solution));
        }
    }
    let (residual, mut h) = best?;
    let base_albedo = if has_base { h.pop()? * target.total } else { 0.0 };
    let mut fit = CurveFit {
        roughness,
        nodes: hats.nodes,
        h,
        lobe_albedo: 0.0,
        base_albedo,
        residual,
    };
    let whole = fit.cumulative(distance_max);
    if !(whole > 0.0 && whole.is_finite()) {
        return None;
    }
    fit.h.iter_mut().for_each(|h| *h /= whole);
    fit.lobe_albedo = whole * target.total;
    Some(fit)
}

/// Per grid point the density of each hat function, followed by Lambert's if there is a base.
fn rows(target: &CurveTarget, hats: &Hats, roughness: f64, horizon: Horizon, has_base: bool) -> Vec<Vec<f64>> {
    let row = |(wi, _): &(Vec3<f64>, f64)| {
        let mut densities = vec![0.0; hats.nodes.len()];
        hats.add_densities(roughness, target.mirror, *wi, &mut densities);
        if horizon == Horizon::Mirror {
            hats.add_densities(roughness, target.mirror, wi.reflected_at_plane(NORMAL), &mut densities);
        }
        if has_base {
            densities.push(NORMAL.dot(*wi) * FRAC_1_PI);
        }
        densities
    };
    parallel::map_each(&target.grid.points, row)
}

fn dot(row: &[f64], solution: &[f64]) -> f64 {
    row.iter().zip(solution).map(|(a, x)| a * x).sum()
}

/// The non-negative x that minimises Σ solid angle × weight × (row·x − value)². The thousands of rows are first summed up
/// in the normal equations.
fn solve(target: &CurveTarget, rows: &[Vec<f64>], weights: &[f64]) -> Option<Vec<f64>> {
    let count = rows.first()?.len();
    let mut gram = vec![vec![0.0; count]; count];
    let mut right = vec![0.0; count];
    for (((_, solid_angle), row), (weight, value)) in target
        .grid
        .points
        .iter()
        .zip(rows)
        .zip(weights.iter().zip(&target.values))
    {
        let weight = weight * solid_angle;
        for i in 0..count {
            let scaled = weight * row[i];
            right[i] += scaled * value;
            for j in 0..=i {
                gram[i][j] += scaled * row[j];
            }
        }
    }
    // Regularises the diagonal: hat functions that the target does not constrain get the weight 0.
    let ridge = 1e-11 * (0..count).map(|i| gram[i][i]).sum::<f64>();
    let lower = gram.clone();
    for (i, row) in gram.iter_mut().enumerate() {
        row[i] += ridge;
        for (number, below) in row.iter_mut().zip(&lower).skip(i + 1) {
            *number = below[i];
        }
    }
    non_negative(&gram, &right)
}
