//! The picture as sums: what the engines accumulate and everything shown is read from.

use rayon::prelude::*;

use super::features::{GUIDE_SAMPLES, GuideSums};

/// Sums over the samples of each pixel, in f64: they do not stall after millions of samples.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Film {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Sums of linear red, green, blue and of the coverage, row by row from the top.
    pub color: Vec<[f64; 4]>,
    /// Sum of the squared luminance, and the number of samples in the sums.
    pub statistics: Vec<[f64; 2]>,
    /// Sums of red, green and blue of the odd ones among these samples: one of two independent halves, see
    /// [`crate::optics::random::path_state`].
    pub odd_color: Vec<[f64; 3]>,
    /// Sum of the squared luminance, and the number, of the odd samples.
    pub odd_statistics: Vec<[f64; 2]>,
    /// What the first [`GUIDE_SAMPLES`] samples saw first.
    pub guides: Vec<GuideSums>,
    /// Rays traced for each pixel: what it cost.
    pub rays: Vec<f64>,
    /// Samples left out because they were not finite or negative.
    pub dropped: u64,
    /// Luminance that limiting fireflies took from all samples together.
    pub clamped: f64,
}

/// Luminance of linear Rec. 709.
pub fn luminance([red, green, blue]: [f64; 3]) -> f64 {
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

fn luminance_of([red, green, blue, _]: [f64; 4]) -> f64 {
    luminance([red, green, blue])
}

/// Sums over one of the two independent halves of a pixel's samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HalfSums {
    /// Linear red, green and blue.
    pub color: [f64; 3],
    /// The luminance.
    pub luminance: f64,
    /// Its square.
    pub luminance_squared: f64,
    /// How many samples there are.
    pub samples: f64,
}

impl Film {
    /// An empty film.
    pub fn new(width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        Self {
            width,
            height,
            color: vec![[0.0; 4]; pixels],
            statistics: vec![[0.0; 2]; pixels],
            odd_color: vec![[0.0; 3]; pixels],
            odd_statistics: vec![[0.0; 2]; pixels],
            guides: vec![GuideSums::default(); pixels],
            rays: vec![0.0; pixels],
            dropped: 0,
            clamped: 0.0,
        }
    }

    /// The part of the picture's energy, in [0, 1], that limiting fireflies took.
    pub fn clamped_share(&self) -> f64 {
        let kept: f64 = self.color.iter().map(|sum| luminance_of(*sum)).sum();
        if self.clamped > 0.0 {
            self.clamped / (self.clamped + kept)
        } else {
            0.0
        }
    }

    /// Adds sample number `sample` of a pixel: linear colour with coverage.
    pub fn add(&mut self, pixel: usize, sample: u32, color: [f64; 4]) {
        let luminance = luminance_of(color);
        for (sum, x) in self.color[pixel].iter_mut().zip(color) {
            *sum += x;
        }
        self.statistics[pixel][0] += luminance * luminance;
        self.statistics[pixel][1] += 1.0;
        if sample % 2 == 1 {
            for (sum, x) in self.odd_color[pixel].iter_mut().zip(color) {
                *sum += x;
            }
            self.odd_statistics[pixel][0] += luminance * luminance;
            self.odd_statistics[pixel][1] += 1.0;
        }
    }

    /// The two halves of a pixel's samples: the even ones and the odd ones.
    pub fn halves(&self, pixel: usize) -> [HalfSums; 2] {
        let [red, green, blue, _] = self.color[pixel];
        let ([all_squared, all_samples], odd) = (self.statistics[pixel], self.odd_color[pixel]);
        let [odd_squared, odd_samples] = self.odd_statistics[pixel];
        let half = |color: [f64; 3], luminance_squared: f64, samples: f64| HalfSums {
            color,
            luminance: luminance(color),
            luminance_squared,
            samples,
        };
        let even = [red - odd[0], green - odd[1], blue - odd[2]];
        [
            half(even, all_squared - odd_squared, all_samples - odd_samples),
            half(odd, odd_squared, odd_samples),
        ]
    }

    /// How many of a pixel's samples are in the sums of what they saw first.
    pub fn guide_samples(&self, pixel: usize) -> f64 {
        self.statistics[pixel][1].min(f64::from(GUIDE_SAMPLES))
    }

    /// Copies a smaller film into this one, its top left pixel to `origin`; what was dropped or taken adds up.
    pub fn place(&mut self, origin: [u32; 2], tile: &Film) {
        let width = tile.width as usize;
        for row in 0..tile.height as usize {
            let to = (origin[1] as usize + row) * self.width as usize + origin[0] as usize;
            let (to, from) = (to..to + width, row * width..(row + 1) * width);
            self.color[to.clone()].copy_from_slice(&tile.color[from.clone()]);
            self.statistics[to.clone()].copy_from_slice(&tile.statistics[from.clone()]);
            self.odd_color[to.clone()].copy_from_slice(&tile.odd_color[from.clone()]);
            self.odd_statistics[to.clone()].copy_from_slice(&tile.odd_statistics[from.clone()]);
            self.guides[to.clone()].copy_from_slice(&tile.guides[from.clone()]);
            self.rays[to].copy_from_slice(&tile.rays[from]);
        }
        self.dropped += tile.dropped;
        self.clamped += tile.clamped;
    }

    /// The chosen pixels alone, in a row.
    pub fn of_pixels(&self, is_chosen: impl Fn(usize) -> bool) -> Film {
        let chosen: Vec<usize> = (0..self.color.len()).filter(|&pixel| is_chosen(pixel)).collect();
        Film {
            width: chosen.len() as u32,
            height: 1,
            color: chosen.iter().map(|&pixel| self.color[pixel]).collect(),
            statistics: chosen.iter().map(|&pixel| self.statistics[pixel]).collect(),
            odd_color: chosen.iter().map(|&pixel| self.odd_color[pixel]).collect(),
            odd_statistics: chosen.iter().map(|&pixel| self.odd_statistics[pixel]).collect(),
            guides: chosen.iter().map(|&pixel| self.guides[pixel]).collect(),
            rays: chosen.iter().map(|&pixel| self.rays[pixel]).collect(),
            dropped: self.dropped,
            clamped: self.clamped,
        }
    }

    /// Rays traced for all pixels together.
    pub fn total_rays(&self) -> u64 {
        self.rays.iter().sum::<f64>() as u64
    }

    /// Samples in the sums of all pixels together.
    pub fn samples(&self) -> u64 {
        self.statistics.iter().map(|s| s[1]).sum::<f64>() as u64
    }

    /// The mean picture: linear Rec. 709, alpha premultiplied; black where there is no sample yet.
    pub fn image(&self) -> Image {
        let pixels = self.color.iter().zip(&self.statistics);
        let mean = |(sum, s): (&[f64; 4], &[f64; 2])| sum.map(|x| if s[1] > 0.0 { (x / s[1]) as f32 } else { 0.0 });
        Image {
            width: self.width,
            height: self.height,
            pixels: pixels.map(mean).collect(),
        }
    }

    /// Mean luminance of each pixel; NaN where there is no sample.
    pub fn luminance(&self) -> Vec<f64> {
        let mean = |(sum, s): (&[f64; 4], &[f64; 2])| luminance_of(*sum) / s[1];
        self.color.par_iter().zip(&self.statistics).map(mean).collect()
    }

    /// By how many standard deviations the luminance summed over the whole picture differs from that of another render
    /// of the same size. The sum over many pixels is nearly normal even where single pixels are skewed. Rounding of f32
    /// radiance counts as an uncertainty of 1e-4.
    pub fn difference_in_sigma(&self, other: &Film) -> f64 {
        let (a, b): (f64, f64) = (self.luminance().iter().sum(), other.luminance().iter().sum());
        let variance: f64 = self.variance_of_mean().iter().chain(&other.variance_of_mean()).sum();
        (a - b) / (variance + (1e-4 * a).powi(2)).sqrt()
    }

    /// Variance of the mean luminance of each pixel as if its samples were independent, from the running sums; infinite
    /// below two samples. Unbiased for independent numbers, too large for Sobol's: see `analysis::noise`.
    pub fn variance_of_mean(&self) -> Vec<f64> {
        let of_pixel = |(sum, s): (&[f64; 4], &[f64; 2])| {
            let n = s[1];
            if n < 2.0 {
                return f64::INFINITY;
            }
            let mean = luminance_of(*sum) / n;
            ((s[0] / n - mean * mean) / (n - 1.0)).max(0.0)
        };
        self.color.par_iter().zip(&self.statistics).map(of_pixel).collect()
    }
}

impl Image {
    /// The luminance of each pixel.
    pub fn luminance(&self) -> Vec<f64> {
        let of_pixel = |pixel: &[f32; 4]| luminance_of(pixel.map(f64::from));
        self.pixels.iter().map(of_pixel).collect()
    }
}

/// A linear picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Linear Rec. 709 red, green, blue, premultiplied by the alpha that follows; row by row from the top.
    pub pixels: Vec<[f32; 4]>,
}
