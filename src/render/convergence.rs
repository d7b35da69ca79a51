//! When a session looks at the error of its picture, what it saw, and what it renders next.

use crate::analysis::adaptive::{Round, next_goals};
use crate::analysis::noise::{Noise, noise};
use crate::document::RenderSettings;
use crate::job::film::Film;
use crate::job::tiles::Schedule;

/// Looking at the error takes at most this share of the time; near its end twice as much, not to go too far.
const COST_SHARE: f64 = 0.015;
/// What a look and a plan cost where samples are counted, in samples of the pixels looked at: measured, of a simple scene.
const LOOK_SAMPLES: f64 = 0.25;
/// By how much samples grow from one look to the next: while only watched; on the way to a noise; where tiles rest; and
/// at least, by what looks cost.
const GROWTH_WATCHED: f64 = 1.1;
const GROWTH_MIN: [f64; 2] = [1.02, 1.1];
const GROWTH_AIMED: f64 = 1.5;
const GROWTH_ADAPTIVE: f64 = 1.25;
/// And at most after the first look: what it took and what the first samples took, all of them cold, says little of what
/// looks and samples cost.
const GROWTH_COLD: f64 = 8.0;

/// The error of a picture at some point of its render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// The engine's own time until then, seconds.
    pub engine_seconds: f64,
    /// Samples per pixel until then, averaged over the picture.
    pub samples_per_pixel: f64,
    /// What was seen.
    pub noise: Noise,
}

/// What the length of a round goes by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pacing {
    /// The engine's own time until now, seconds; `None` where rounds end by the number of samples alone. On the CPU they
    /// do where tiles rest or a noise is to be reached, so that the same render twice is the same picture: tiles rest, and
    /// rendering stops, where a round ends.
    pub(super) engine_seconds: Option<f64>,
    /// The picture is denoised at the end of each round, and rendering stops where that is exact enough.
    pub(super) is_denoised: bool,
}

/// Rounds of rendering, with a look at the error after each.
#[derive(Debug, Default)]
pub(super) struct Convergence {
    /// Samples a pixel that each tile is to have at the end of the round.
    pub(super) goals: Vec<u32>,
    /// What was seen, oldest first.
    pub(super) history: Vec<Measurement>,
    /// Samples of all pixels when the error was last looked at.
    measured_samples: u64,
    /// What a look and a plan take, seconds: the least seen, as the machine may do something else in between.
    look_seconds: Option<f64>,
    plan_seconds: Option<f64>,
    /// What all looks and plans took, seconds.
    pub(super) total_seconds: f64,
}

/// The samples of the tile that has the fewest, of the part that is rendered.
pub(super) fn fewest_samples(schedule: &Schedule, settings: &RenderSettings) -> u32 {
    let grid = schedule.grid();
    let samples = schedule.samples().iter().enumerate();
    let rendered = samples.filter(|(tile, _)| grid.is_rendered(*tile, settings.region));
    rendered.map(|(_, samples)| *samples).min().unwrap_or(0)
}

impl Convergence {
    /// The latest error seen.
    pub(super) fn noise(&self) -> Option<Noise> {
        self.history.last().map(|measurement| measurement.noise)
    }

    /// Factor, at least 1, by which the true error may be below the estimate. Aiming at the estimate itself would render
    /// too much half of the time, and far too much where the estimate rests on few pixels or samples.
    fn doubt(&self) -> f64 {
        let ratio = self.noise().map_or(1.0, |noise| noise.relative / noise.low);
        if ratio.is_finite() { ratio.max(1.0) } else { 1.0 }
    }

    /// Whether something was rendered since the last look.
    pub(super) fn is_stale(&self, schedule: &Schedule) -> bool {
        schedule.pixel_samples() > self.measured_samples
    }

    /// Records how long estimating the error took.
    pub(super) fn looked(&mut self, seconds: f64) {
        self.total_seconds += seconds;
        self.look_seconds = lesser(self.look_seconds, seconds);
    }

    /// Records how long setting the goals took.
    pub(super) fn planned(&mut self, seconds: f64) {
        self.total_seconds += seconds;
        self.plan_seconds = lesser(self.plan_seconds, seconds);
    }

    /// Looks at the error, of the part that is rendered.
    pub(super) fn measure(&mut self, film: &Film, schedule: &Schedule, settings: &RenderSettings, engine_seconds: f64) {
        self.measured_samples = schedule.pixel_samples();
        let grid = schedule.grid();
        let seen = match settings.region {
            Some(region) => noise(&film.of_pixels(|pixel| grid.is_within(grid.of_pixel(pixel), region))),
            None => noise(film),
        };
        if let Some(noise) = seen {
            self.history.push(Measurement {
                engine_seconds,
                samples_per_pixel: mean_samples(schedule),
                noise,
            });
        }
    }

    /// By how much samples grow in a round that is so long that the look at its end takes no more than its share.
    fn paced(&self, schedule: &Schedule, settings: &RenderSettings, pacing: Pacing) -> f64 {
        let look = match pacing.engine_seconds {
            Some(seconds) => (self.look_seconds.unwrap_or(0.0) + self.plan_seconds.unwrap_or(0.0)) / seconds.max(1e-9),
            None => LOOK_SAMPLES / rendered_samples(schedule, settings).max(1.0),
        };
        let most = match (pacing.is_denoised && settings.noise.is_some(), self.history.len()) {
            (true, _) => GROWTH_AIMED,
            (false, 0 | 1) => GROWTH_COLD,
            (false, _) => f64::INFINITY,
        };
        (1.0 + look / COST_SHARE).min(most)
    }

    /// Sets the goals of the next round: no pixel more than `settings.samples`, and none outside the part that is
    /// rendered. `film` is read where tiles may rest.
    pub(super) fn next_round(
        &mut self,
        film: Option<&Film>,
        schedule: &Schedule,
        settings: &RenderSettings,
        pacing: Pacing,
    ) {
        self.next_round_of_all(film, schedule, settings, pacing);
        let Some(region) = settings.region else { return };
        let grid = schedule.grid();
        for (tile, (goal, samples)) in self.goals.iter_mut().zip(schedule.samples()).enumerate() {
            if !grid.is_within(tile, region) {
                *goal = *samples;
            }
        }
    }

    fn next_round_of_all(
        &mut self,
        film: Option<&Film>,
        schedule: &Schedule,
        settings: &RenderSettings,
        pacing: Pacing,
    ) {
        let samples = schedule.samples();
        let most = samples.iter().copied().max().unwrap_or(0);
        let least = settings.least_samples();
        let is_aimed = settings.noise.is_some() || settings.is_adaptive();
        if is_aimed && fewest_samples(schedule, settings) < least {
            self.goals = samples.iter().map(|samples| least.max(*samples)).collect();
            return;
        }
        // Two samples in every pixel are the fewest from which the error can be estimated.
        if most < 2 {
            self.goals = vec![settings.samples.min(2); samples.len()];
            return;
        }
        let paced = self.paced(schedule, settings, pacing);
        let growth_min = (0.5 * (1.0 + paced)).clamp(GROWTH_MIN[0], GROWTH_MIN[1]);
        if let Some(film) = film.filter(|_| settings.is_adaptive()) {
            let round = Round {
                growth: [growth_min, paced.max(GROWTH_ADAPTIVE)],
                noise: settings.noise.map(|wanted| wanted * self.doubt()),
                samples_max: settings.samples,
                region: settings.region,
            };
            self.goals = next_goals(film, samples, round);
            return;
        }
        let growth = match (settings.noise, self.noise()) {
            // The error falls as 1/√n; rather a little short of the target than beyond it.
            (Some(wanted), Some(noise)) => {
                let aim = wanted * self.doubt();
                (noise.relative / aim).powi(2).min(paced.max(GROWTH_AIMED))
            }
            _ => paced.max(GROWTH_WATCHED),
        };
        let growth = growth.max(growth_min);
        let goal = (f64::from(most) * growth).ceil().max(f64::from(most) + 1.0) as u32;
        self.goals = vec![goal.min(settings.samples); samples.len()];
    }
}

/// Samples per pixel, averaged over the part that is rendered.
fn rendered_samples(schedule: &Schedule, settings: &RenderSettings) -> f64 {
    let grid = schedule.grid();
    let tiles = schedule.samples().iter().enumerate();
    let [mut samples, mut pixels] = [0; 2];
    for (tile, count) in tiles.filter(|(tile, _)| grid.is_rendered(*tile, settings.region)) {
        samples += grid.pixels(tile) * u64::from(*count);
        pixels += grid.pixels(tile);
    }
    samples as f64 / pixels.max(1) as f64
}

fn lesser(least: Option<f64>, seconds: f64) -> Option<f64> {
    Some(least.map_or(seconds, |least| least.min(seconds)))
}

/// Samples per pixel, averaged over the picture.
pub(super) fn mean_samples(schedule: &Schedule) -> f64 {
    let grid = schedule.grid();
    let pixels = u64::from(grid.width) * u64::from(grid.height);
    schedule.pixel_samples() as f64 / pixels.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::tiles::{Order, SliceLimits};

    const COUNTED: Pacing = Pacing {
        engine_seconds: None,
        is_denoised: false,
    };

    #[test]
    fn the_first_round_ends_where_an_error_can_be_told() {
        let mut convergence = Convergence::default();
        let mut schedule = Schedule::new(16, 8);
        for (samples, goal) in [(64, 2), (1, 1)] {
            let settings = RenderSettings {
                samples,
                ..Default::default()
            };
            convergence.next_round(None, &schedule, &settings, COUNTED);
            assert_eq!(convergence.goals, [goal; 2]);
        }
        schedule.aim(&[2; 2]);
        let limits = SliceLimits {
            pass_samples: [2; 2],
            tiles: [2; 2],
            order: Order::Rows,
        };
        let works = schedule.slice(0.0, limits);
        schedule.finish(&works);
        convergence.next_round(None, &schedule, &RenderSettings::default(), COUNTED);
        assert!(
            convergence.goals.iter().all(|goal| *goal > 2),
            "{:?}",
            convergence.goals
        );
    }
}
