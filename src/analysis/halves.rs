//! Distance of two renders without their noise.
//!
//! A film has two independent halves of samples (see [`super::noise`]). With the differences d₁ and d₂ of two renders in
//! either half, d₁d₂ estimates the squared difference of their limits without bias: their noise has no common mean. That
//! holds even if both renders use the same random numbers, which makes small differences visible long before either image is
//! smooth.

use crate::job::film::Film;

/// Half width of a normal distribution's 95 % interval, in standard deviations.
const BAND: f64 = 1.959_964;

/// Mean luminance per pixel in either half of its samples; NaN without samples.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Halves {
    /// Of the even samples.
    pub even: Vec<f64>,
    /// Of the odd ones.
    pub odd: Vec<f64>,
}

/// A root mean square difference relative to the mean luminance, with its 95 % interval.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Distance {
    /// Estimate: 0.01 is 1 %; 0 if it is not resolved from noise.
    pub value: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
}

impl Distance {
    /// Whether it is significantly above 0.
    pub fn is_resolved(&self) -> bool {
        self.low > 0.0
    }
}

impl Halves {
    /// The halves of a film.
    pub fn of(film: &Film) -> Self {
        let means = |pixel| film.halves(pixel).map(|half| half.luminance() / half.samples);
        let (even, odd) = (0..film.pixel_count()).map(|pixel| means(pixel).into()).unzip();
        Self { even, odd }
    }

    /// Mean luminance of the image.
    pub fn mean_luminance(&self) -> f64 {
        let both = std::iter::zip(&self.even, &self.odd).map(|(even, odd)| 0.5 * (even + odd));
        mean(both.filter(|y| y.is_finite()))[0]
    }

    /// Distance of this render's limit from that of `other`, relative to the mean luminance of `other`.
    pub fn distance(&self, other: &Halves) -> Distance {
        let even = std::iter::zip(&self.even, &other.even).map(|(a, b)| a - b);
        let odd = std::iter::zip(&self.odd, &other.odd).map(|(a, b)| a - b);
        distance(even.zip(odd), other.mean_luminance())
    }

    /// Distance of an image, given by its luminances, from this render's limit. That is the image's error if both are of the
    /// same scene and independent.
    pub fn error_of(&self, luminances: &[f64]) -> Distance {
        let even = std::iter::zip(luminances, &self.even).map(|(x, y)| x - y);
        let odd = std::iter::zip(luminances, &self.odd).map(|(x, y)| x - y);
        distance(even.zip(odd), self.mean_luminance())
    }
}

/// Mean, and the standard error of the mean.
fn mean(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let (mut count, mut sum, mut squares) = (0.0_f64, 0.0, 0.0);
    for value in values {
        count += 1.0;
        sum += value;
        squares += value * value;
    }
    let mean = sum / count.max(1.0);
    let variance = (squares / count.max(1.0) - mean * mean).max(0.0);
    [mean, (variance / (count - 1.0).max(1.0)).sqrt()]
}

fn distance(pairs: impl Iterator<Item = (f64, f64)>, mean_luminance: f64) -> Distance {
    let products = pairs.map(|(even, odd)| even * odd).filter(|x| x.is_finite());
    let [square, error] = mean(products);
    let relative = |square: f64| {
        if square > 0.0 {
            square.sqrt() / mean_luminance.max(f64::MIN_POSITIVE)
        } else {
            0.0
        }
    };
    Distance {
        value: relative(square),
        low: relative(square - BAND * error),
        high: relative(square + BAND * error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::random::{Sequence, random_pair, random_state};

    const PIXELS: u32 = 10_000;

    /// A grey image of a luminance with noise of a standard deviation in either half.
    fn halves(luminance: f64, noise: f64, seed: u32) -> Halves {
        let number = |pixel: u32| -> [f64; 2] {
            random_pair(
                random_state(pixel % 100, pixel / 100, seed, 0, Sequence::Independent),
                0,
            )
        };
        let half = |i: usize| {
            let value = |pixel| luminance + noise * (12.0_f64.sqrt() * (number(pixel)[i] - 0.5));
            (0..PIXELS).map(value).collect()
        };
        Halves {
            even: half(0),
            odd: half(1),
        }
    }

    #[test]
    fn a_difference_far_below_the_noise_is_measured() {
        // 6 % apart, with 20 % noise: in the sum of squares of a plain difference the noise would rule. The products'
        // mean has a standard error of 8e-4.
        let found = halves(1.06, 0.2, 1).distance(&halves(1.0, 0.2, 2));
        assert!((found.value - 0.06).abs() < 0.02 && found.is_resolved(), "{found:?}");
        let none = halves(1.0, 0.2, 1).distance(&halves(1.0, 0.2, 2));
        assert!(!none.is_resolved() && none.high < 0.07, "{none:?}");
    }

    #[test]
    fn noise_in_common_does_not_count() {
        let found = halves(1.01, 0.2, 1).distance(&halves(1.0, 0.2, 1));
        // The mean that it is relative to has noise itself.
        assert!((found.value - 0.01).abs() < 1e-4 && found.is_resolved(), "{found:?}");
    }

    #[test]
    fn the_error_of_a_picture_is_its_own_noise_alone() {
        let picture = halves(1.0, 0.1, 3).even;
        let found = halves(1.0, 0.3, 4).error_of(&picture);
        assert!((found.value - 0.1).abs() < 0.02, "{found:?}");
        assert!(found.low < 0.1 && found.high > 0.1, "{found:?}");
    }
}
