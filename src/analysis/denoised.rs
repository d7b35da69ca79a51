//! Error estimate of a denoised image, from the samples that it was made of.
//!
//! The two halves A and B of a film's samples are independent. Each is denoised separately, to D and E; the denoised image
//! is their mean M = (D + E)/2. With T the truth, let a = A − T, d = D − T and so on:
//!
//! - (D − A)(E − B) = de + ab − db − ea. All terms but de have expectation 0, because the halves are independent. The rest
//!   is the square of the filter's bias.
//! - (D − E)²/4 = (d² + e²)/4 − de/2 is known without noise.
//!
//! Their sum is ((d + e)/2)² = (M − T)², the squared error of this very image, bias included, plus noise of mean 0: ab − db
//! − ea. Likewise (A − B)²/4 estimates the squared error of the samples' mean X, and (D − E)(A − B)/4 the product of both
//! errors. The three give the blend of M and X with the least error. See docs/MATHEMATICS.md, section 8.

mod moments;

use std::ops::Range;

use moments::Moments;

use super::halves::Distance;
use super::noise::{BAND, MAP_RADIUS, bands, box_sums};
use crate::{
    job::film::luminance,
    job::tiles::{TILE_SIDE, TileGrid},
    parallel,
};

/// Radius in tiles over which a tile's errors are averaged to choose its blend.
const RADIUS: usize = 2;

/// Kurtosis of the difference of two denoised pixels. The filter averages, so their noise is near to normal.
const KURTOSIS: f64 = 3.0;
/// Radius in pixels within which the denoised halves' noise is taken as correlated.
const CORRELATED_RADIUS: i32 = 4;
/// Number of rows from which the correlation is estimated.
const CORRELATED_ROWS: usize = 256;

/// A linear RGB image, row by row.
pub type Colors = Vec<[f32; 3]>;

/// Two independent halves of a render, and each of them denoised.
#[derive(Clone, Copy, Debug)]
pub struct DenoisedHalves<'a> {
    /// The means of the halves' samples.
    pub noisy: [&'a [[f32; 3]]; 2],
    pub denoised: [&'a [[f32; 3]]; 2],
    /// Width of the images in pixels.
    pub width: usize,
}

/// A, B, D and E of a pixel.
type Luminances = [f32; 4];

/// Differences of a pixel's luminances.
struct Differences {
    /// A − D and B − E.
    noisy: [f64; 2],
    /// A − B and D − E.
    between: [f64; 2],
}

impl Differences {
    fn of(luminances: Luminances) -> Self {
        let [a, b, d, e] = luminances.map(f64::from);
        Self {
            noisy: [a - d, b - e],
            between: [a - b, d - e],
        }
    }

    /// Estimates the square of the filter's bias.
    fn squared_bias(&self) -> f64 {
        self.noisy[0] * self.noisy[1]
    }

    /// An estimate of mean 0 that for normal noise has the variance of [`Self::squared_bias`].
    fn square(&self) -> f64 {
        (self.noisy[0] + self.noisy[1]) * (self.noisy[0] - self.noisy[1]) / 2.0
    }
}

/// Error estimates of a denoised image.
#[derive(Clone, Debug)]
pub struct Errors {
    luminances: Vec<Luminances>,
    /// Variance of each pixel's estimated squared error, from its neighbourhood.
    variances: Vec<f64>,
    /// See [`correlation`].
    correlation: f64,
    grid: TileGrid,
    mean_luminance: f64,
}

impl Errors {
    /// The estimates from two halves.
    pub fn of(halves: &DenoisedHalves<'_>) -> Self {
        let bright = |color: [f32; 3]| luminance(color.map(f64::from)) as f32;
        let [[a, b], [d, e]] = [halves.noisy, halves.denoised];
        let of_pixel = |i: usize| [a[i], b[i], d[i], e[i]].map(bright);
        let luminances: Vec<_> = parallel::map(a.len(), of_pixel);
        let denoised = luminances.iter().map(|[_, _, d, e]| f64::from(*d) + f64::from(*e));
        let grid = TileGrid {
            width: halves.width as u32,
            height: (a.len() / halves.width.max(1)) as u32,
        };
        Self {
            mean_luminance: denoised.sum::<f64>() / (2 * a.len()).max(1) as f64,
            variances: parallel::map_into(bands(grid), |rows| variances(&luminances, halves.width, rows)).concat(),
            correlation: correlation(&luminances, halves.width),
            luminances,
            grid,
        }
    }

    fn moments(&self, pixel: usize) -> Moments {
        let of_pixel = Differences::of(self.luminances[pixel]);
        let [noise, clean] = of_pixel.between;
        let known = clean * clean / 4.0;
        Moments {
            denoised: of_pixel.squared_bias() + known,
            known,
            noisy: noise * noise / 4.0,
            product: clean * noise / 4.0,
            variance: self.variances[pixel],
            by_squares: of_pixel.square(),
            by_pixels: self.correlation * squared_variance(known),
            fourth_powers: 0.0,
            difference: ((of_pixel.noisy[0] + of_pixel.noisy[1]) / 2.0).powi(2),
            pixels: 1.0,
        }
    }

    /// Per pixel the share in [0, 1] of the samples' mean in the blend of least error. Chosen per tile and interpolated, so
    /// that there are no seams.
    pub fn shares(&self) -> Vec<f32> {
        let tiles = self.around_tiles(RADIUS);
        let of_tiles: Vec<f64> = tiles.iter().map(Moments::share).collect();
        interpolated(self.grid, &of_tiles)
    }

    /// Estimated error of the blend with these shares, bias included, relative to the mean luminance; `None` is the denoised
    /// image itself.
    pub fn error(&self, shares: Option<&[f32]>) -> Distance {
        let sum = self.sum(shares, |moments, denoised, samples| {
            let rest = 2.0 * samples * denoised * moments.product + samples * samples * moments.noisy;
            (
                denoised * denoised * moments.denoised + rest,
                denoised * denoised * moments.known + rest,
            )
        });
        self.distance(&sum)
    }

    /// The filter's bias as part of that error: the error that would remain in the mean of many renders, each denoised.
    pub fn bias(&self, shares: Option<&[f32]>) -> Distance {
        let sum = self.sum(shares, |moments, denoised, _| {
            (denoised * denoised * (moments.denoised - moments.known), 0.0)
        });
        self.distance(&sum)
    }

    /// Sums over all pixels. `squares` returns a squared error and its certain part from the shares of the denoised image
    /// and of the samples' mean.
    fn sum(&self, shares: Option<&[f32]>, squares: impl Fn(&Moments, f64, f64) -> (f64, f64)) -> Moments {
        let of_pixel = |pixel: usize| {
            let moments = self.moments(pixel);
            let samples = shares.map_or(0.0, |shares| f64::from(shares[pixel]));
            let clean = 1.0 - samples;
            let (denoised, known) = squares(&moments, clean, samples);
            let spread = clean.powi(4) + samples.powi(4);
            // A quarter of the squared difference of the blend's halves.
            let apart = clean * clean * moments.known
                + 2.0 * clean * samples * moments.product
                + samples * samples * moments.noisy;
            Moments {
                denoised,
                known,
                variance: spread * moments.variance,
                by_squares: spread.sqrt() * moments.by_squares,
                by_pixels: self.correlation * squared_variance(apart),
                ..moments
            }
        };
        let mut sum = Moments::default();
        for tile in self.of_tiles(of_pixel) {
            sum += tile;
        }
        sum
    }

    /// Sums over the pixels of each tile. The squares are summed first and squared then, because pixels of a tile share
    /// noise.
    fn of_tiles(&self, of_pixel: impl Fn(usize) -> Moments) -> Vec<Moments> {
        let mut tiles = vec![Moments::default(); self.grid.tiles()];
        for pixel in 0..self.luminances.len() {
            tiles[self.grid.of_pixel(pixel)] += of_pixel(pixel);
        }
        for tile in &mut tiles {
            tile.by_squares *= tile.by_squares;
            tile.fourth_powers = tile.by_squares * tile.by_squares;
        }
        tiles
    }

    fn distance(&self, sum: &Moments) -> Distance {
        let relative = |squared: f64| {
            let scale = self.mean_luminance.max(f64::MIN_POSITIVE);
            (squared.max(0.0) / sum.pixels.max(1.0)).sqrt() / scale
        };
        let band = sum.band_factor() * sum.deviation();
        // The squared bias is at least 0, but de of this very image has either sign.
        let luck = BAND * sum.by_pixels.sqrt();
        Distance {
            value: relative(sum.denoised()),
            low: relative((sum.denoised - band).max(sum.known - luck)),
            high: relative((sum.denoised + band).max(sum.known + luck)),
        }
    }

    /// Estimated error per pixel of the blend with these shares, relative to the mean luminance: for a map.
    pub fn map(&self, shares: Option<&[f32]>) -> Vec<f32> {
        let tiles = self.around_tiles(1);
        let squared: Vec<f64> = tiles
            .iter()
            .map(|tile| tile.denoised().max(0.0) / tile.pixels.max(1.0))
            .collect();
        let noisy: Vec<f64> = tiles.iter().map(|tile| tile.noisy / tile.pixels.max(1.0)).collect();
        let (denoised, noisy) = (interpolated(self.grid, &squared), interpolated(self.grid, &noisy));
        let error = |pixel: usize| {
            let share = shares.map_or(0.0, |shares| shares[pixel]);
            let squared = (1.0 - share).powi(2) * denoised[pixel] + share * share * noisy[pixel];
            (f64::from(squared).sqrt() / self.mean_luminance.max(f64::MIN_POSITIVE)) as f32
        };
        (0..self.luminances.len()).map(error).collect()
    }

    /// Sums over the tiles within `radius` of each tile.
    fn around_tiles(&self, radius: usize) -> Vec<Moments> {
        let tiles = self.of_tiles(|pixel| self.moments(pixel));
        let around = |tile: usize| {
            let mut sum = Moments::default();
            for other in tiles_around(self.grid, tile, radius) {
                sum += tiles[other];
            }
            sum
        };
        (0..tiles.len()).map(around).collect()
    }
}

/// The square of a half's variance, from a quarter of the squared difference of the halves.
fn squared_variance(apart: f64) -> f64 {
    (2.0 * apart).powi(2) / KURTOSIS
}

/// Sum of the squared correlations between the denoised noise of a pixel and that of each pixel around it, itself included:
/// at least 1. The variance of a sum of de over pixels is so many times the sum of their variances, because d and e are
/// independent and equally correlated.
///
/// A correlation is estimated by products of D − E at two pixels. Its square is taken over pairs of different products, which
/// leaves out the noise of each.
fn correlation(luminances: &[Luminances], width: usize) -> f64 {
    let noise: Vec<f64> = luminances
        .iter()
        .map(|pixel| Differences::of(*pixel).between[1])
        .collect();
    let height = noise.len() / width.max(1);
    let step = height.div_ceil(CORRELATED_ROWS).max(1);
    let rows = || (0..height).step_by(step);
    let variance: f64 = rows()
        .flat_map(|y| &noise[y * width..(y + 1) * width])
        .map(|value| value * value)
        .sum();
    let squared = |(x, y): (i32, i32)| {
        let [left, right] = [(-x).max(0), x.max(0)].map(|shift| (shift as usize).min(width));
        let (mut sum, mut squares) = (0.0, 0.0);
        for row in rows().take_while(|row| row + (y as usize) < height) {
            let from = &noise[row * width + left..(row + 1) * width - right];
            let below = (row + y as usize) * width;
            let to = &noise[below + right..below + width - left];
            for product in std::iter::zip(from, to).map(|(a, b)| a * b) {
                sum += product;
                squares += product * product;
            }
        }
        sum * sum - squares
    };
    // One of each pair of opposite neighbours.
    let around = -CORRELATED_RADIUS..=CORRELATED_RADIUS;
    let places = (0..=CORRELATED_RADIUS).flat_map(|y| around.clone().map(move |x| (x, y)));
    let places: Vec<_> = places.filter(|&(x, y)| y > 0 || x > 0).collect();
    let sum: f64 = parallel::map_into(places, squared).into_iter().sum();
    let correlation = 1.0 + 2.0 * sum / (variance * variance);
    if correlation.is_finite() {
        correlation.max(1.0)
    } else {
        1.0
    }
}

/// Indices of the tiles within `radius` of a tile, itself included.
fn tiles_around(grid: TileGrid, tile: usize, radius: usize) -> impl Iterator<Item = usize> {
    let (columns, rows) = (grid.columns(), grid.rows());
    let (x, y) = (tile % columns, tile / columns);
    let near = move |at: usize, count: usize| at.saturating_sub(radius)..(at + radius + 1).min(count);
    near(y, rows).flat_map(move |y| near(x, columns).map(move |x| y * columns + x))
}

/// Variances of the estimated squared errors of some rows' pixels, from their neighbourhoods.
///
/// The estimate's noise is ab − db − ea = (a − d)(b − e) − de. As the halves are independent, its variance is E(a − d)² E(b
/// − e)² − 2 E(a − d)d E(b − e)e + Ed² Ee². Let d = β + δ, with the filter's bias β and the residual noise δ. Means of (A −
/// D)(E − B), (D − E)²/2 and (A − B)(D − E)/2 around the pixel estimate β², Eδ² and Eaδ.
///
/// The filter spreads a pixel's noise to its neighbours, so that db of one and ea of another are correlated: the sum over
/// the others of 2 E(ad') E(be'). If the filter is locally linear with weights w (δ = Σ wa) and the noise locally uniform,
/// that is 2 σ⁴ Σ w² without the pixel itself: 2 (Eδ² σ² − (Eaδ)²), with σ² estimated by (A − B)²/2.
fn variances(luminances: &[Luminances], width: usize, rows: Range<usize>) -> Vec<f64> {
    let height = luminances.len() / width.max(1);
    let first = rows.start.saturating_sub(MAP_RADIUS);
    let last = (rows.end + MAP_RADIUS).min(height);
    let differences: Vec<_> = luminances[first * width..last * width]
        .iter()
        .map(|pixel| Differences::of(*pixel))
        .collect();
    let around = |of: &dyn Fn(&Differences) -> f64| -> Vec<f64> {
        let values: Vec<f64> = differences.iter().map(of).collect();
        let sums = box_sums(&values, width, MAP_RADIUS);
        sums.into_iter().map(|[sum, count]| sum / count).collect()
    };
    let noise = [0, 1].map(|half| around(&|of| of.noisy[half] * of.noisy[half]));
    let bias = around(&Differences::squared_bias);
    let left = around(&|of| of.between[1] * of.between[1] / 2.0);
    let common = around(&|of| of.between[0] * of.between[1] / 2.0);
    let whole = around(&|of| of.between[0] * of.between[0] / 2.0);
    let of_pixel = move |i: usize| {
        let bias = bias[i].max(0.0);
        let own = bias + left[i];
        let alone = noise[0][i] * noise[1][i] - 2.0 * (common[i] - own).powi(2) + own * own;
        let shared = 2.0 * (left[i] * whole[i] - common[i].powi(2));
        alone.max(0.0) + shared.max(0.0)
    };
    ((rows.start - first) * width..(rows.end - first) * width)
        .map(of_pixel)
        .collect()
}

/// Interpolates tile values bilinearly between the tiles' centres.
fn interpolated(grid: TileGrid, tiles: &[f64]) -> Vec<f32> {
    let (columns, rows) = (grid.columns(), grid.rows());
    let place = |pixel: u32, count: usize| {
        let x = ((f64::from(pixel) + 0.5) / f64::from(TILE_SIDE) - 0.5).clamp(0.0, (count - 1) as f64);
        (x as usize, (x as usize + 1).min(count - 1), x.fract())
    };
    let of_row = |y: u32| {
        let (top, bottom, down) = place(y, rows);
        (0..grid.width).map(move |x| {
            let (left, right, across) = place(x, columns);
            let between = |row: usize| {
                let (left, right) = (tiles[row * columns + left], tiles[row * columns + right]);
                left + across * (right - left)
            };
            (between(top) + down * (between(bottom) - between(top))) as f32
        })
    };
    (0..grid.height).flat_map(of_row).collect()
}
