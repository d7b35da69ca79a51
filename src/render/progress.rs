//! Progress of a render, and its stop reason.

use crate::analysis::{halves::Distance, noise::Noise};

/// Reason for the end of a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum StopReason {
    /// Every pixel, or the one with the most, has the samples that were asked for.
    Samples,
    /// The time is over.
    Time,
    /// The target error is reached.
    Noise,
}

/// What to say of the share of the light that lies beyond the last bounce; nothing where there is little.
pub fn beyond_bounces(cut: f64, bounces: u32) -> String {
    const LEAST_TOLD: f64 = 0.0005;
    if cut < LEAST_TOLD {
        return String::new();
    }
    let s = if bounces == 1 { "" } else { "s" };
    format!(", and up to {:.1} % beyond {bounces} bounce{s}", 100.0 * cut)
}

/// Progress of a render.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Completed samples per pixel: the maximum over tiles.
    pub samples_per_pixel: u32,
    /// Samples per pixel to reach.
    pub samples_wanted: u32,
    /// Samples per pixel, averaged over the image: fewer if tiles pause.
    pub mean_samples: f64,
    /// Pixel samples a second by the engine's own time, over the whole render.
    pub samples_per_second: f64,
    /// Render time in seconds.
    pub render_seconds: f64,
    /// Engine's part of it in seconds, by the GPU's clock if it has one.
    pub engine_seconds: f64,
    /// Part of it for error measurements, in seconds.
    pub measure_seconds: f64,
    /// The error when it was last looked at.
    pub noise: Option<Noise>,
    /// Estimated share of the image's energy beyond the last bounce, when the error was last looked at.
    pub cut_share: f64,
    /// The relative error to reach.
    pub noise_wanted: Option<f64>,
    /// Estimated error of the denoised image, see [`Session::denoised`](super::Session::denoised).
    pub denoised: Option<Distance>,
    /// True if the target also applies to the denoised image's error, if lower.
    pub targets_denoised: bool,
    /// True while the CPU engine renders because the GPU's kernel is being compiled.
    pub is_fallback: bool,
    /// Compile time of the latest kernel in the background, in seconds.
    pub kernel_seconds: Option<f64>,
    /// Stop reason, once stopped.
    pub stopped_by: Option<StopReason>,
    /// True once the render is complete.
    pub is_done: bool,
}

impl Progress {
    /// Whether the target error is reached.
    pub fn is_converged(&self) -> bool {
        self.stop_error()
            .zip(self.noise_wanted)
            .is_some_and(|(error, wanted)| error <= wanted)
    }

    /// Samples per pixel after which the error would be down to this, as far as it is known.
    pub fn samples_to(&self, noise: f64) -> Option<f64> {
        Some(self.mean_samples * (self.stop_error()? / noise).powi(2))
    }

    /// Error used for the stop criterion: raw, or denoised if enabled and lower.
    fn stop_error(&self) -> Option<f64> {
        let noisy = self.noise.map(|noise| noise.relative);
        let denoised = self.denoised.filter(|_| self.targets_denoised).map(|error| error.value);
        noisy.into_iter().chain(denoised).reduce(f64::min)
    }

    /// Progress in [0, 1]: the maximum of samples, time and noise relative to their targets.
    pub fn share_done(&self, time_limit_s: Option<f64>) -> f64 {
        let by_samples = f64::from(self.samples_per_pixel) / f64::from(self.samples_wanted.max(1));
        let by_time = time_limit_s.map_or(0.0, |limit| self.render_seconds / limit);
        // The time to a noise level is proportional to its inverse square.
        let pair = self.stop_error().zip(self.noise_wanted);
        let by_noise = pair.map_or(0.0, |(error, wanted)| (wanted / error.max(1e-30)).powi(2));
        by_samples.max(by_time).max(by_noise).clamp(0.0, 1.0)
    }
}
