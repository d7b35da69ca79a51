//! Error estimate of a render, from its own sums.
//!
//! The samples of a pixel come in two independent halves, for every sequence ([`crate::optics::random::path_state`]). With
//! the errors a and b of the halves' means, ((a − b)/2)² estimates the pixel's squared error ((a + b)/2)² without bias: they
//! differ by −ab, of expectation 0. Summed over the pixels this is precise, and the spread of the sum of ab gives the
//! interval. The spread of the samples, as if they were independent, is the cross-check: it agrees for uniform random numbers
//! and overestimates the error of the Sobol sequence. See docs/MATHEMATICS.md, section 8.

use std::ops::Range;

use crate::{
    job::film::{Film, HalfSums},
    job::tiles::TileGrid,
    parallel,
};

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
    let pixels = film.pixel_count() as f64;
    let has_both = |halves: &&[HalfSums; 2]| halves.iter().all(|half| half.samples >= 1.0);
    let measurable = film.pixels.iter().filter(has_both).count() as f64;
    if measurable < MEASURED_SHARE * pixels || pixels == 0.0 {
        return None;
    }
    let bands = parallel::map_into(bands(film.grid()), |rows| Sums::of(&Band::of(film, rows)));
    let mut sums = Sums::default();
    bands.into_iter().for_each(|band| sums += band);
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
            .map(|pixel| half_difference_variance(&film.pixels[pixel]))
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
        let [even, odd] = self.film.pixels[self.pixels.start + place];
        if even.samples < 2.0 || odd.samples < 2.0 {
            // Too few for spreads: a normal distribution's fourth moment is three times its squared variance.
            let variance = self.halves[place];
            return if variance.is_nan() { 0.0 } else { variance.powi(2) / 3.0 };
        }
        even.spread() * odd.spread() * (self.gains[place] / (even.samples + odd.samples)).powi(2)
    }
}

/// Declares numbers that are summed each by itself.
macro_rules! sums {
    ($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub(super) struct $name {
            $($(#[$field_doc])* pub(super) $field: f64,)*
        }

        impl std::ops::AddAssign for $name {
            fn add_assign(&mut self, other: Self) {
                $(self.$field += other.$field;)*
            }
        }
    };
}
pub(super) use sums;

sums! {
    /// Sums over the pixels of an image.
    Sums {
        /// Number of pixels with samples in both halves.
        measured,
        luminance,
        /// Variances by the halves' differences, and by the samples' spread.
        variance,
        spread,
        /// Squared variances in three ways, see [`Sums::squared_variance`].
        of_pixels,
        of_neighbours,
        of_differences,
    }
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
                half_difference_variance(&film.pixels[pixel]),
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
