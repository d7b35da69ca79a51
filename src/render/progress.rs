//! How far a render has come, and what ended it.

use crate::analysis::halves::Distance;
use crate::analysis::noise::Noise;

/// What ended a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum StopReason {
    /// Every pixel, or the one with the most, has the samples that were asked for.
    Samples,
    /// The time is over.
    Time,
    /// The picture is as exact as was asked for.
    Noise,
}

/// How far a render has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Completed samples a pixel, where there are most.
    pub samples_per_pixel: u32,
    /// Samples a pixel to reach.
    pub samples_wanted: u32,
    /// Samples per pixel, averaged over the picture: fewer where tiles have been left at rest.
    pub mean_samples: f64,
    /// Pixel samples a second by the engine's own time, over the whole render.
    pub samples_per_second: f64,
    /// Time spent on this picture, seconds.
    pub render_seconds: f64,
    /// Of it the engine's own: by the GPU's clock where it has one.
    pub engine_seconds: f64,
    /// Of it the time for looking at the error.
    pub measure_seconds: f64,
    /// The error when it was last looked at.
    pub noise: Option<Noise>,
    /// The relative error to reach.
    pub noise_wanted: Option<f64>,
    /// The error of the denoised picture, as told to [`Session::set_denoised_error`](super::Session::set_denoised_error).
    pub denoised: Option<Distance>,
    /// The error to reach is that of the denoised picture, where it is the lesser.
    pub aims_at_denoised: bool,
    /// The processor draws, because the GPU's kernel is being compiled.
    pub is_fallback: bool,
    /// How long the kernel took that was compiled last beside the picture, seconds.
    pub kernel_seconds: Option<f64>,
    /// Why nothing more is rendered.
    pub stopped_by: Option<StopReason>,
    /// All that was asked for has been done.
    pub is_done: bool,
}

impl Progress {
    /// Whether the picture is as exact as was asked for.
    pub fn is_converged(&self) -> bool {
        let pair = self.error_aimed_at().zip(self.noise_wanted);
        pair.is_some_and(|(error, wanted)| error <= wanted)
    }

    /// The relative error that is compared with the target: the samples' or, where it counts and is lower, the denoised
    /// picture's.
    fn error_aimed_at(&self) -> Option<f64> {
        let noisy = self.noise.map(|noise| noise.relative);
        let denoised = self.denoised.filter(|_| self.aims_at_denoised).map(|error| error.value);
        noisy.into_iter().chain(denoised).reduce(f64::min)
    }

    /// How much has been done of what is to be done, in [0, 1]: of samples, time and noise the one that is nearest.
    pub fn share_done(&self, time_limit_s: Option<f64>) -> f64 {
        let by_samples = f64::from(self.samples_per_pixel) / f64::from(self.samples_wanted.max(1));
        let by_time = time_limit_s.map_or(0.0, |limit| self.render_seconds / limit);
        // The time that a noise takes goes with the inverse of its square.
        let pair = self.error_aimed_at().zip(self.noise_wanted);
        let by_noise = pair.map_or(0.0, |(error, wanted)| (wanted / error.max(1e-30)).powi(2));
        by_samples.max(by_time).max(by_noise).clamp(0.0, 1.0)
    }
}
