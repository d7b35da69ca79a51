//! Error estimate of a render, from its own sums.
//!
//! The samples of a pixel come in two independent halves, for every sequence ([`crate::optics::random::path_state`]). With
//! the errors a and b of the halves' means, ((a − b)/2)² estimates the pixel's squared error ((a + b)/2)² without bias: they
//! differ by −ab, of expectation 0. Summed over the pixels this is precise, and the spread of the sum of ab gives the
//! interval. The spread of the samples, as if they were independent, is the cross-check: it agrees for uniform random numbers
//! and overestimates the error of the Sobol sequence. See docs/MATHEMATICS.md, section 8.

use std::ops::Range;

use crate::job::film::{Film, HalfSums};
use crate::job::tiles::TileGrid;
use crate::parallel;

/// Half width of a normal distribution's 95 % interval, in standard deviations.
pub(super) const BAND: f64 = 1.959_964;
/// Share of the pixels that must have samples in both halves.
const MEASURED_SHARE: f64 = 0.99;
/// Kurtosis of a pixel's half difference for skewed samples: between a normal distribution's 3 and the 6 of the difference
/// of two exponential ones.
pub(super) const KURTOSIS: f64 = 4.5;
/// Radius in pixels over which the sequence's gain is averaged for a map.
pub(super) const MAP_RADIUS: usize = 3;

/// The estimated error of a render.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Noise {
    /// Relative error: root mean square over the pixels of the standard error of luminance, over the mean luminance.
    pub relative: f64,
    /// Lower end of the 95 % interval of the true relative error of this very image.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
    /// Relative error by the samples' spread, as if they were independent: the cross-check.
    pub from_spread: f64,
    /// Mean luminance of the image.
    pub mean_luminance: f64,
}

/// Variance of a pixel's mean luminance from the difference of its halves: unbiased, with one degree of freedom. NaN if a
/// half has no sample.
pub fn half_difference_variance([even, odd]: &[HalfSums; 2]) -> f64 {
    if odd.samples < 1.0 || even.samples < 1.0 {
        return f64::NAN;
    }
    let difference = even.luminance() / even.samples - odd.luminance() / odd.samples;
    difference * difference * even.samples * odd.samples / (even.samples + odd.samples).powi(2)
}

/// The relative error of a render; `None` without samples in both halves. A black image has no error.
pub fn noise(film: &Film) -> Option<Noise> {
    let bands = parallel::map_into(bands(film.grid()), |rows| Sums::of(&Band::of(film, rows)));
    let sums = bands.iter().fold(Sums::default(), Sums::with);
    let pixels = film.pixel_count() as f64;
    if sums.measured < MEASURED_SHARE * pixels || pixels == 0.0 {
        return None;
    }
    let mean_luminance = sums.luminance / pixels;
    let relative = |sum: f64| {
        if sum > 0.0 {
            (sum / sums.measured).sqrt() / mean_luminance
        } else {
            0.0
        }
    };
    let freedom = (sums.variance * sums.variance / sums.squared_variance()).max(2.0);
    let factor = (BAND / (freedom - 1.0).sqrt()).exp();
    let value = relative(sums.variance);
    Some(Noise {
        relative: value,
        low: value / factor,
        high: value * factor,
        from_spread: relative(sums.spread),
        mean_luminance,
    })
}

/// Some rows of an image. Images are processed in bands to bound memory.
struct Band<'a> {
    film: &'a Film,
    /// The pixels of the band.
    pixels: Range<usize>,
    /// Per pixel: variance of its mean by the half difference; windowed sum and count of these; variance of its mean by the
    /// samples' spread.
    halves: Vec<f64>,
    around: Vec<[f64; 2]>,
    spread: Vec<f64>,
    /// Gain of the sequence around each pixel: variance by the half differences over that by the samples' spread. 1 for
    /// uniform random numbers, below for better sequences, 0 without spread.
    gains: Vec<f64>,
}

/// Rows of a band.
const BAND_ROWS: usize = 64;

/// The row ranges of an image's bands.
pub(super) fn bands(grid: TileGrid) -> Vec<Range<usize>> {
    let height = if grid.width == 0 { 0 } else { grid.height as usize };
    let band = |first: usize| first..(first + BAND_ROWS).min(height);
    (0..height).step_by(BAND_ROWS).map(band).collect()
}

impl<'a> Band<'a> {
    fn of(film: &'a Film, rows: Range<usize>) -> Self {
        let width = film.width as usize;
        // With the rows above and below that windowed means need.
        let first = rows.start.saturating_sub(MAP_RADIUS);
        let last = (rows.end + MAP_RADIUS).min(film.height as usize);
        let wider = || first * width..last * width;
        let halves: Vec<f64> = wider()
            .map(|pixel| half_difference_variance(&film.halves(pixel)))
            .collect();
        let spread: Vec<f64> = wider()
            .map(|pixel| finite_or_nan(film.variance_of_mean_at(pixel)))
            .collect();
        let own = (rows.start - first) * width..(rows.end - first) * width;
        let sums = |values: &[f64]| box_sums(values, width, MAP_RADIUS)[own.clone()].to_vec();
        let (around, spread_around) = (sums(&halves), sums(&spread));
        let gain = |(halves, spread): (&[f64; 2], &[f64; 2])| {
            if spread[0] > 0.0 { halves[0] / spread[0] } else { 0.0 }
        };
        Self {
            film,
            pixels: rows.start * width..rows.end * width,
            gains: around.iter().zip(&spread_around).map(gain).collect(),
            around,
            halves: halves[own.clone()].to_vec(),
            spread: spread[own].to_vec(),
        }
    }

    /// Expectation of a pixel's squared variance. The product of the two halves' own spreads is unbiased, as the halves are
    /// independent; the sequence's gain around the pixel converts it to variances of means.
    fn squared_variance(&self, place: usize) -> f64 {
        let [even, odd] = self.film.halves(self.pixels.start + place);
        if even.samples < 2.0 || odd.samples < 2.0 {
            // Too few for spreads: a normal distribution's fourth moment is three times its squared variance.
            let variance = self.halves[place];
            return if variance.is_nan() { 0.0 } else { variance.powi(2) / 3.0 };
        }
        even.spread() * odd.spread() * (self.gains[place] / (even.samples + odd.samples)).powi(2)
    }
}

/// Sums over the pixels of an image.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    /// Number of pixels with samples in both halves.
    measured: f64,
    luminance: f64,
    /// Variances by the halves' differences, and by the samples' spread.
    variance: f64,
    spread: f64,
    /// Squared variances in three ways, see [`Sums::squared_variance`].
    of_pixels: f64,
    of_neighbours: f64,
    of_differences: f64,
}

impl Sums {
    fn of(band: &Band<'_>) -> Self {
        let places = || 0..band.pixels.len();
        Self {
            measured: band.halves.iter().filter(|variance| !variance.is_nan()).count() as f64,
            luminance: finite_sum(band.pixels.clone().map(|pixel| band.film.luminance_of(pixel))),
            variance: finite_sum(band.halves.iter().copied()),
            spread: finite_sum(band.spread.iter().copied()),
            of_pixels: places().map(|place| band.squared_variance(place)).sum(),
            of_neighbours: band
                .around
                .iter()
                .map(|[sum, count]| (sum / count.max(1.0)).powi(2))
                .sum(),
            of_differences: finite_sum(band.halves.iter().map(|variance| variance * variance / KURTOSIS)),
        }
    }

    fn with(self, other: &Self) -> Self {
        Self {
            measured: self.measured + other.measured,
            luminance: self.luminance + other.luminance,
            variance: self.variance + other.variance,
            spread: self.spread + other.spread,
            of_pixels: self.of_pixels + other.of_pixels,
            of_neighbours: self.of_neighbours + other.of_neighbours,
            of_differences: self.of_differences + other.of_differences,
        }
    }

    /// Σ V² over the pixels, from their own spreads. With rare bright samples this is almost always an underestimate. So
    /// there are two lower bounds. The windowed means include the neighbours' samples. The half differences over their
    /// kurtosis respond to rare bright samples of a few pixels.
    fn squared_variance(&self) -> f64 {
        let sums = [self.of_pixels, self.of_neighbours, self.of_differences];
        sums.into_iter().fold(f64::MIN_POSITIVE, f64::max)
    }
}

/// Per pixel the sum and count of the values in the square window around it; NaN counts as missing.
pub(super) fn box_sums(values: &[f64], width: usize, radius: usize) -> Vec<[f64; 2]> {
    let width = width.max(1);
    let entry = |value: &f64| if value.is_nan() { [0.0; 2] } else { [*value, 1.0] };
    let mut across = vec![[0.0; 2]; values.len()];
    parallel::for_rows(&mut across, width, |y, sums| {
        let row: Vec<[f64; 2]> = values[y * width..][..width].iter().map(entry).collect();
        for left in (1..=radius.min(width)).rev() {
            add_each(&mut sums[left..], &row);
        }
        for right in 0..=radius.min(width) {
            add_each(sums, &row[right..]);
        }
    });
    let mut around = vec![[0.0; 2]; values.len()];
    let height = values.len() / width;
    parallel::for_rows(&mut around, width, |y, sums| {
        let rows = y.saturating_sub(radius) * width..(y + radius + 1).min(height) * width;
        for row in across[rows].chunks_exact(width) {
            add_each(sums, row);
        }
    });
    around
}

/// Adds entries to sums by index, as far as both exist.
fn add_each(sums: &mut [[f64; 2]], entries: &[[f64; 2]]) {
    for (sum, entry) in sums.iter_mut().zip(entries) {
        *sum = [sum[0] + entry[0], sum[1] + entry[1]];
    }
}

/// Standard error of each pixel's luminance, relative to the image's mean: their root mean square is about the image's
/// relative error. From the samples' spread times the sequence's gain around the pixel; 0 if unknown.
pub fn relative_errors(film: &Film) -> Vec<f32> {
    let pixels = film.pixel_count();
    let mean = finite_sum((0..pixels).map(|pixel| film.luminance_of(pixel))) / pixels.max(1) as f64;
    let error = move |(variance, gain): (f64, f64)| {
        let error = (variance * gain).sqrt() / mean;
        if error.is_finite() { error as f32 } else { 0.0 }
    };
    let of_band = |rows| {
        let band = Band::of(film, rows);
        band.spread.into_iter().zip(band.gains).map(error).collect::<Vec<f32>>()
    };
    parallel::map_into(bands(film.grid()), of_band).concat()
}

/// Sum of the finite values.
pub(super) fn finite_sum(values: impl Iterator<Item = f64>) -> f64 {
    values.filter(|value| value.is_finite()).sum()
}

fn finite_or_nan(value: f64) -> f64 {
    if value.is_finite() { value } else { f64::NAN }
}

/// Error estimate of a tile.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TileError {
    /// Variance of a pixel's luminance for one sample, as the sequence gains: of the mean, times the samples.
    pub sample_variance: f64,
    /// Rays of one sample.
    pub rays: f64,
}

/// Error estimates of all tiles. A tile's own spread is precise; the sequence's gain is averaged over its neighbours.
pub fn tile_errors(film: &Film) -> Vec<TileError> {
    let grid = film.grid();
    let sums = parallel::map(grid.tiles(), |tile| TileSums::of(film, tile));
    let of_tile = |tile: usize| {
        let TileSums {
            spread,
            samples,
            pixels,
            ..
        } = sums[tile];
        let around = grid.around(tile).fold([0.0; 2], |[spread, halves], near| {
            [spread + sums[near].spread, halves + sums[near].halves]
        });
        let gain = if around[0] > 0.0 { around[1] / around[0] } else { 0.0 };
        TileError {
            sample_variance: gain * spread / f64::max(pixels, 1.0),
            rays: film.costs[tile].rays / f64::max(samples, 1.0),
        }
    };
    (0..grid.tiles()).map(of_tile).collect()
}

/// Sums over the pixels of a tile.
#[derive(Clone, Copy, Default)]
struct TileSums {
    samples: f64,
    /// Number of pixels with a known error, and their variances by the samples' spread and by the half differences, for one
    /// sample each.
    pixels: f64,
    spread: f64,
    halves: f64,
}

impl TileSums {
    fn of(film: &Film, tile: usize) -> Self {
        let mut sums = Self::default();
        for pixel in film.grid().pixels_of(tile) {
            let n = film.samples_of(pixel);
            let (halves, spread) = (
                half_difference_variance(&film.halves(pixel)),
                film.variance_of_mean_at(pixel),
            );
            sums.samples += n;
            if halves.is_finite() && spread.is_finite() {
                sums.spread += spread * n;
                sums.halves += halves * n;
                sums.pixels += 1.0;
            }
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::random::{Sequence, random_pair, random_state};

    /// Five tiles.
    const SIDE: u32 = 40;

    /// A film of independent samples, `deviation(pixel, ξ)` of mean 0 away from 1; and the true squared error of its
    /// pixels' means, summed.
    fn film_of(samples: u32, seed: u32, deviation: impl Fn(usize, f64) -> f64) -> (Film, f64) {
        let mut film = Film::new(SIDE, SIDE);
        let mut squared_error = 0.0;
        for pixel in 0..(SIDE * SIDE) as usize {
            let mut sum = 0.0;
            for sample in 0..samples {
                let state = random_state(pixel as u32, 0, seed, sample, Sequence::Independent);
                let [xi, _]: [f64; 2] = random_pair(state, 0);
                let x = deviation(pixel, xi);
                film.add(pixel, sample, [1.0 + x, 1.0 + x, 1.0 + x, 1.0]);
                let tile = film.grid().of_pixel(pixel);
                film.costs[tile].rays += 1.0;
                sum += x;
            }
            squared_error += (sum / f64::from(samples)).powi(2);
        }
        (film, squared_error)
    }

    /// Uniform numbers of standard deviation 0 left of the middle and `sigma` right of it.
    fn film(samples: u32, seed: u32, sigma: f64) -> (Film, f64) {
        film_of(samples, seed, |pixel, xi| {
            let is_noisy = pixel as u32 % SIDE >= SIDE / 2;
            if is_noisy {
                sigma * 12.0_f64.sqrt() * (xi - 0.5)
            } else {
                0.0
            }
        })
    }

    #[test]
    fn squares_are_cut_at_the_edges_and_what_is_missing_does_not_count() {
        // Rows of five.
        let mut values: Vec<f64> = (0..20).map(|i| f64::from(1 << i)).collect();
        values[7] = f64::NAN;
        let bits = |places: &[u32]| f64::from(places.iter().map(|place| 1_u32 << place).sum::<u32>());
        let sums = box_sums(&values, 5, 1);
        assert_eq!(sums[0], [bits(&[0, 1, 5, 6]), 4.0]);
        assert_eq!(sums[12], [bits(&[6, 8, 11, 12, 13, 16, 17, 18]), 8.0]);
        assert_eq!(sums[19], [bits(&[13, 14, 18, 19]), 4.0]);
        let all: Vec<u32> = (0..20).filter(|place| *place != 7).collect();
        assert_eq!(box_sums(&values, 5, 9), vec![[bits(&all), 19.0]; 20]);
        assert_eq!(box_sums(&values, 5, 0)[7], [0.0; 2]);
    }

    #[test]
    fn the_band_of_rare_bright_samples_is_wide_enough() {
        // Of 100 samples one is bright: most pixels of 16 samples have none.
        let deviation = |_, xi: f64| if xi < 0.01 { 99.0 } else { -1.0 };
        let inside = (0..60).filter(|seed| {
            let (film, squared_error) = film_of(16, *seed, deviation);
            let mean = film.luminance().iter().sum::<f64>() / f64::from(SIDE * SIDE);
            let error = (squared_error / f64::from(SIDE * SIDE)).sqrt() / mean;
            let found = noise(&film).unwrap();
            (found.low..=found.high).contains(&error)
        });
        let inside = inside.count();
        assert!((53..=60).contains(&inside), "{inside} of 60");
    }

    #[test]
    fn the_error_of_known_noise() {
        let mut inside = 0;
        for seed in 0..60 {
            let samples = 10 + seed % 7;
            let (film, squared_error) = film(samples, seed, 0.3);
            let found = noise(&film).unwrap();
            let expected = 0.3 / f64::from(2 * samples).sqrt();
            assert!((found.relative / expected - 1.0).abs() < 0.12, "{found:?} {expected}");
            assert!(
                (found.from_spread / expected - 1.0).abs() < 0.05,
                "{found:?} {expected}"
            );
            let error = (squared_error / f64::from(SIDE * SIDE)).sqrt();
            inside += usize::from((found.low..=found.high).contains(&error));
        }
        assert!((53..=60).contains(&inside), "{inside} of 60");
    }

    #[test]
    fn halves_that_agree_better_than_their_spread_are_believed() {
        // Each half holds the same values: as if a sequence had removed all error but that of one number.
        let mut film = Film::new(SIDE, SIDE);
        for pixel in 0..(SIDE * SIDE) as usize {
            (0..8).for_each(|sample| {
                let y = f64::from(sample / 2);
                film.add(pixel, sample, [y, y, y, 1.0]);
            });
        }
        let found = noise(&film).unwrap();
        assert!(found.relative < 1e-12 && found.from_spread > 0.2, "{found:?}");
    }

    #[test]
    fn no_error_is_told_before_there_are_two_halves_and_none_is_found_where_there_is_no_light() {
        assert_eq!(noise(&film(1, 0, 0.3).0), None);
        assert_eq!(noise(&Film::new(0, 0)), None);
        assert_eq!(noise(&Film::new(4, 4)), None);
        let mut black = Film::new(4, 4);
        (0..16).for_each(|pixel| (0..2).for_each(|sample| black.add(pixel, sample, [0.0; 4])));
        let found = noise(&black).unwrap();
        assert_eq!((found.relative, found.low, found.high), (0.0, 0.0, 0.0));
        assert!(relative_errors(&black).iter().all(|error| *error == 0.0));
    }

    #[test]
    fn maps_and_tiles_show_where_the_error_is() {
        let (film, _) = film(64, 5, 0.3);
        let errors = relative_errors(&film);
        let squares: f64 = errors.iter().map(|error| f64::from(*error).powi(2)).sum();
        let estimate = noise(&film).unwrap().relative;
        let of_map = (squares / f64::from(SIDE * SIDE)).sqrt();
        assert!((of_map / estimate - 1.0).abs() < 0.1, "{of_map} {estimate}");
        assert!(errors.iter().step_by(SIDE as usize).all(|error| *error < 1e-6));
        let tiles = tile_errors(&film);
        // The tiles in the middle column are half noisy.
        for row in tiles.chunks(5) {
            let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 0.25;
            assert!(row[0].sample_variance < 1e-9 && row[0].rays == 1.0, "{row:?}");
            assert!(
                near(row[2].sample_variance, 0.045) && near(row[3].sample_variance, 0.09),
                "{row:?}"
            );
        }
    }
}
