//! Statistics of renders: error estimates and their intervals against the errors of made-up noise, where adaptive sampling puts
//! samples, and differences of images.

use std::f64::consts::TAU;

use glossmith::{
    analysis::{
        adaptive::{Round, next_goals},
        denoised::{Colors, DenoisedHalves, Errors},
        difference::{difference, diverging},
        error::{Estimates, relative_mean_squared_error, z_test},
        halves::Halves,
        noise::{noise, relative_errors, tile_errors},
    },
    job::film::{Film, Image},
    job::tiles::TileGrid,
    optics::random::{Sequence, random_pair, random_state},
};

/// Side of a film in pixels: five tiles.
const SIDE: u32 = 40;

/// Two uniform numbers of standard deviation 1 and mean 0.
fn uniform(x: u32, y: u32, seed: u32, sample: u32) -> [f64; 2] {
    let pair: [f64; 2] = random_pair(random_state(x, y, seed, sample, Sequence::Independent), 0);
    pair.map(|xi| 12.0_f64.sqrt() * (xi - 0.5))
}

/// A film of samples that are `deviation(pixel, number)` away from 1; and the true squared error of its pixels' means, summed.
fn film_of(samples: u32, seed: u32, deviation: impl Fn(usize, f64) -> f64) -> (Film, f64) {
    let mut film = Film::new(SIDE, SIDE);
    let mut squared_error = 0.0;
    for pixel in 0..film.pixel_count() {
        let mut sum = 0.0;
        for sample in 0..samples {
            let x = deviation(pixel, uniform(pixel as u32, 0, seed, sample)[0]);
            film.add(pixel, sample, [1.0 + x, 1.0 + x, 1.0 + x, 1.0]);
            let tile = film.grid().of_pixel(pixel);
            film.costs[tile].rays += 1.0;
            sum += x;
        }
        squared_error += (sum / f64::from(samples)).powi(2);
    }
    (film, squared_error / f64::from(SIDE * SIDE))
}

/// Exact left of the middle, with a standard deviation of 0.3 right of it.
fn half_noisy(samples: u32, seed: u32) -> (Film, f64) {
    let sigma = |pixel: usize| if pixel as u32 % SIDE >= SIDE / 2 { 0.3 } else { 0.0 };
    film_of(samples, seed, |pixel, x| sigma(pixel) * x)
}

#[test]
fn the_error_of_known_noise() {
    let mut inside = 0;
    for seed in 0..60 {
        let samples = 10 + seed % 7;
        let (film, squared_error) = half_noisy(samples, seed);
        let found = noise(&film).unwrap();
        let expected = 0.3 / f64::from(2 * samples).sqrt();
        near!(found.relative / expected, 1.0, 0.12);
        near!(found.from_spread / expected, 1.0, 0.05);
        inside += usize::from((found.low..=found.high).contains(&squared_error.sqrt()));
    }
    assert!((53..=60).contains(&inside), "{inside} of 60");
}

#[test]
fn the_band_of_rare_bright_samples_is_wide_enough() {
    // Of 100 samples one is bright: most pixels of 16 samples have none.
    let bright = 12.0_f64.sqrt() * (0.01 - 0.5);
    let deviation = |_, x: f64| if x < bright { 99.0 } else { -1.0 };
    let inside = (0..60).filter(|seed| {
        let (film, squared_error) = film_of(16, *seed, deviation);
        let mean = film.luminance().iter().sum::<f64>() / f64::from(SIDE * SIDE);
        let found = noise(&film).unwrap();
        (found.low..=found.high).contains(&(squared_error.sqrt() / mean))
    });
    let inside = inside.count();
    assert!((53..=60).contains(&inside), "{inside} of 60");
}

#[test]
fn halves_that_agree_better_than_their_spread_are_believed() {
    // Each half holds the same values: as if a sequence had removed all error but that of one number.
    let mut film = Film::new(SIDE, SIDE);
    for pixel in 0..film.pixel_count() {
        (0..8).for_each(|sample| {
            let y = f64::from(sample / 2);
            film.add(pixel, sample, [y, y, y, 1.0]);
        });
    }
    let found = noise(&film).unwrap();
    assert!(found.relative < 1e-12 && found.from_spread > 0.2, "{found:?}");
}

#[test]
fn no_error_is_known_before_there_are_two_halves_and_none_is_found_without_light() {
    assert_eq!(noise(&half_noisy(1, 0).0), None);
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
    let (film, _) = half_noisy(64, 5);
    let errors = relative_errors(&film);
    let squares: f64 = errors.iter().map(|error| f64::from(*error).powi(2)).sum();
    let estimate = noise(&film).unwrap().relative;
    let of_map = (squares / f64::from(SIDE * SIDE)).sqrt();
    near!(of_map / estimate, 1.0, 0.1);
    assert!(errors.iter().step_by(SIDE as usize).all(|error| *error < 1e-6));
    // The tiles in the middle column are half noisy.
    for row in tile_errors(&film).chunks(5) {
        let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 0.25;
        assert!(row[0].sample_variance < 1e-9 && row[0].rays == 1.0, "{row:?}");
        assert!(
            near(row[2].sample_variance, 0.045) && near(row[3].sample_variance, 0.09),
            "{row:?}"
        );
    }
}

const ROUND: Round = Round {
    growth: [1.02, 1.25],
    noise: None,
    samples_max: u32::MAX,
    region: None,
};
/// Film of 6 × 6 tiles.
const TILES: TileGrid = TileGrid { width: 48, height: 48 };

/// A film of 16 samples per pixel, each at the cost of `rays`, whose standard deviation a sample is `sigma` of its tile.
fn tiled_film(sigma: impl Fn(usize) -> f64, rays: impl Fn(usize) -> f64) -> Film {
    let mut film = Film::new(TILES.width, TILES.height);
    for pixel in 0..film.pixel_count() {
        let tile = TILES.of_pixel(pixel);
        for sample in 0..16 {
            let y = 1.0 + sigma(tile) * uniform(pixel as u32, 0, 7, sample)[0];
            film.add(pixel, sample, [y, y, y, 1.0]);
            film.costs[tile].rays += rays(tile);
        }
    }
    film
}

#[test]
fn samples_go_where_they_help_most() {
    // Columns of tiles: exact, noisy, noisy at four times the cost.
    let sigma = |tile: usize| if tile % 6 < 2 { 0.0 } else { 0.4 };
    let rays = |tile: usize| if tile % 6 < 4 { 1.0 } else { 4.0 };
    let film = tiled_film(sigma, rays);
    let goals = |round: Round| next_goals(&film, &[16; 36], round);
    let found = goals(ROUND);
    let total: u32 = found.iter().sum();
    assert!((36 * 16 * 5 / 4..36 * 16 * 4 / 3).contains(&total), "{found:?}");
    for row in found.chunks(6) {
        assert_eq!(row[0], 16, "no error, nor beside it: {row:?}");
        assert!(row[2] >= 24 && row[5] <= 20, "{row:?}");
    }
    // Far from the aim a tile at most doubles; near it only little is asked for.
    let towards = |noise: f64| Round {
        growth: [1.02, 1e3],
        noise: Some(noise),
        ..ROUND
    };
    let far = goals(towards(0.0001));
    assert!(far.iter().all(|goal| *goal <= 32), "{far:?}");
    assert!(far.iter().sum::<u32>() > 36 * 16 * 3 / 2, "{far:?}");
    let near = goals(towards(0.98 * noise(&film).unwrap().relative));
    assert!(near.iter().sum::<u32>() < 36 * 16 * 11 / 10, "{near:?}");
    let capped = goals(Round {
        samples_max: 20,
        ..ROUND
    });
    assert!(
        capped.iter().all(|goal| (16..=20).contains(goal)) && capped.contains(&20),
        "{capped:?}"
    );
}

#[test]
fn the_surroundings_of_a_small_bright_feature_do_not_starve() {
    let hot = 14;
    let film = tiled_film(|tile| if tile == hot { 2.0 } else { 0.001 }, |_| 1.0);
    // Rounds on end, as if the film stayed as it is but for the number of samples.
    let mut samples = vec![16; 36];
    for _ in 0..30 {
        samples = next_goals(&film, &samples, ROUND);
    }
    let most = samples[hot];
    assert!(most > 1000, "{samples:?}");
    for tile in 0..36 {
        let is_near = TILES.around(hot).any(|near| near == tile);
        let least = if is_near { 2 } else { 400 };
        assert!(samples[tile] >= (most / least).max(16), "tile {tile}: {samples:?}");
    }
}

/// Side of the images whose denoising is judged.
const DENOISED: usize = 64;

/// Two halves of an image of luminance 1 with noise `noise(pixel)`, and both filtered by the mean of 3 × 3 pixels plus
/// `bias(pixel)`.
fn denoised_halves(noise: impl Fn(usize) -> f64, bias: impl Fn(usize) -> f64, seed: u32) -> [[Colors; 2]; 2] {
    let half = |number: u32| -> Vec<f64> {
        let value = |pixel: usize| 1.0 + noise(pixel) * uniform(pixel as u32, number, seed, 0)[0];
        (0..DENOISED * DENOISED).map(value).collect()
    };
    let grey = |values: &[f64]| -> Colors { values.iter().map(|value| [*value as f32; 3]).collect() };
    let filtered = |values: &[f64]| -> Colors {
        let around = |at: usize| at.saturating_sub(1)..(at + 2).min(DENOISED);
        let mean = |pixel: usize| {
            let (columns, rows) = (around(pixel % DENOISED), around(pixel / DENOISED));
            let sum: f64 = rows
                .clone()
                .flat_map(|y| &values[y * DENOISED..][columns.clone()])
                .sum();
            sum / (columns.len() * rows.len()) as f64 + bias(pixel)
        };
        grey(&(0..values.len()).map(mean).collect::<Vec<_>>())
    };
    let both = [half(0), half(1)];
    [
        both.each_ref().map(|half| grey(half)),
        both.each_ref().map(|half| filtered(half)),
    ]
}

fn errors([noisy, denoised]: &[[Colors; 2]; 2]) -> Errors {
    Errors::of(&DenoisedHalves {
        noisy: [&noisy[0], &noisy[1]],
        denoised: [&denoised[0], &denoised[1]],
        width: DENOISED,
    })
}

/// Mean squared error of the blend of the denoised halves' mean with the noisy halves' mean.
fn squared_error([noisy, denoised]: &[[Colors; 2]; 2], share: impl Fn(usize) -> f32) -> f64 {
    let of_pixel = |pixel: usize| {
        let mean = |pair: &[Colors; 2]| 0.5 * f64::from(pair[0][pixel][0] + pair[1][pixel][0]);
        let (x, clean) = (mean(noisy), mean(denoised));
        (clean + f64::from(share(pixel)) * (x - clean) - 1.0).powi(2)
    };
    (0..DENOISED * DENOISED).map(of_pixel).sum::<f64>() / (DENOISED * DENOISED) as f64
}

#[test]
fn the_error_of_a_denoised_image_is_the_true_one() {
    const RENDERS: u32 = 960;
    let (mut inside, mut estimated, mut truth, mut bias) = (0, 0.0, 0.0, 0.0);
    for seed in 0..RENDERS {
        let halves = denoised_halves(|pixel| if pixel % DENOISED < 32 { 0.1 } else { 0.6 }, |_| 0.05, seed);
        let errors = errors(&halves);
        let found = errors.error(None);
        let true_error = squared_error(&halves, |_| 0.0).sqrt() / 1.05;
        inside += u32::from((found.low..=found.high).contains(&true_error));
        estimated += found.value.powi(2);
        truth += true_error.powi(2);
        bias += errors.bias(None).value.powi(2) / f64::from(RENDERS);
    }
    near!(estimated / truth, 1.0, 0.1);
    // Errors are not quite normal: 93 % in the mean, and the standard deviation of such a count is 0.8 %.
    assert!(f64::from(inside) >= 0.91 * f64::from(RENDERS), "{inside} of {RENDERS}");
    // What is below 0 is cut off, and what is left is a little too large.
    let relative = bias.sqrt() / (0.05 / 1.05);
    assert!((0.9..1.3).contains(&relative), "{relative}");
}

#[test]
fn noise_that_the_filter_leaves_in_a_few_places_widens_the_interval() {
    // Columns of noise of which a mean over 3 × 3 pixels leaves a third, correlated with what is around.
    const RENDERS: u32 = 480;
    let inside = (0..RENDERS).filter(|seed| {
        let mut halves = denoised_halves(|pixel| if pixel % 16 < 2 { 0.5 } else { 0.01 }, |_| 0.0, *seed);
        halves[0] = halves[1].clone();
        let found = errors(&halves).error(None);
        (found.low..=found.high).contains(&squared_error(&halves, |_| 0.0).sqrt())
    });
    let inside = inside.count();
    assert!(inside as f64 >= 0.91 * f64::from(RENDERS), "{inside} of {RENDERS}");
}

#[test]
fn the_mixture_takes_samples_where_they_are_better_and_has_no_seams() {
    // Left a filter without bias, right one that is far worse than the samples.
    let halves = denoised_halves(|_| 0.1, |pixel| if pixel % DENOISED < 32 { 0.0 } else { 0.5 }, 3);
    let errors = errors(&halves);
    let shares = errors.shares();
    for row in shares.chunks(DENOISED) {
        assert!(row[..8].iter().all(|share| *share < 0.15), "{:?}", &row[..8]);
        assert!(row[56..].iter().all(|share| *share > 0.9), "{:?}", &row[56..]);
        assert!(row.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.12), "{row:?}");
    }
    let mixed = squared_error(&halves, |pixel| shares[pixel]);
    assert!(mixed < 0.6 * squared_error(&halves, |_| 0.0) && mixed < squared_error(&halves, |_| 1.0));
    let found = errors.error(Some(&shares));
    assert!(
        (found.low..=found.high).contains(&(mixed.sqrt() / 1.25)),
        "{found:?} {mixed}"
    );
}

/// A grey image of a luminance with noise of a standard deviation in either half.
fn halves(luminance: f64, noise: f64, seed: u32) -> Halves {
    let half = |i: usize| {
        let value = |pixel: u32| luminance + noise * uniform(pixel % 100, pixel / 100, seed, 0)[i];
        (0..10_000).map(value).collect()
    };
    Halves {
        even: half(0),
        odd: half(1),
    }
}

#[test]
fn differences_of_renders_are_measured_without_their_noise() {
    // 6 % apart, with 20 % noise: in the sum of squares of a plain difference the noise would rule. The products' mean has
    // a standard error of 0.0008.
    let found = halves(1.06, 0.2, 1).distance(&halves(1.0, 0.2, 2));
    assert!((found.value - 0.06).abs() < 0.02 && found.is_resolved(), "{found:?}");
    let none = halves(1.0, 0.2, 1).distance(&halves(1.0, 0.2, 2));
    assert!(!none.is_resolved() && none.high < 0.07, "{none:?}");
    // Noise in common does not count; the mean that it is relative to has noise itself.
    let found = halves(1.01, 0.2, 1).distance(&halves(1.0, 0.2, 1));
    assert!((found.value - 0.01).abs() < 0.0001 && found.is_resolved(), "{found:?}");
    // The error of an image is its own noise alone.
    let found = halves(1.0, 0.3, 4).error_of(&halves(1.0, 0.1, 3).even);
    near!(found.value, 0.1, 0.02);
    assert!(found.low < 0.1 && found.high > 0.1, "{found:?}");
}

#[test]
fn the_z_test_accepts_noise_and_finds_a_bias_below_it() {
    const PIXELS: u32 = 20_000;
    let variance = vec![0.01; PIXELS as usize];
    // Standard normal numbers (Box and Muller).
    let normal = |pixel: u32, seed: u32| {
        let pair: [f64; 2] = random_pair(random_state(pixel, 0, seed, 0, Sequence::Independent), 0);
        (-2.0 * (1.0 - pair[0]).ln()).sqrt() * (TAU * pair[1]).cos()
    };
    let image = |seed: u32, offset: f64| -> Vec<f64> {
        (0..PIXELS)
            .map(|pixel| 1.0 + offset + 0.1 * normal(pixel, seed))
            .collect()
    };
    let compare = |offset: f64| {
        let means = [image(1, 0.0), image(2, offset)];
        let [a, b] = means.each_ref().map(|mean| Estimates {
            mean,
            variance: &variance,
        });
        z_test(a, b)
    };
    let same = compare(0.0);
    assert!(same.p_value > 0.001 && same.p_value < 0.999, "{same:?}");
    near!(same.beyond_three_sigma, 0.0027, 0.0015);
    // A third of a standard deviation everywhere is invisible in a pixel and certain over the image.
    let biased = compare(0.035);
    assert!(biased.p_value < 1e-6, "{biased:?}");
    // Exact numbers that differ.
    let exact = |mean: &'static [f64]| Estimates { mean, variance: &[0.0] };
    assert_eq!(z_test(exact(&[1.0]), exact(&[1.0])).compared, 0);
    assert_eq!(z_test(exact(&[1.0]), exact(&[2.0])).p_value, 0.0);
    assert_eq!(z_test(exact(&[f64::NAN]), exact(&[1.0])).p_value, 0.0);
    // (0.1)²/(0.09 + 0.01) and 0: mean 0.05.
    let error = relative_mean_squared_error(&[0.4, 2.0], &[0.3, 2.0]);
    near!(error, 0.05, 1e-6);
}

fn grey(values: &[f32]) -> Image {
    Image {
        width: values.len() as u32,
        height: 1,
        pixels: values.iter().map(|x| [*x, *x, *x, 1.0]).collect(),
    }
}

#[test]
fn differences_are_signed_relative_and_coloured_by_their_sign() {
    let found = difference(&grey(&[1.0, 2.0]), &grey(&[1.5, 1.0])).expect("equal sizes");
    assert!((found.signed[0] - 0.5).abs() < 1e-6 && (found.signed[1] + 1.0).abs() < 1e-6);
    let expected = (0.5_f64 * (0.25 / 1.01 + 1.0 / 4.01)).sqrt();
    near!(found.rms_relative, expected, 1e-6);
    assert_eq!(difference(&grey(&[1.0]), &grey(&[1.0, 1.0])), None);
    let none = difference(&grey(&[3.0]), &grey(&[3.0])).expect("equal sizes");
    assert!(none.rms_relative == 0.0 && none.automatic_scale() > 0.0);
    let [r, g, b] = diverging(0.0);
    assert!(r == g && g == b);
    assert!(diverging(0.5)[0] > diverging(0.5)[2] && diverging(-0.5)[2] > diverging(-0.5)[0]);
    assert_eq!(diverging(7.0), diverging(1.0));
    let rgba = difference(&grey(&[1.0, 1.0]), &grey(&[2.0, 1.0]))
        .expect("equal sizes")
        .rgba(1.0);
    assert_eq!((&rgba[..3], &rgba[4..7]), (&diverging(1.0)[..], &diverging(0.0)[..]));
}
