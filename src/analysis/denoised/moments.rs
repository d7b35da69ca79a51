//! Sums of estimated squared errors of a denoised image, and what follows from them.

use super::super::noise::{BAND, sums};

/// Standard errors that the denoised image's error must exceed before samples are blended in.
const DOUBT_SIGMAS: f64 = 1.0;
/// Share of the squared bias's variance over the squared bias by which the latter is lowered. For normal noise of standard
/// deviation σ the mean estimate is then at most 0.33 σ too high (0.40 σ without) and 0.055 σ too low.
const SHRINKAGE: f64 = 0.1;
/// Smallest effective number of tiles behind a standard error. With fewer, the expansion of Student's quantile fails.
const TILES_MIN: f64 = 3.0;

sums! {
    /// Unbiased estimates of a pixel's squared errors, or sums of these over pixels.
    Moments {
        /// Squared error of the denoised image.
        denoised,
        /// The part of `denoised` that is known without noise.
        known,
        /// Squared error of the samples' mean.
        noisy,
        /// Product of both errors.
        product,
        /// Variance of `denoised`, from the neighbourhood of each pixel. Too small if the noise differs between pixels, or comes
        /// from rare samples.
        variance,
        /// The same from whole tiles, by the differences of the halves' squares. Too large for noise with long tails, where the
        /// error is uncertain anyway.
        by_squares,
        /// The same from the difference of the denoised halves in each pixel, and its correlation with those around it. Needed if
        /// the filter leaves noise that differs between pixels, of which the other two see too little.
        by_pixels,
        /// Sum over tiles of `by_squares` squared.
        fourth_powers,
        /// Squared difference of the denoised image and the samples' mean.
        difference,
        /// Number of pixels.
        pixels,
    }
}

impl Moments {
    /// Squared error of the denoised image, at least the part that is known.
    ///
    /// The rest, the squared bias, is at least 0. A bound alone would let noise raise the estimate and never lower it, so the
    /// rest is lowered by [`SHRINKAGE`] of its variance over itself.
    pub fn denoised(&self) -> f64 {
        let bias = self.denoised - self.known;
        if bias <= 0.0 {
            return self.known;
        }
        self.known + (bias - SHRINKAGE * self.deviation().powi(2) / bias).max(0.0)
    }

    /// Standard error of `denoised`.
    pub fn deviation(&self) -> f64 {
        self.variance.max(self.by_squares).max(self.by_pixels).sqrt()
    }

    /// Half width of the 95 % interval in standard errors: Student's quantile (expansion of Cornish and Fisher). The
    /// standard error is itself an estimate, mostly from few tiles. Their number follows from the kurtosis.
    pub fn band_factor(&self) -> f64 {
        let tiles = (3.0 * self.by_squares * self.by_squares / self.fourth_powers).max(TILES_MIN);
        let square = BAND * BAND;
        let terms = [
            (square + 1.0) / (4.0 * tiles),
            (5.0 * square * square + 16.0 * square + 3.0) / (96.0 * tiles * tiles),
        ];
        BAND * (1.0 + terms[0] + terms[1])
    }

    /// The share in [0, 1] of the samples' mean in the blend of least error, lowered by [`DOUBT_SIGMAS`].
    pub fn share(&self) -> f64 {
        let denoised = (self.denoised - DOUBT_SIGMAS * self.deviation()).max(self.known);
        let share = (denoised - self.product) / self.difference;
        if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 }
    }
}
