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
        let means = |pixel: usize| film.pixels[pixel].map(|half| half.luminance() / half.samples);
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
