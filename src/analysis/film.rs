//! The picture as sums: what the engines accumulate and everything shown is read from.

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
    /// Samples left out because they were not finite or negative.
    pub dropped: u64,
    /// Rays traced.
    pub rays: u64,
    /// Luminance that limiting fireflies took from all samples together.
    pub clamped: f64,
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
            dropped: 0,
            rays: 0,
            clamped: 0.0,
        }
    }

    /// The part of the picture's energy, in [0, 1], that limiting fireflies took.
    pub fn clamped_share(&self) -> f64 {
        let luminance = |sum: &[f64; 4]| 0.2126 * sum[0] + 0.7152 * sum[1] + 0.0722 * sum[2];
        let kept: f64 = self.color.iter().map(luminance).sum();
        if self.clamped > 0.0 {
            self.clamped / (self.clamped + kept)
        } else {
            0.0
        }
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
        let mean = |(sum, s): (&[f64; 4], &[f64; 2])| (0.2126 * sum[0] + 0.7152 * sum[1] + 0.0722 * sum[2]) / s[1];
        self.color.iter().zip(&self.statistics).map(mean).collect()
    }

    /// By how many standard deviations the luminance summed over the whole picture differs from that of another render
    /// of the same size. The sum over many pixels is nearly normal even where single pixels are skewed. Rounding of f32
    /// radiance counts as an uncertainty of 1e-4.
    pub fn difference_in_sigma(&self, other: &Film) -> f64 {
        let (a, b): (f64, f64) = (self.luminance().iter().sum(), other.luminance().iter().sum());
        let variance: f64 = self.variance_of_mean().iter().chain(&other.variance_of_mean()).sum();
        (a - b) / (variance + (1e-4 * a).powi(2)).sqrt()
    }

    /// Variance of the mean luminance of each pixel, unbiased; infinite below two samples.
    pub fn variance_of_mean(&self) -> Vec<f64> {
        let of_pixel = |(sum, s): (&[f64; 4], &[f64; 2])| {
            let n = s[1];
            if n < 2.0 {
                return f64::INFINITY;
            }
            let mean = (0.2126 * sum[0] + 0.7152 * sum[1] + 0.0722 * sum[2]) / n;
            ((s[0] / n - mean * mean) / (n - 1.0)).max(0.0)
        };
        self.color.iter().zip(&self.statistics).map(of_pixel).collect()
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
