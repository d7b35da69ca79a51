//! Hard cases of thin films: both ends of weight, thickness and index, grazing views; against Airy's sum of complex
//! amplitudes in f64.

use super::fresnel::COSINES;
use super::{HardError, Stage};
use crate::job::probe::FresnelQuestion;
use crate::optics::fresnel::METALS;
use crate::optics::thin_film::film_path;

const WEIGHTS: [f32; 3] = [0.0, 1e-6, 1.0];
const THICKNESSES_UM: [f32; 6] = [0.0, 1e-6, 0.05, 0.3, 1.0, 10.0];
const FILM_IORS: [f32; 5] = [1.0, 1.33, 1.5, 2.4, 3.0];

cases! {
    "fresnel"
    "film-over-glass"
        "the two sides of a film are 0/0 at grazing angles, and its phase has dozens of turns"
        "films of 0 to 10 µm, index 1 to 3, weights 0, 1e-6, 1, over indices 1, 1.33, 1.5 and 2.42, and from within them"
        "the share reflected is that of complex amplitudes in f64"
        || {
            let bad = over_glass().iter().filter(|q| !naive(q).is_finite()).count();
            format!("{bad} of {} are NaN", over_glass().len())
        },
        "error" // The rounding of the thickest film's phase, 350 rad.
        2e-4, |stage| worst(stage, &over_glass());
    "film-over-metal"
        "the amplitude behind the film is complex, and its root loses all digits of the smaller part"
        "the same films over each of the measured metals"
        "the share reflected is that of complex amplitudes in f64"
        || {
            let bad = over_metals().iter().filter(|q| !naive(q).is_finite()).count();
            format!("{bad} of {} are NaN", over_metals().len())
        },
        "error" 2e-4, |stage| worst(stage, &over_metals());
}

/// Every film at every cosine over such media.
fn films(model: u32, media: &[(f32, f32, f32)]) -> Vec<FresnelQuestion> {
    let mut all = Vec::new();
    for &(before, eta, k) in media {
        for (weight, thickness) in WEIGHTS.into_iter().flat_map(|w| THICKNESSES_UM.map(|d| (w, d))) {
            for (ior, cosine) in FILM_IORS.into_iter().flat_map(|n| COSINES.map(|c| (n, c))) {
                // A film of lower index than what is before it has total reflection of its own, unless both have.
                let square = f64::from(ior / before).powi(2) - 1.0 + f64::from(cosine).powi(2);
                let behind = f64::from(eta).powi(2) - 1.0 + f64::from(cosine).powi(2);
                if square <= 0.0 && behind > 0.0 {
                    continue;
                }
                all.push(FresnelQuestion {
                    model,
                    cosine,
                    eta,
                    k,
                    film: [weight, ior / before, film_path(thickness).y * before],
                });
            }
        }
    }
    all
}

fn over_glass() -> Vec<FresnelQuestion> {
    let sides = |ior: f32| [(1.0, ior, 0.0), (ior, 1.0 / ior, 0.0)];
    films(2, &[1.0, 1.33, 1.5, 2.42].map(sides).concat())
}

fn over_metals() -> Vec<FresnelQuestion> {
    let of_metal =
        |metal: &crate::optics::fresnel::Metal| [0, 1, 2].map(|i| (1.0, metal.eta[i] as f32, metal.k[i] as f32));
    films(3, &METALS.iter().flat_map(of_metal).collect::<Vec<_>>())
}

/// Largest difference from f64; infinite for NaN.
fn worst(stage: &Stage, questions: &[FresnelQuestion]) -> Result<f64, HardError> {
    let answers = stage.prober.fresnel(questions)?;
    let error = |(q, &share): (&FresnelQuestion, &f32)| {
        let error = (f64::from(share) - exact(q)).abs();
        if error.is_nan() { f64::INFINITY } else { error }
    };
    Ok(questions.iter().zip(&answers).map(error).fold(0.0, f64::max))
}

type Complex = [f64; 2];

fn sum(a: Complex, b: Complex) -> Complex {
    [a[0] + b[0], a[1] + b[1]]
}

fn product(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

fn ratio(a: Complex, b: Complex) -> Complex {
    let square = b[0] * b[0] + b[1] * b[1];
    let above = product(a, [b[0], -b[1]]);
    [above[0] / square, above[1] / square]
}

/// The root in the upper right quadrant.
fn root([re, im]: Complex) -> Complex {
    let size = re.hypot(im);
    if re >= 0.0 {
        let real = (0.5 * (size + re)).sqrt();
        [real, if real > 0.0 { 0.5 * im / real } else { 0.0 }]
    } else {
        let imaginary = (0.5 * (size - re)).sqrt();
        [0.5 * im / imaginary, imaginary]
    }
}

/// What one polarisation reflects, by the amplitudes of both sides of the film.
fn share([before, film, behind]: [Complex; 3], turn: Complex) -> f64 {
    let amplitude = |a: Complex, b: Complex| match sum(a, b) {
        [0.0, 0.0] => [0.0, 0.0],
        below => ratio(sum(a, [-b[0], -b[1]]), below),
    };
    let first = amplitude(before, film);
    let second = product(amplitude(film, behind), turn);
    let found = ratio(sum(first, second), sum([1.0, 0.0], product(first, second)));
    found[0] * found[0] + found[1] * found[1]
}

/// Airy's sum in f64, mixed with the share without a film by its weight.
fn exact(q: &FresnelQuestion) -> f64 {
    let [weight, film_ior, path] = q.film.map(f64::from);
    // At grazing everything is reflected, unless there is nothing to reflect it.
    let c = f64::from(q.cosine).max(1e-12);
    let (eta, k) = (f64::from(q.eta), f64::from(q.k));
    let film = root([(film_ior - 1.0) * (film_ior + 1.0) + c * c, 0.0]);
    let behind = root([(eta - 1.0) * (eta + 1.0) - k * k + c * c, 2.0 * eta * k]);
    let squares = [[1.0, 0.0], [film_ior * film_ior, 0.0], product([eta, k], [eta, k])];
    let heights = [[c, 0.0], film, behind];
    let of = |path: f64| {
        let phase = 2.0 * path * film[0];
        let turn = [phase.cos(), phase.sin()];
        let parallel = [0, 1, 2].map(|i| ratio(heights[i], squares[i]));
        0.5 * (share(heights, turn) + share(parallel, turn))
    };
    (1.0 - weight) * of(0.0) + weight * of(path)
}

/// The textbook form with real amplitudes in f32.
fn naive(q: &FresnelQuestion) -> f32 {
    let [_, ior, path] = q.film;
    let c = q.cosine;
    let film = (ior * ior - 1.0 + c * c).sqrt();
    let behind = (q.eta * q.eta - q.k * q.k - 1.0 + c * c).sqrt();
    let (first, second) = ((c - film) / (c + film), (film - behind) / (film + behind));
    let cross = 2.0 * first * second * (2.0 * path * film).cos();
    (first * first + second * second + cross) / (1.0 + first * first * second * second + cross)
}
