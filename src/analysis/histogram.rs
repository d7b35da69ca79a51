//! Histograms of the angle between a lobe's samples and the mirror direction (paper, Fig. 3).

use std::f64::consts::{PI, TAU};

use crate::optics::{frame::Frame, frame::world_from_local, vector::Vec3, vector::vec3};

/// Counts in equal bins over an interval.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    low: f64,
    width: f64,
    /// The counts, a bin each.
    pub counts: Vec<u64>,
    /// Values added, those outside included.
    pub total: u64,
}

impl Histogram {
    /// Empty bins over [`low`, `high`]; at least one bin.
    pub fn new(low: f64, high: f64, bins: usize) -> Self {
        let bins = bins.max(1);
        Self {
            low,
            width: (high - low) / bins as f64,
            counts: vec![0; bins],
            total: 0,
        }
    }

    /// Counts a value; one outside the interval counts in the total only. The upper end belongs to the last bin.
    pub fn add(&mut self, value: f64) {
        self.total += 1;
        let position = (value - self.low) / self.width;
        if position >= 0.0 && position <= self.counts.len() as f64 {
            let bin = (position as usize).min(self.counts.len() - 1);
            self.counts[bin] += 1;
        }
    }

    /// (middle of the bin, density per unit of the value) for each bin.
    pub fn density(&self) -> Vec<[f64; 2]> {
        let scale = 1.0 / (self.width * self.total.max(1) as f64);
        let middle = |bin: usize| self.low + self.width * (bin as f64 + 0.5);
        self.counts
            .iter()
            .enumerate()
            .map(|(bin, count)| [middle(bin), *count as f64 * scale])
            .collect()
    }
}

/// Angles in radians between the directions and the unit vector `axis`, over [0, π].
pub fn angle_histogram(directions: impl IntoIterator<Item = Vec3<f64>>, axis: Vec3<f64>, bins: usize) -> Histogram {
    let mut histogram = Histogram::new(0.0, PI, bins);
    for direction in directions {
        histogram.add(direction.cross(axis).length().atan2(direction.dot(axis)));
    }
    histogram
}

/// Limit of [`angle_histogram`] at an angle: ∫ density dφ sin α, per radian. `frame`'s normal is the axis; `steps` azimuths.
pub fn angle_density(frame: &Frame<f64>, alpha_rad: f64, steps: u32, density: impl Fn(Vec3<f64>) -> f64) -> f64 {
    let (sine, cosine) = alpha_rad.sin_cos();
    let sum: f64 = (0..steps)
        .map(|i| {
            let phi_rad = TAU * (f64::from(i) + 0.5) / f64::from(steps);
            density(world_from_local(
                frame,
                vec3(sine * phi_rad.cos(), sine * phi_rad.sin(), cosine),
            ))
        })
        .sum();
    sum * sine * TAU / f64::from(steps)
}
