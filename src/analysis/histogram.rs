//! Histograms of the angle between a lobe's samples and the mirror direction (paper, Fig. 3).

use std::f64::consts::{PI, TAU};

use crate::optics::frame::{Frame, world_from_local};
use crate::optics::vector::{Vec3, vec3};

/// Counts in equal bins over an interval.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    low: f64,
    width: f64,
    counts: Vec<u64>,
    total: u64,
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

    /// The counts, a bin each.
    pub fn counts(&self) -> &[u64] {
        &self.counts
    }

    /// Values added, those outside included.
    pub fn total(&self) -> u64 {
        self.total
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_density_of_an_angle_is_that_of_all_directions_around_the_axis() {
        let axis = vec3(0.6, 0.0, 0.8);
        let frame = crate::optics::frame::frame_from_normal(axis);
        // ∫ (t·ω)² dφ sin α = π sin³ α about the tangent t.
        for alpha_rad in [0.3_f64, 1.2, 2.5] {
            let found = angle_density(&frame, alpha_rad, 64, |wi| frame.tangent.dot(wi).powi(2));
            let expected = PI * alpha_rad.sin().powi(3);
            assert!((found - expected).abs() < 1e-12, "{alpha_rad}: {found} {expected}");
        }
    }

    #[test]
    fn values_are_counted_in_their_bins_and_densities_add_up() {
        let mut histogram = Histogram::new(1.0, 3.0, 4);
        for value in [1.0, 1.49, 2.6, 3.0, 0.99, 3.01, f64::NAN] {
            histogram.add(value);
        }
        assert_eq!(histogram.counts(), [2, 0, 0, 2], "the upper end is the last bin's");
        assert_eq!(histogram.total(), 7);
        let density = histogram.density();
        assert_eq!(
            density.iter().map(|[middle, _]| *middle).collect::<Vec<_>>(),
            [1.25, 1.75, 2.25, 2.75]
        );
        let within: f64 = density.iter().map(|[_, density]| density * 0.5).sum();
        assert!((within - 4.0 / 7.0).abs() < 1e-12, "{within}");
    }
}
