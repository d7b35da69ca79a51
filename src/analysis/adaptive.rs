//! Adaptive sampling: which tiles get further samples.
//!
//! For a given time, the squared error of an image is Σ σ²/n over its tiles, with the variance σ² of one sample. It is least
//! if n ∝ σ/√cost, with the cost of a sample in rays (Neyman 1934). So a tile pauses while it has more than its share of
//! samples, not when its own error reaches a goal: that would give dark smooth tiles enough samples, but noisy ones too
//! many.

use super::noise::{TileError, finite_sum, half_difference_variance, tile_errors};
use crate::job::film::Film;
use crate::job::tiles::TileGrid;

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
        let seen = sum(&|pixel| half_difference_variance(&film.halves(pixel)));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::random::{Sequence, random_pair, random_state};

    const SIDE: u32 = 48;

    /// A film of 16 samples per pixel, each at the cost of `rays`, whose standard deviation a sample is `sigma` of its tile.
    fn film(sigma: &dyn Fn(usize) -> f64, rays: &dyn Fn(usize) -> f64) -> Film {
        let grid = TileGrid {
            width: SIDE,
            height: SIDE,
        };
        let mut film = Film::new(SIDE, SIDE);
        for pixel in 0..(SIDE * SIDE) as usize {
            let tile = grid.of_pixel(pixel);
            for sample in 0..16 {
                let state = random_state(pixel as u32, 0, 7, sample, Sequence::Independent);
                let [x, _]: [f64; 2] = random_pair(state, 0);
                let y = 1.0 + sigma(tile) * 12.0_f64.sqrt() * (x - 0.5);
                film.add(pixel, sample, [y, y, y, 1.0]);
                film.costs[tile].rays += rays(tile);
            }
        }
        film
    }

    fn goals(film: &Film, round: Round) -> Vec<u32> {
        next_goals(film, &[16; 36], round)
    }

    const ROUND: Round = Round {
        growth: [1.02, 1.25],
        noise: None,
        samples_max: u32::MAX,
        region: None,
    };

    #[test]
    fn samples_go_where_they_help_most() {
        // Columns of tiles: exact, noisy, noisy at four times the cost.
        let sigma = |tile: usize| if tile % 6 < 2 { 0.0 } else { 0.4 };
        let rays = |tile: usize| if tile % 6 < 4 { 1.0 } else { 4.0 };
        let film = film(&sigma, &rays);
        let found = goals(&film, ROUND);
        let total: u32 = found.iter().sum();
        assert!((36 * 16 * 5 / 4..36 * 16 * 4 / 3).contains(&total), "{found:?}");
        for row in found.chunks(6) {
            assert_eq!(row[0], 16, "no error, nor beside it: {row:?}");
            assert!(row[2] >= 24 && row[5] <= 20, "{row:?}");
        }
        // Far from the aim a tile at most doubles; near it only little is asked for.
        let far = goals(
            &film,
            Round {
                growth: [1.02, 1e3],
                noise: Some(1e-4),
                ..ROUND
            },
        );
        assert!(far.iter().all(|goal| *goal <= 32), "{far:?}");
        assert!(far.iter().sum::<u32>() > 36 * 16 * 3 / 2, "{far:?}");
        let estimate = crate::analysis::noise::noise(&film).unwrap().relative;
        let near = goals(
            &film,
            Round {
                growth: [1.02, 1e3],
                noise: Some(0.98 * estimate),
                ..ROUND
            },
        );
        assert!(near.iter().sum::<u32>() < 36 * 16 * 11 / 10, "{near:?}");
        let capped = goals(
            &film,
            Round {
                samples_max: 20,
                ..ROUND
            },
        );
        assert!(
            capped.iter().all(|goal| (16..=20).contains(goal)) && capped.contains(&20),
            "{capped:?}"
        );
    }

    #[test]
    fn the_surroundings_of_a_small_bright_feature_do_not_starve() {
        let hot = 14;
        let film = film(&|tile| if tile == hot { 2.0 } else { 0.001 }, &|_| 1.0);
        let grid = TileGrid {
            width: SIDE,
            height: SIDE,
        };
        // Rounds on end, as if the film stayed as it is but for the number of samples.
        let mut samples = vec![16; 36];
        for _ in 0..30 {
            samples = next_goals(&film, &samples, ROUND);
        }
        let most = samples[hot];
        assert!(most > 1000, "{samples:?}");
        for tile in 0..36 {
            let is_near = grid.around(hot).any(|near| near == tile);
            let least = if is_near { 2 } else { 400 };
            assert!(samples[tile] >= (most / least).max(16), "tile {tile}: {samples:?}");
        }
    }
}
