//! Distance of two images: relative mean squared error, and a test whether only noise separates them.

use super::chi_square::upper_tail;
use crate::job::film::Image;

/// Keeps dark pixels from ruling the relative error.
pub const RELATIVE_FLOOR: f64 = 0.01;

/// Red, green and blue of all pixels, one after the other.
pub fn colors(image: &Image) -> Vec<f32> {
    image.pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect()
}

/// Relative mean squared error of linear radiance, mean((x − ref)²/(ref² + 0.01)) over all numbers of both slices
/// (equally long, any number of channels). Unweighted by luminance. 0 for empty slices.
pub fn relative_mean_squared_error(image: &[f32], reference: &[f32]) -> f64 {
    let terms = image.iter().zip(reference).map(|(x, reference)| {
        let (x, reference) = (f64::from(*x), f64::from(*reference));
        (x - reference).powi(2) / (reference * reference + RELATIVE_FLOOR)
    });
    terms.sum::<f64>() / image.len().max(1) as f64
}

/// Estimates with their uncertainty, one per pixel and channel.
#[derive(Clone, Copy, Debug)]
pub struct Estimates<'a> {
    /// Means, one per pixel and channel.
    pub mean: &'a [f64],
    /// Variances of these means: the samples' variance over their number.
    pub variance: &'a [f64],
}

/// The outcome of comparing two images pixel by pixel.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct ZTest {
    /// Share of the numbers that differ by more than three standard deviations; by chance 0.0027.
    pub beyond_three_sigma: f64,
    /// Largest difference in standard deviations; infinite if two exact numbers differ.
    pub max_z: f64,
    /// Probability that chance alone gives a sum of squares at least this large: small where the images differ.
    pub p_value: f64,
    /// Numbers compared; those that are equal and without variance are left out.
    pub compared: usize,
}

/// Do two images differ by more than their noise? z = (a − b)/√(variance a + variance b) a number; under equal images
/// Σz² follows χ². All slices equally long. The variances should rest on a hundred samples or more: with few, z has
/// heavier tails than assumed here, and a few outliers appear.
pub fn z_test(a: Estimates<'_>, b: Estimates<'_>) -> ZTest {
    let (mut sum, mut beyond, mut compared, mut max_z) = (0.0, 0_usize, 0_usize, 0.0_f64);
    for i in 0..a.mean.len() {
        let difference = (a.mean[i] - b.mean[i]).abs();
        let variance = a.variance[i] + b.variance[i];
        if difference == 0.0 && variance == 0.0 {
            continue;
        }
        let z = difference / variance.sqrt();
        // NaN, from either image, counts as an infinite difference.
        let z = if z.is_nan() { f64::INFINITY } else { z };
        sum += z * z;
        compared += 1;
        beyond += usize::from(z > 3.0);
        max_z = max_z.max(z);
    }
    let p_value = match compared {
        0 => 1.0,
        _ if sum.is_infinite() => 0.0,
        _ => upper_tail(sum, compared as f64),
    };
    ZTest {
        beyond_three_sigma: beyond as f64 / compared.max(1) as f64,
        max_z,
        p_value,
        compared,
    }
}
