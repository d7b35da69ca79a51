//! Where further samples help most.
//!
//! For a given time the squared error of a picture, Σ σ²/n over its tiles, is least where n ∝ σ/√cost (Neyman 1934):
//! σ² the variance of one sample, cost its rays. So a tile rests while it has more than its part, not when some error of
//! its own is reached: that would give dark smooth tiles as few samples as they need, but noisy ones too many.

use super::film::Film;
use super::noise::{TileError, half_difference_variances, tile_errors};
use super::tiles::TileGrid;

/// A tile counts with at least this part of a neighbour's variance: the edge of a small bright feature does not starve.
const NEIGHBOUR_SHARE: f64 = 0.25;
/// No tile gets less than this part of the samples that it would get if all were equal.
const LEAST_SHARE: f64 = 1.0 / 32.0;
/// A tile's samples grow at most by this factor before its error is looked at again.
const GROWTH_MAX: f64 = 2.0;
/// The samples of all tiles grow at least by this factor, so that the last rounds are not many.
const GROWTH_MIN: f64 = 1.02;
/// Bisections of a factor: more than the bits of its mantissa.
const BISECTIONS: usize = 64;

/// How far the next round goes.
#[derive(Clone, Copy, Debug)]
pub struct Round {
    /// The samples of all pixels grow at most by this factor, above 1.
    pub growth: f64,
    /// The relative error to reach, above 0; no more samples are asked for than it should need.
    pub noise: Option<f64>,
    /// The most samples that a pixel gets.
    pub samples_max: u32,
}

/// The samples a pixel that each tile is to have next, from what it has: never less, and somewhere more unless that tile
/// has `samples_max`.
pub fn next_goals(film: &Film, samples: &[u32], round: Round) -> Vec<u32> {
    let grid = TileGrid {
        width: film.width,
        height: film.height,
    };
    let errors = tile_errors(film);
    let tiles: Vec<Tile> = (0..grid.tiles())
        .map(|tile| Tile {
            pixels: grid.pixels(tile) as f64,
            samples: f64::from(samples[tile]).max(1.0),
            variance: errors[tile].sample_variance,
            weight: weight(&errors, grid, tile),
        })
        .collect();
    let tiles = with_least_weight(tiles);
    let ratios = || tiles.iter().map(|tile| tile.samples / tile.weight);
    let (least, most) = (ratios().fold(f64::MAX, f64::min), ratios().fold(0.0, f64::max));
    let bracket = [least, round.growth * most];
    let all = |value: &dyn Fn(&Tile) -> f64| tiles.iter().map(|tile| tile.pixels * value(tile)).sum::<f64>();
    let total = all(&|tile| tile.samples);
    let growing = |growth: f64| bisect(bracket, |factor| all(&|tile| tile.goal(factor)) >= growth * total);
    let mut factor = growing(round.growth);
    if let Some(noise) = round.noise {
        let pixels = all(&|_| 1.0);
        let luminance = film.luminance().iter().filter(|y| y.is_finite()).sum::<f64>() / pixels;
        // The tiles' variances, averaged as they are, need not add up to what decides about the end.
        let seen: f64 = half_difference_variances(film).iter().filter(|v| v.is_finite()).sum();
        let told = all(&|tile| tile.variance / tile.samples);
        let allowed = pixels * (noise * luminance).powi(2) * if seen > 0.0 { told / seen } else { 1.0 };
        let enough = bisect(bracket, |factor| {
            all(&|tile| tile.variance / tile.goal(factor)) <= allowed
        });
        factor = factor.min(enough).max(growing(GROWTH_MIN));
    }
    let goal = |(tile, n): (&Tile, &u32)| {
        let goal = tile.goal(factor).min(GROWTH_MAX * tile.samples).ceil() as u32;
        goal.min(round.samples_max).max(*n)
    };
    tiles.iter().zip(samples).map(goal).collect()
}

struct Tile {
    pixels: f64,
    samples: f64,
    variance: f64,
    /// What its samples are to be in proportion to.
    weight: f64,
}

impl Tile {
    fn goal(&self, factor: f64) -> f64 {
        self.samples.max(factor * self.weight)
    }
}

fn weight(errors: &[TileError], grid: TileGrid, tile: usize) -> f64 {
    let near = grid.around(tile).map(|near| errors[near].sample_variance);
    let variance = near.fold(0.0, f64::max) * NEIGHBOUR_SHARE;
    (variance.max(errors[tile].sample_variance) / errors[tile].rays.max(1.0)).sqrt()
}

fn with_least_weight(mut tiles: Vec<Tile>) -> Vec<Tile> {
    let pixels: f64 = tiles.iter().map(|tile| tile.pixels).sum();
    let mean = tiles.iter().map(|tile| tile.pixels * tile.weight).sum::<f64>() / pixels.max(1.0);
    // Without any error all are alike.
    let least = if mean > 0.0 { LEAST_SHARE * mean } else { 1.0 };
    tiles.iter_mut().for_each(|tile| tile.weight = tile.weight.max(least));
    tiles
}

/// The least number in a range of positive numbers from which on `is_enough` holds, its upper end where it never does.
fn bisect([mut low, mut high]: [f64; 2], is_enough: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..BISECTIONS {
        let middle = (low * high).sqrt();
        if is_enough(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}
