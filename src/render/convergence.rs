//! Schedule of error measurements of a session, their history, and the goals of the next round.

use crate::{
    analysis::adaptive::{Round, next_goals},
    analysis::noise::{Noise, noise},
    document::RenderSettings,
    job::{film::Film, tiles::Schedule},
};

/// Largest share of time for error measurements; twice as much near the end, so that the render does not overshoot.
const COST_SHARE: f64 = 0.015;
/// Cost of a measurement with planning, in samples of the measured pixels, if rounds are counted in samples: measured on a
/// simple scene.
const LOOK_SAMPLES: f64 = 0.25;
/// Growth of samples between measurements: while only observed; towards a noise goal; if tiles pause; and at least, by the
/// measurement's cost.
const GROWTH_WATCHED: f64 = 1.1;
const GROWTH_MIN: [f64; 2] = [1.02, 1.1];
const GROWTH_TARGETED: f64 = 1.5;
const GROWTH_ADAPTIVE: f64 = 1.25;
/// Largest growth after the first measurement, because cold caches make the first times unreliable.
const GROWTH_COLD: f64 = 8.0;

/// An error measurement during a render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// The engine's own time until then, seconds.
    pub engine_seconds: f64,
    /// Samples per pixel at that time, averaged over the image.
    pub samples_per_pixel: f64,
    pub noise: Noise,
}

/// Inputs for the length of a round.
#[derive(Clone, Copy, Debug)]
pub struct Pacing {
    /// Engine time so far, in seconds; `None` if rounds end by samples alone. The CPU engine does so with adaptive sampling
    /// or a noise limit: tiles pause, and rendering stops, at the end of a round. So the same render twice gives the same image.
    pub engine_seconds: Option<f64>,
    /// True if the image is denoised after each round, and its error is the stop criterion.
    pub is_denoised: bool,
}

/// What is done between rounds.
#[derive(Clone, Copy, Debug)]
pub enum Work {
    /// Estimating the error.
    Measuring,
    /// Setting the goals.
    Planning,
}

/// Rounds of rendering, each followed by an error measurement.
#[derive(Debug, Default)]
pub struct Convergence {
    /// Samples per pixel that each tile is to have at the end of the round.
    pub goals: Vec<u32>,
    /// Measurements, oldest first.
    pub history: Vec<Measurement>,
    /// Share of the image's energy beyond the last bounce when the error was last looked at.
    pub cut_share: f64,
    /// Samples of all pixels when the error was last looked at.
    measured_samples: u64,
    /// Time of a measurement and of planning in seconds: the minimum so far, because other work may disturb it.
    least_seconds: [Option<f64>; 2],
    /// Total time of measurements and planning, in seconds.
    pub total_seconds: f64,
}

/// The samples of the tile that has the fewest, of the part that is rendered.
pub fn fewest_samples(schedule: &Schedule, settings: &RenderSettings) -> u32 {
    let grid = schedule.grid();
    let samples = schedule.samples().iter().enumerate();
    let rendered = samples.filter(|(tile, _)| grid.is_rendered(*tile, settings.region));
    rendered.map(|(_, samples)| *samples).min().unwrap_or(0)
}

impl Convergence {
    /// The latest error seen.
    pub fn noise(&self) -> Option<Noise> {
        self.history.last().map(|measurement| measurement.noise)
    }

    /// Safety factor of at least 1 by which the true error may be below the estimate. Aiming at the estimate itself would
    /// render too much half of the time, and far too much if it rests on few pixels or samples.
    fn doubt(&self) -> f64 {
        let ratio = self.noise().map_or(1.0, |noise| noise.relative / noise.low);
        if ratio.is_finite() { ratio.max(1.0) } else { 1.0 }
    }

    /// Whether something was rendered since the last look.
    pub fn is_stale(&self, schedule: &Schedule) -> bool {
        schedule.pixel_samples() > self.measured_samples
    }

    /// Records how long some work took.
    pub fn took(&mut self, work: Work, seconds: f64) {
        self.total_seconds += seconds;
        let least = &mut self.least_seconds[work as usize];
        *least = Some(least.map_or(seconds, |least| least.min(seconds)));
    }

    /// Measures the error of the rendered part.
    pub fn measure(&mut self, film: &Film, schedule: &Schedule, settings: &RenderSettings, engine_seconds: f64) {
        self.measured_samples = schedule.pixel_samples();
        self.cut_share = film.cut_share();
        let grid = schedule.grid();
        let seen = match settings.region {
            Some(_) => noise(&film.of_pixels(|pixel| grid.is_rendered(grid.of_pixel(pixel), settings.region))),
            None => noise(film),
        };
        if let Some(noise) = seen {
            self.history.push(Measurement {
                engine_seconds,
                samples_per_pixel: mean_samples(schedule, None),
                noise,
            });
        }
    }

    /// Growth of samples in a round that is long enough for its measurement to stay within its share of time.
    fn paced(&self, schedule: &Schedule, settings: &RenderSettings, pacing: Pacing) -> f64 {
        let look = match pacing.engine_seconds {
            Some(seconds) => self.least_seconds.iter().flatten().sum::<f64>() / seconds.max(1e-9),
            None => LOOK_SAMPLES / mean_samples(schedule, settings.region).max(1.0),
        };
        let most = match (pacing.is_denoised && settings.noise.is_some(), self.history.len()) {
            (true, _) => GROWTH_TARGETED,
            (false, 0 | 1) => GROWTH_COLD,
            (false, _) => f64::INFINITY,
        };
        (1.0 + look / COST_SHARE).min(most)
    }

    /// Sets the goals of the next round: at most `settings.samples` per pixel, and none outside the rendered part. `film` is
    /// read if tiles may pause.
    pub fn next_round(&mut self, film: Option<&Film>, schedule: &Schedule, settings: &RenderSettings, pacing: Pacing) {
        self.goals = self.goals_of_all(film, schedule, settings, pacing);
        let grid = schedule.grid();
        for (tile, (goal, samples)) in self.goals.iter_mut().zip(schedule.samples()).enumerate() {
            if !grid.is_rendered(tile, settings.region) {
                *goal = *samples;
            }
        }
    }

    fn goals_of_all(
        &self,
        film: Option<&Film>,
        schedule: &Schedule,
        settings: &RenderSettings,
        pacing: Pacing,
    ) -> Vec<u32> {
        let samples = schedule.samples();
        let most = samples.iter().copied().max().unwrap_or(0);
        let least = settings.least_samples();
        let has_target = settings.noise.is_some() || settings.is_adaptive();
        if has_target && fewest_samples(schedule, settings) < least {
            return samples.iter().map(|samples| least.max(*samples)).collect();
        }
        // Two samples in every pixel are the fewest from which the error can be estimated.
        if most < 2 {
            return vec![settings.samples.min(2); samples.len()];
        }
        let paced = self.paced(schedule, settings, pacing);
        let growth_min = (0.5 * (1.0 + paced)).clamp(GROWTH_MIN[0], GROWTH_MIN[1]);
        if let Some(film) = film.filter(|_| settings.is_adaptive()) {
            let round = Round {
                growth: [growth_min, paced.max(GROWTH_ADAPTIVE)],
                noise: settings.noise.map(|target_noise| target_noise * self.doubt()),
                samples_max: settings.samples,
                region: settings.region,
            };
            return next_goals(film, samples, round);
        }
        let growth = match (settings.noise, self.noise()) {
            // The error falls as 1/√n; rather a little short of the target than beyond it.
            (Some(target_noise), Some(noise)) => (noise.relative / (target_noise * self.doubt()))
                .powi(2)
                .min(paced.max(GROWTH_TARGETED)),
            _ => paced.max(GROWTH_WATCHED),
        };
        let goal = (f64::from(most) * growth.max(growth_min))
            .ceil()
            .max(f64::from(most) + 1.0) as u32;
        vec![goal.min(settings.samples); samples.len()]
    }
}

/// Samples per pixel, averaged over a region, or over the image.
pub fn mean_samples(schedule: &Schedule, region: Option<[f64; 4]>) -> f64 {
    let grid = schedule.grid();
    let tiles = schedule.samples().iter().enumerate();
    let [mut samples, mut pixels] = [0; 2];
    for (tile, count) in tiles.filter(|(tile, _)| grid.is_rendered(*tile, region)) {
        samples += grid.pixels(tile) * u64::from(*count);
        pixels += grid.pixels(tile);
    }
    samples as f64 / pixels.max(1) as f64
}
