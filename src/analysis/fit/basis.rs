//! The geometric lobe's density as a sum over pieces of its curve: it is linear in h(D) = f_D(D)/D, so hat functions of h
//! give densities that only have to be weighed (docs/MATHEMATICS.md, section 4).
//!
//! The optics integrate one smooth h with a few nodes; hats have kinks, so the range is cut into panels here.

use std::sync::LazyLock;

use crate::{analysis::quadrature::gauss_legendre, optics::lobe::model::NORMAL, optics::vector::Vec3};

/// The rule within a panel.
static GAUSS_8: LazyLock<Vec<[f64; 2]>> = LazyLock::new(|| gauss_legendre(8));
/// Longest panel in u, the variable in which the integrand is smooth.
const PANEL_MAX: f64 = 1.0;
/// Longest range of u worth integrating.
const RANGE_MAX: f64 = 20.0;

/// Hat functions of h over the distance D.
#[derive(Clone, Debug)]
pub struct Hats {
    /// Peaks of the hat functions, rising from 0 to D's maximum.
    pub nodes: Vec<f64>,
}

impl Hats {
    /// `count` hats over [0, `distance_max`], closer together towards 0, where the highlight is.
    pub fn new(count: usize, distance_max: f64) -> Self {
        let place = |i: usize| (i as f64 / (count - 1) as f64).powf(1.3) * distance_max;
        Self {
            nodes: (0..count).map(place).collect(),
        }
    }

    pub fn distance_max(&self) -> f64 {
        self.nodes[self.nodes.len() - 1]
    }

    /// The left one of the two hats that are not zero at a distance, and the share of the right one.
    fn place(&self, distance: f64) -> (usize, f64) {
        let index = self
            .nodes
            .partition_point(|node| *node <= distance)
            .clamp(1, self.nodes.len() - 1)
            - 1;
        let share = (distance - self.nodes[index]) / (self.nodes[index + 1] - self.nodes[index]);
        (index, share.clamp(0.0, 1.0))
    }

    /// Adds the isotropic geometric lobe's density for each hat to `densities`, before the horizon policy. Unit
    /// directions; `roughness` in (0, 1).
    pub fn add_densities(&self, roughness: f64, mirror: Vec3<f64>, wi: Vec3<f64>, densities: &mut [f64]) {
        let (kappa, reach) = (roughness, self.distance_max());
        let k = (1.0 - kappa) * (1.0 + kappa);
        let s = (1.0 - roughness) / roughness;
        let apart = mirror - wi;
        let versine = 0.5 * apart.dot(apart);
        let perpendicular = (apart + wi * versine) * s;
        let mu = s * (1.0 - versine);
        let [nu, m] = [wi, perpendicular].map(|vector| NORMAL.dot(vector));
        let e = perpendicular.dot(perpendicular);
        let a = kappa * kappa * nu * nu + k;
        let a_delta = (k * (kappa * kappa * (nu * nu * e + m * m) + k * e)).max(1e-18);
        let (tau_middle, tau_scale) = (kappa * kappa * nu * m / a, a_delta.sqrt() / a);
        let discriminant = reach * reach * a - e - 2.0 * reach * kappa * m;
        let half_chord = discriminant.max(0.0).sqrt();
        let tau_last = reach * kappa * nu + half_chord;
        let tau_first = (reach * kappa * nu - half_chord).max(-mu);
        // The direction misses the ball.
        if !(discriminant > 0.0 && tau_first < tau_last) {
            return;
        }
        let [first, last] = [tau_first, tau_last].map(|tau| ((tau - tau_middle) / tau_scale).asinh());
        let first = first.max(last - RANGE_MAX);
        let delta_root = tau_scale * a.sqrt();
        let scale = 1.0 / (4.0 * std::f64::consts::PI * a.sqrt());
        let panels = ((last - first) / PANEL_MAX).ceil().max(1.0);
        let half = 0.5 * (last - first) / panels;
        let steps: Vec<[f64; 2]> = GAUSS_8
            .iter()
            .map(|[node, weight]| [(half * node).exp(), half * weight * scale])
            .collect();
        for panel in 0..panels as usize {
            let middle = (first + half * (2.0 * panel as f64 + 1.0)).exp();
            for [step, weight] in &steps {
                let exp_u = middle * step;
                let inverse = 1.0 / exp_u;
                let tau = tau_middle + tau_scale * 0.5 * (exp_u - inverse);
                let s = delta_root * 0.5 * (exp_u + inverse);
                let lifted = kappa * (tau * nu - m);
                // The root of k D² + 2κ(n·q) D − |q|² = 0 in the form that does not cancel.
                let distance = if lifted > 0.0 {
                    (tau * tau + e) / (lifted + s)
                } else {
                    (s - lifted) / k
                };
                let value = weight * (tau + mu).max(0.0).powi(2);
                let (index, share) = self.place(distance);
                densities[index] += value * (1.0 - share);
                densities[index + 1] += value * share;
            }
        }
    }
}
