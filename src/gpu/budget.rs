//! Size of a dispatch, so that it ends in time. Other users of the adapter, the window among them, wait for its end, and
//! drivers stop dispatches of seconds.

use std::time::Duration;

use crate::job::tiles::TILE_SIDE;

/// Longest time of a dispatch, once the adapter's speed is known.
pub const DISPATCH: Duration = Duration::from_millis(20);
/// Tiles of the first dispatch: at most 50 ms on an adapter that makes 10 000 samples a second. A dispatch of one tile is the
/// least there is.
pub const FIRST_TILES: usize = 8;
/// Largest growth of samples from one dispatch to the next: an idle GPU's time for a few tiles says little about its time
/// for many.
const GROWTH: f64 = 4.0;
/// Target share of [`DISPATCH`], because some tiles take longer than others.
const SHARE: f64 = 0.6;
/// Weight of the past in the mean rate, per dispatch.
const MEMORY: f64 = 0.8;

/// The rate that may be counted on, from the last dispatches.
#[derive(Clone, Copy, Debug, Default)]
pub struct Budget {
    /// Pixel samples of the last dispatch; 0 before the first.
    last: f64,
    /// Rate of the last dispatch, in pixel samples per second.
    last_rate: f64,
    /// Samples and seconds of the last dispatches, older ones fading.
    recent: [f64; 2],
}

impl Budget {
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
        let rate = self.last_rate.min(mean_rate);
        (SHARE * rate * left.min(DISPATCH).as_secs_f64()).min(GROWTH * self.last)
    }

    /// Records a dispatch of `samples` pixel samples that took `took`.
    pub fn note(&mut self, samples: u64, took: Duration) {
        let (samples, seconds) = (samples as f64, took.as_secs_f64().max(1e-6));
        let [before, seconds_before] = self.recent.map(|sum| MEMORY * sum);
        *self = Self {
            last: samples,
            last_rate: samples / seconds,
            recent: [before + samples, seconds_before + seconds],
        };
    }

    /// The budget for another scene on the same kernel, which may cost several times as much.
    pub fn of_another_scene(self) -> Self {
        Self {
            last: self.last / (GROWTH * GROWTH),
            last_rate: self.last_rate,
            recent: [0.0; 2],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::tiles::{Order, Schedule, SliceLimits};

    /// The longest dispatch of a simulated render, on an adapter with a latency and a rate. The lower half of the image is
    /// `ratio` times as costly as the upper. The first dispatch is returned separately.
    fn longest(budget: &mut Budget, rate: f64, latency_s: f64, ratio: f64) -> (Duration, Duration, usize) {
        let mut schedule = Schedule::new(960, 540);
        let grid = schedule.grid();
        schedule.set_goals(&vec![4; grid.tiles()]);
        let (mut first, mut longest, mut count) = (Duration::ZERO, Duration::ZERO, 0);
        loop {
            let limits = SliceLimits {
                pass_samples: [1, 1024],
                tiles: [1, 65_535],
                order: Order::Spread,
            };
            let works = schedule.slice(budget.affordable(Duration::from_secs(1)), limits);
            if works.is_empty() {
                return (first, longest, count);
            }
            let cost = |tile: usize| if tile < grid.tiles() / 2 { 1.0 } else { ratio };
            let samples = works.iter().map(|work| {
                let samples = grid.pixels(work.tile) * u64::from(work.count);
                samples as f64 * cost(work.tile)
            });
            let took = Duration::from_secs_f64(latency_s + samples.sum::<f64>() / rate);
            budget.note(grid.pixel_samples(&works), took);
            schedule.finish(&works);
            if count == 0 {
                first = took;
            } else {
                longest = longest.max(took);
            }
            count += 1;
        }
    }

    #[test]
    fn no_dispatch_takes_longer_than_it_may() {
        for (rate, latency_s) in [(2e5, 1e-3), (1e6, 1e-4), (1e9, 1e-4), (1e9, 2e-3)] {
            for ratio in [1.0, 10.0] {
                let mut budget = Budget::default();
                let (first, after, count) = longest(&mut budget, rate, latency_s, 1.0);
                // The next scene starts in the middle of this one and is costlier.
                budget.note((rate * 0.01) as u64, Duration::from_millis(10));
                budget = budget.of_another_scene();
                let (begun, costlier, _) = longest(&mut budget, rate, latency_s, ratio);
                let reported = format!(
                    "{rate} samples a second: {first:?}, {after:?}, {begun:?}, {costlier:?}, {count} dispatches"
                );
                assert!(first <= Duration::from_millis(50), "{reported}");
                assert!(after.max(begun).max(costlier) <= DISPATCH, "{reported}");
                // Nor may it be too slow.
                let ideal = 960.0 * 540.0 * 4.0 / rate / DISPATCH.as_secs_f64();
                assert!((count as f64) < 2.5 * ideal + 16.0, "{reported}");
            }
        }
    }
}
