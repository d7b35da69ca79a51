//! The roughness at which a lobe comes closest to a target.

use super::{Measure, total_variation};
use crate::analysis::sphere_grid::Profile;
use crate::optics::lobe::model::{LobeModel, roughness_min};

/// A roughness and how far the lobe then is from the target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// In [0, 1].
    pub roughness: f64,
    /// Total variation distance in [0, 1].
    pub total_variation: f64,
}

/// Steps of the scan before the search, even in the logarithm of the roughness.
const SCAN_STEPS: usize = 24;
/// Relative accuracy of the roughness found.
const ACCURACY: f64 = 0.0001;

/// The roughness of `model` (its own is not read) that minimises the total variation distance to `target`, a profile
/// for the view under `view_angle_rad` that looks the same on both sides of the plane of incidence.
pub fn nearest_roughness(target: Profile, model: &LobeModel, view_angle_rad: f64, measure: Measure) -> Nearest {
    let distance = |roughness: f64| total_variation(target, &model.with_roughness(roughness), view_angle_rad, measure);
    let low = roughness_min(model.lobe).max(0.001);
    minimum([low, 1.0], SCAN_STEPS, ACCURACY, &distance)
}

/// The least value of a function of the roughness in a range: a scan, then golden-section search between the neighbours
/// of the best, both in the logarithm, down to the relative `accuracy`.
pub fn minimum(range: [f64; 2], steps: usize, accuracy: f64, distance: &dyn Fn(f64) -> f64) -> Nearest {
    let [low, high] = range.map(f64::ln);
    let at = |log: f64| Nearest {
        roughness: log.exp().min(range[1]),
        total_variation: distance(log.exp().min(range[1])),
    };
    let step = (high - low) / steps as f64;
    let scan: Vec<Nearest> = (0..=steps).map(|i| at(low + step * i as f64)).collect();
    let best = (0..=steps)
        .min_by(|&i, &j| scan[i].total_variation.total_cmp(&scan[j].total_variation))
        .unwrap_or(0);
    let centre = low + step * best as f64;
    let found = golden_section([(centre - step).max(low), (centre + step).min(high)], accuracy, &at);
    if found.total_variation < scan[best].total_variation {
        found
    } else {
        scan[best]
    }
}

/// Golden-section search (Kiefer 1953).
fn golden_section([mut low, mut high]: [f64; 2], accuracy: f64, at: &dyn Fn(f64) -> Nearest) -> Nearest {
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let mut left = at(high - ratio * (high - low));
    let mut right = at(low + ratio * (high - low));
    while high - low > accuracy {
        if left.total_variation < right.total_variation {
            high = low + ratio * (high - low);
            right = left;
            left = at(high - ratio * (high - low));
        } else {
            low = high - ratio * (high - low);
            left = right;
            right = at(low + ratio * (high - low));
        }
    }
    if left.total_variation < right.total_variation {
        left
    } else {
        right
    }
}
