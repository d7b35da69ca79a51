//! What is known of each pixel beside its colour: what is seen there first, and its samples. For compositing and maps.

use super::{film::Film, guides::GuideSums};
use crate::parallel;

/// Means over some samples of each pixel; row by row from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Features {
    /// Albedo, linear Rec. 709, premultiplied by the covered share of the pixel: 0 without a hit. In mirrors and behind
    /// clear glass, that of the surface seen there.
    pub albedo: Vec<[f32; 3]>,
    /// Shading normal in world space, towards the viewer; shorter than 1 if normals differ or the pixel is partly covered.
    pub normal: Vec<[f32; 3]>,
    /// Distance from the camera along its axis, in the model's units, over the covered part of the pixel; infinite without a
    /// hit.
    pub depth: Vec<f32>,
    /// Samples in each pixel's mean.
    pub samples: Vec<f32>,
    /// Variance of each pixel's mean luminance; infinite below two samples.
    pub variance: Vec<f32>,
}

impl Features {
    /// Features from a film's sums; `world_units_per_unit` is the geometry's. Empty if the film keeps no guides.
    pub fn of(film: &Film, world_units_per_unit: f64) -> Self {
        Self::of_samples(film, |pixel| film.guide_samples(pixel), world_units_per_unit)
    }

    /// The same with the number of guide samples of each half, by pixel.
    pub fn of_samples(film: &Film, samples: impl Fn(usize) -> [f64; 2] + Sync, world_units_per_unit: f64) -> Self {
        let guides = |pixel: usize| {
            let mut sums = GuideSums::default();
            film.guides_of(pixel).iter().for_each(|half| sums.add(half));
            sums
        };
        let means = |pixel: usize| guides(pixel).means(samples(pixel).iter().sum());
        let depth = |pixel: usize| match guides(pixel) {
            sums if sums.hits > 0.0 => (f64::from(sums.depth / sums.hits) * world_units_per_unit) as f32,
            _ => f32::INFINITY,
        };
        let pixels = film.pixel_count();
        Self {
            albedo: parallel::map(pixels, |pixel| means(pixel)[0]),
            normal: parallel::map(pixels, |pixel| means(pixel)[1]),
            depth: parallel::map(pixels, depth),
            samples: parallel::map(pixels, |pixel| film.samples_of(pixel) as f32),
            variance: parallel::map(pixels, |pixel| film.variance_of_mean_at(pixel) as f32),
        }
    }
}
