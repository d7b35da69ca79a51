//! How much a dispatch renders, so that it ends in time: other users of the adapter, the window among them, wait for its
//! end, and drivers stop what takes seconds.

use std::time::Duration;

use crate::job::tiles::TILE_SIDE;

/// What a dispatch is to take at most, once the adapter's speed is known.
pub const DISPATCH: Duration = Duration::from_millis(20);
/// Tiles of the first dispatch: at most 50 ms on an adapter that makes 10 000 samples a second. A dispatch of one tile is the
/// least there is.
pub const FIRST_TILES: usize = 8;
/// A dispatch has at most so many times the samples of the one before: what an idle GPU does with a few tiles says little
/// of what it does with many.
const GROWTH: f64 = 4.0;
/// What is aimed at of [`DISPATCH`]: some tiles take longer than others.
const SHARE: f64 = 0.6;
/// What a dispatch counts for in the mean rate when the next one comes.
const MEMORY: f64 = 0.8;

/// The rate that may be counted on, from the last dispatches.
#[derive(Clone, Copy, Debug, Default)]
pub struct Budget {
    /// Samples of a pixel in the last dispatch; 0 where there was none.
    last: f64,
    /// Those of the last dispatch a second.
    last_rate: f64,
    /// Samples and seconds of the last dispatches, older ones fading.
    recent: [f64; 2],
}

impl Budget {
    /// Samples of a pixel that a dispatch may have where `left` is left of the time for all of them.
    pub fn affordable(&self, left: Duration) -> f64 {
        if self.last == 0.0 {
            return FIRST_TILES as f64 * f64::from(TILE_SIDE * TILE_SIDE);
        }
        let [samples, seconds] = self.recent;
        // Where nothing is known of the scene, the last one's rate stands in.
        let mean_rate = if seconds > 0.0 {
            samples / seconds
        } else {
            self.last_rate
        };
        let rate = self.last_rate.min(mean_rate);
        (SHARE * rate * left.min(DISPATCH).as_secs_f64()).min(GROWTH * self.last)
    }

    /// Takes note of a dispatch.
    pub fn note(&mut self, samples: u64, took: Duration) {
        let (samples, seconds) = (samples as f64, took.as_secs_f64().max(1e-6));
        let [before, seconds_before] = self.recent.map(|sum| MEMORY * sum);
        *self = Self {
            last: samples,
            last_rate: samples / seconds,
            recent: [before + samples, seconds_before + seconds],
        };
    }

    /// Another scene on the same kernel, which may cost several times as much.
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

    /// The longest dispatch of a render on an adapter of a latency and a rate where the lower half of the picture costs
    /// so many times as much as the upper; the first one is told apart.
    fn longest(budget: &mut Budget, rate: f64, latency_s: f64, ratio: f64) -> (Duration, Duration, usize) {
        let mut schedule = Schedule::new(960, 540);
        let grid = schedule.grid();
        schedule.aim(&vec![4; grid.tiles()]);
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
                // The next scene comes in the midst of this one, and is dearer.
                budget.note((rate * 0.01) as u64, Duration::from_millis(10));
                budget = budget.of_another_scene();
                let (begun, costlier, _) = longest(&mut budget, rate, latency_s, ratio);
                let reported = format!(
                    "{rate} samples a second: {first:?}, {after:?}, {begun:?}, {costlier:?}, {count} dispatches"
                );
                assert!(first <= Duration::from_millis(50), "{reported}");
                assert!(after.max(begun).max(costlier) <= DISPATCH, "{reported}");
                // It is no drag either.
                let ideal = 960.0 * 540.0 * 4.0 / rate / DISPATCH.as_secs_f64();
                assert!((count as f64) < 2.5 * ideal + 16.0, "{reported}");
            }
        }
    }
}
