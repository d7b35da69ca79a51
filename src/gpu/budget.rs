//! Size of a dispatch, so that it ends in time. Other users of the adapter, the window among them, wait for its end, and
//! drivers stop dispatches of seconds.

use std::time::Duration;

use crate::job::tiles::TILE_SIDE;

/// Longest time of a dispatch on a GPU, once its speed is known: the window is to show 144 images per second.
pub const DISPATCH: Duration = Duration::from_millis(5);
/// The same on software Vulkan, whose dispatches cost more to begin.
pub const DISPATCH_SOFTWARE: Duration = Duration::from_millis(20);
/// Tiles of the first dispatch: at most 50 ms on an adapter that makes 10 000 samples a second. A dispatch of one tile is the
/// least there is.
pub const FIRST_TILES: usize = 8;
/// Tiles that fill an adapter: a dispatch of more of them takes more samples of each instead.
const TILES_FULL: f64 = 4096.0;
/// Most samples per pixel of such a pass.
const PASS_SAMPLES_MAX: u32 = 16;
/// Loop iterations after which Mesa's software driver 22.3 leaves every loop of an invocation, without an error: the
/// samples that are left would be missing, and the last one's rays would miss.
const LOOP_ITERATIONS: u32 = 65_535;
/// Loop iterations that one bounce may take, in all loops together. Measured: 40 per path of a glass teapot, 66 per camera
/// ray that misses with all effects on; the rest is for models of many triangles.
const BOUNCE_ITERATIONS: u32 = 256;
/// Largest growth of samples from one dispatch to the next: an idle GPU's time for a few tiles says little about its time
/// for many.
const GROWTH: f64 = 4.0;
/// Target share of the longest time, because some tiles take longer than others.
const SHARE: f64 = 0.6;
/// Weight of the past in the mean rate, per dispatch.
const MEMORY: f64 = 0.8;

/// The rate that may be counted on, from the last dispatches.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// Longest time of a dispatch.
    longest: Duration,
    /// Pixel samples of the last dispatch; 0 before the first.
    last: f64,
    /// Rate of the last dispatch, in pixel samples per second.
    last_rate: f64,
    /// Samples and seconds of the last dispatches, older ones fading.
    recent: [f64; 2],
}

impl Budget {
    /// The budget before the first dispatch of a kernel.
    pub fn new(longest: Duration) -> Self {
        Self {
            longest,
            last: 0.0,
            last_rate: 0.0,
            recent: [0.0; 2],
        }
    }

    /// The same limit without a known rate.
    pub fn of_another_kernel(self) -> Self {
        Self::new(self.longest)
    }

    /// Pixel samples that the next dispatch may have, if `left` is the time left for all of them.
    pub fn affordable(&self, left: Duration) -> f64 {
        if self.last == 0.0 {
            return FIRST_TILES as f64 * f64::from(TILE_SIDE * TILE_SIDE);
        }
        let [samples, seconds] = self.recent;
        // Before the scene's first dispatch, the last scene's rate is used.
        let mean_rate = if seconds > 0.0 {
            samples / seconds
        } else {
            self.last_rate
        };
        (SHARE * self.last_rate.min(mean_rate) * left.min(self.longest).as_secs_f64()).min(GROWTH * self.last)
    }

    /// Least samples per pixel of a pass if so many pixel samples are affordable, after `done` samples per pixel. The host's
    /// work goes by tiles: a fast adapter takes more samples of fewer tiles, as soon as the image has as many.
    pub fn least_pass_samples(affordable: f64, done: u32) -> u32 {
        let fitting = affordable / (TILES_FULL * f64::from(TILE_SIDE * TILE_SIDE));
        (fitting as u32).min(done).clamp(1, PASS_SAMPLES_MAX)
    }

    /// Most samples per pixel of a pass on software Vulkan, for paths of so many bounces.
    pub fn most_pass_samples(bounces: u32) -> u32 {
        (LOOP_ITERATIONS / BOUNCE_ITERATIONS / bounces.saturating_add(1)).max(1)
    }

    /// Records a dispatch of `samples` pixel samples that took `took`.
    pub fn note(&mut self, samples: u64, took: Duration) {
        let (samples, seconds) = (samples as f64, took.as_secs_f64().max(1e-6));
        let [before, seconds_before] = self.recent.map(|sum| MEMORY * sum);
        (self.last, self.last_rate) = (samples, samples / seconds);
        self.recent = [before + samples, seconds_before + seconds];
    }

    /// The budget for another scene on the same kernel, which may cost several times as much.
    pub fn of_another_scene(self) -> Self {
        Self {
            last: self.last / (GROWTH * GROWTH),
            recent: [0.0; 2],
            ..self
        }
    }
}
