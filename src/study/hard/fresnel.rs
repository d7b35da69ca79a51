//! Hard cases of the Fresnel equations and of thin films: cancellation, overflow, changes of form, grazing views, both ends
//! of weight, thickness and index; against Airy's sum of complex amplitudes in f64.

use super::{Stage, StudyError};
use crate::{
    job::probe::{FresnelQuestion, ProbeScene},
    optics::{fresnel::METALS, thin_film::film_path},
};

/// Cosines from grazing to head-on.
const COSINES: [f32; 14] = [
    0.0,
    1e-30,
    1e-7,
    1e-5,
    0.001,
    0.01,
    0.05,
    0.2,
    0.4,
    0.6,
    0.8,
    0.99,
    0.999_999_9,
    1.0,
];
/// The largest error in the share that is reflected; four roundings of 1.
const LIMIT: f64 = 2.5e-7;
const WEIGHTS: [f32; 3] = [0.0, 1e-6, 1.0];
const THICKNESSES_UM: [f32; 6] = [0.0, 1e-6, 0.05, 0.3, 1.0, 10.0];
const FILM_IORS: [f32; 5] = [1.0, 1.33, 1.5, 2.4, 3.0];
const NEARLY_ONE: [f32; 9] = [
    1.0,
    1.0 + f32::EPSILON,
    1.0 - f32::EPSILON,
    1.000_01,
    0.999_99,
    1.000_1,
    0.999_9,
    1.001,
    0.999,
];

cases! {
    "fresnel"
    "film-over-glass"
        "the two sides of a film are 0/0 at grazing angles, and its phase has dozens of turns"
        "films of 0 to 10 µm, index 1 to 3, weights 0, 1e-6, 1, over indices 1, 1.33, 1.5 and 2.42, and from within them"
        "the share reflected is that of complex amplitudes in f64"
        "3108 of 10026 are NaN",
        "error" // The rounding of the thickest film's phase, 350 rad.
        0.0002, |stage| {
            let sides = |ior: f32| [(1.0, ior, 0.0), (ior, 1.0 / ior, 0.0)];
            worst(stage, &films(2, &[1.0, 1.33, 1.5, 2.42].map(sides).concat()))
        };
    "film-over-metal"
        "the amplitude behind the film is complex, and its root loses all digits of the smaller part"
        "the same films over each of the measured metals"
        "the share reflected is that of complex amplitudes in f64"
        "37188 of 37458 are NaN",
        "error" 2e-4, |stage| {
            let media: Vec<_> = metals().map(|(eta, k)| (1.0, eta, k)).collect();
            worst(stage, &films(3, &media))
        };
    "fresnel-grazing-and-normal"
        "at grazing and at normal incidence numerators and denominators vanish together: 0/0"
        "14 cosines from 0 to 1, glass, water and diamond, from both sides, and six metals"
        "the share reflected is that of complex arithmetic in f64"
        "NaN at cosine 0, index 1",
        "error" LIMIT, |stage| {
            let iors = [1.33_f32, 1.5, 2.42].into_iter().flat_map(|ior| [ior, 1.0 / ior]);
            let glass = bare(0, iors.map(|ior| (ior, 0.0)));
            worst(stage, &[glass, bare(1, metals())].concat())
        };
    "fresnel-total-reflection"
        "just beyond the critical angle the square of the refracted cosine is below 0: NaN"
        "from within glass, the critical cosine and its 40 neighbours in f32 on either side"
        "the share is 1 beyond, that of f64 before, with nothing in between"
        "40 of 81 are NaN",
        "error" // The reflectance has a vertical tangent there: this is the effect of one rounding of the cosine.
        0.002, |stage| {
            let ior = 1.0 / 1.5;
            let critical = (1.0 - f64::from(ior) * f64::from(ior)).sqrt() as f32;
            let around = (-40..=40).map(|step: i32| f32::from_bits(critical.to_bits().wrapping_add_signed(step)));
            worst(stage, &around.map(|cosine| question(0, cosine, (ior, 0.0))).collect::<Vec<_>>())
        };
    "fresnel-index-of-one"
        "with both sides alike η² − 1 + cos² cancels: an invisible surface reflects"
        "η = 1 and up to 1e-3 beside it, at every cosine"
        "nothing is reflected by η = 1, and the share is that of f64 beside it"
        "NaN",
        "error" 1e-5, |stage| worst(stage, &bare(0, NEARLY_ONE.map(|ior| (ior, 0.0))));
    "fresnel-no-absorption"
        "a conductor with k = 0 is a dielectric: √(… − …) of two equal numbers"
        "conductors of k = 0, 1e-20 and 1e-7 with η from 0 to 20"
        "the share reflected is that of complex arithmetic in f64"
        "NaN",
        "error" 1e-3, |stage| worst(stage, &bare(1, conductors(&[0.0, 1e-20, 1e-7])));
    "fresnel-huge-absorption"
        "k² overflows f32 from k = 4e9 on: inf − inf is NaN"
        "conductors of k = 20, 1e3, 1e6, 1e10 and 1e18 with η from 0 to 20"
        "the share reflected is that of complex arithmetic in f64"
        "196 of 490 are NaN",
        "error" 1e-6, |stage| worst(stage, &bare(1, conductors(&[20.0, 1e3, 1e6, 1e10, 1e18])));
}

/// Indices and absorptions of the measured metals.
fn metals() -> impl Iterator<Item = (f32, f32)> {
    let channels = |metal: &crate::optics::fresnel::Metal| [0, 1, 2].map(|i| (metal.eta[i] as f32, metal.k[i] as f32));
    METALS.iter().flat_map(channels)
}

fn conductors(ks: &[f32]) -> impl Iterator<Item = (f32, f32)> {
    let etas = [0.0, 1e-6, 0.05, 0.5, 1.0, 1.5, 20.0];
    etas.into_iter().flat_map(|eta| ks.iter().map(move |&k| (eta, k)))
}

fn question(model: u32, cosine: f32, (eta, k): (f32, f32)) -> FresnelQuestion {
    FresnelQuestion {
        model,
        cosine,
        eta,
        k,
        film: [0.0; 3],
    }
}

/// Media without a film, at every cosine.
fn bare(model: u32, media: impl IntoIterator<Item = (f32, f32)>) -> Vec<FresnelQuestion> {
    media
        .into_iter()
        .flat_map(|medium| COSINES.map(|cosine| question(model, cosine, medium)))
        .collect()
}

/// Films between media: the index before them, index and absorption behind them.
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
                let film = [weight, ior / before, film_path(thickness).y * before];
                all.push(FresnelQuestion {
                    film,
                    ..question(model, cosine, (eta, k))
                });
            }
        }
    }
    all
}

/// The largest error; infinite where a share is NaN.
fn worst(stage: &Stage, questions: &[FresnelQuestion]) -> Result<f64, StudyError> {
    let answers = stage.prober.fresnel(&ProbeScene::default(), questions)?;
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

/// The share reflected by a film between two media, by their heights and what they are weighed by.
fn share(heights: [Complex; 3], weights: [Complex; 3], turn: Complex) -> f64 {
    let amplitude = |i: usize, j: usize| {
        let [a, b] = [product(heights[i], weights[j]), product(heights[j], weights[i])];
        match sum(a, b) {
            [0.0, 0.0] => [0.0, 0.0],
            below => ratio(sum(a, [-b[0], -b[1]]), below),
        }
    };
    let first = amplitude(0, 1);
    let second = product(amplitude(1, 2), turn);
    let found = ratio(sum(first, second), sum([1.0, 0.0], product(first, second)));
    found[0] * found[0] + found[1] * found[1]
}

fn exact(q: &FresnelQuestion) -> f64 {
    let [weight, film_ior, path] = q.film.map(f64::from);
    // Without a film any index does, and light may graze.
    let (film_ior, least) = if weight == 0.0 { (1.0, 1e-40) } else { (film_ior, 1e-12) };
    let c = f64::from(q.cosine).max(least);
    let (eta, k) = (f64::from(q.eta), f64::from(q.k));
    let film = root([(film_ior - 1.0) * (film_ior + 1.0) + c * c, 0.0]);
    let behind = root([(eta - 1.0) * (eta + 1.0) - k * k + c * c, 2.0 * eta * k]);
    let squares = [[1.0, 0.0], [film_ior * film_ior, 0.0], product([eta, k], [eta, k])];
    let heights = [[c, 0.0], film, behind];
    let of = |path: f64| {
        let phase = 2.0 * path * film[0];
        let turn = [phase.cos(), phase.sin()];
        let perpendicular = share(heights, [[1.0, 0.0]; 3], turn);
        // Along the normal both are the same, and where the index is 0 the other is 0/0.
        let parallel = if c == 1.0 {
            perpendicular
        } else {
            share(heights, squares, turn)
        };
        0.5 * (perpendicular + parallel)
    };
    (1.0 - weight) * of(0.0) + weight * of(path)
}
