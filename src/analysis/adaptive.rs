//! Adaptive sampling: which tiles get further samples.
//!
//! For a given time, the squared error of an image is Σ σ²/n over its tiles, with the variance σ² of one sample. It is least
//! if n ∝ σ/√cost, with the cost of a sample in rays (Neyman 1934). So a tile pauses while it has more than its share of
//! samples, not when its own error reaches a goal: that would give dark smooth tiles enough samples, but noisy ones too
//! many.

use super::noise::{TileError, finite_sum, half_difference_variance, tile_errors};
use crate::job::{film::Film, tiles::TileGrid};

/// A tile counts with at least this part of a neighbour's variance: the edge of a small bright feature does not starve.
const NEIGHBOUR_SHARE: f64 = 0.25;
/// Smallest share of samples per tile, relative to an even distribution.
const LEAST_SHARE: f64 = 1.0 / 32.0;
/// Relative saving of a camera ray that misses over a ray with shading.
const CHEAPNESS: f64 = 0.8;
/// A tile's samples grow at most by this factor before its error is looked at again.
const GROWTH_MAX: f64 = 2.0;
/// Bisections of a factor: more than the bits of its mantissa.
const BISECTIONS: usize = 64;

/// Goal of the next round.
#[derive(Clone, Copy, Debug)]
pub struct Round {
    /// The samples of all pixels grow at least and at most by these factors, above 1.
    pub growth: [f64; 2],
    /// The relative error to reach, above 0; no more samples are asked for than it should need.
    pub noise: Option<f64>,
    /// Maximum samples per pixel.
    pub samples_max: u32,
    /// The rendered part, as in [`TileGrid::is_rendered`]; the rest keeps its samples.
    pub region: Option<[f64; 4]>,
}

/// Samples per pixel that each tile shall have next: never fewer than now, and more for some tile unless all have
/// `samples_max`.
pub fn next_goals(film: &Film, samples: &[u32], round: Round) -> Vec<u32> {
    let grid = film.grid();
    let errors = tile_errors(film);
    let is_rendered = |tile: usize| grid.is_rendered(tile, round.region);
    let tiles: Vec<Tile> = (0..grid.tiles())
        .map(|tile| Tile {
            // Tiles that are not rendered do not count.
            pixels: if is_rendered(tile) {
                grid.pixels(tile) as f64
            } else {
                0.0
            },
            samples: f64::from(samples[tile]).max(1.0),
            variance: errors[tile].sample_variance,
            weight: weight(&errors, grid, tile),
        })
        .collect();
    let tiles = with_least_weight(tiles);
    let ratios = || {
        tiles
            .iter()
            .filter(|tile| tile.pixels > 0.0)
            .map(|tile| tile.samples / tile.weight)
    };
    let (least, most) = (ratios().fold(f64::MAX, f64::min), ratios().fold(0.0, f64::max));
    let [growth_min, growth_max] = round.growth;
    let bracket = [least, growth_max * most];
    let all = |value: &dyn Fn(&Tile) -> f64| tiles.iter().map(|tile| tile.pixels * value(tile)).sum::<f64>();
    let total = all(&|tile| tile.samples);
    let growing = |growth: f64| bisect(bracket, |factor| all(&|tile| tile.goal(factor)) >= growth * total);
    let mut factor = growing(growth_max);
    if let Some(noise) = round.noise {
        let pixels = all(&|_| 1.0);
        let rendered = (0..grid.tiles()).filter(|tile| is_rendered(*tile));
        let rendered: Vec<usize> = rendered.flat_map(|tile| grid.pixels_of(tile)).collect();
        let sum = |of: &dyn Fn(usize) -> f64| finite_sum(rendered.iter().map(|pixel| of(*pixel)));
        let luminance = sum(&|pixel| film.luminance_of(pixel)) / pixels;
        // The tiles' smoothed variances need not add up to the estimate that decides the end.
        let seen = sum(&|pixel| half_difference_variance(&film.pixels[pixel]));
        let estimate = all(&|tile| tile.variance / tile.samples);
        let allowed = pixels * (noise * luminance).powi(2) * if seen > 0.0 { estimate / seen } else { 1.0 };
        let enough = bisect(bracket, |factor| {
            all(&|tile| tile.variance / tile.goal(factor)) <= allowed
        });
        factor = factor.min(enough).max(growing(growth_min));
    }
    let goal = |(tile, n): (&Tile, &u32)| {
        if tile.pixels == 0.0 {
            return *n;
        }
        let goal = tile.goal(factor).min(GROWTH_MAX * tile.samples).ceil() as u32;
        goal.min(round.samples_max).max(*n)
    };
    tiles.iter().zip(samples).map(goal).collect()
}

struct Tile {
    pixels: f64,
    samples: f64,
    variance: f64,
    /// Weight to which its samples are proportional.
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
    let cost = (errors[tile].rays - CHEAPNESS).max(1.0 - CHEAPNESS);
    (variance.max(errors[tile].sample_variance) / cost).sqrt()
}

fn with_least_weight(mut tiles: Vec<Tile>) -> Vec<Tile> {
    let pixels: f64 = tiles.iter().map(|tile| tile.pixels).sum();
    let mean = tiles.iter().map(|tile| tile.pixels * tile.weight).sum::<f64>() / pixels.max(1.0);
    // Without any error all are equal.
    let least = if mean > 0.0 { LEAST_SHARE * mean } else { 1.0 };
    tiles.iter_mut().for_each(|tile| tile.weight = tile.weight.max(least));
    tiles
}

/// The smallest number in a positive range from which on `is_enough` holds; the upper end if it never does.
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
