//! Hard cases of the Fresnel equations: cancellation, overflow, changes of form; against complex arithmetic in f64.

use super::{HardError, Stage};
use crate::job::probe::FresnelQuestion;

/// Cosines from grazing to head-on.
pub(super) const COSINES: [f32; 14] = [
    0.0,
    1e-30,
    1e-7,
    1e-5,
    1e-3,
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

cases! {
    "fresnel"
    "fresnel-grazing-and-normal"
        "at grazing and at normal incidence numerators and denominators vanish together: 0/0"
        "14 cosines from 0 to 1, glass, water and diamond, from both sides, and six metals"
        "the share reflected is that of complex arithmetic in f64"
        || format!("{} at cosine 0, index 1", naive_dielectric(0.0, 1.0)),
        "error" LIMIT, |stage| {
            let dielectrics = [1.33_f32, 1.5, 2.42].into_iter().flat_map(|ior| [ior, 1.0 / ior]);
            let mut terms: Vec<_> = dielectrics.map(|ior| (0, ior, 0.0)).collect();
            for metal in crate::optics::fresnel::METALS {
                let channels = metal.eta.into_iter().zip(metal.k);
                terms.extend(channels.map(|(eta, k)| (1, eta as f32, k as f32)));
            }
            worst(stage, &with_cosines(&terms))
        };
    "fresnel-total-reflection"
        "just beyond the critical angle the square of the refracted cosine is below 0: NaN"
        "from within glass, the critical cosine and its 40 neighbours in f32 on either side"
        "the share is 1 beyond, that of f64 before, with nothing in between"
        || {
            let ior = 1.0 / 1.5;
            let bad = around_critical(ior)
                .filter(|&c| !naive_dielectric(c, ior).is_finite())
                .count();
            format!("{bad} of 81 are NaN")
        },
        "error" // The reflectance has a vertical tangent there: this is the effect of one rounding of the cosine.
        2e-3, |stage| {
            let question = |cosine| FresnelQuestion {
                model: 0,
                cosine,
                eta: 1.0 / 1.5,
                k: 0.0,
                film: [0.0; 3],
            };
            worst(stage, &around_critical(1.0 / 1.5).map(question).collect::<Vec<_>>())
        };
    "fresnel-index-of-one"
        "with both sides alike η² − 1 + cos² cancels: an invisible surface reflects"
        "η = 1 and up to 1e-3 beside it, at every cosine"
        "nothing is reflected by η = 1, and the share is that of f64 beside it"
        || {
            let error =
                |(cosine, ior): (f32, f32)| (f64::from(naive_dielectric(cosine, ior)) - exact(cosine, ior, 0.0)).abs();
            let pairs = COSINES
                .into_iter()
                .flat_map(|c| NEARLY_ONE.into_iter().map(move |ior| (c, ior)));
            let worst = pairs
                .map(error)
                .fold(0.0, |a: f64, b| if b.is_nan() || b > a { b } else { a });
            format!("{worst:.1e}")
        },
        "error" 1e-5, |stage| {
            let terms = NEARLY_ONE.map(|ior| (0, ior, 0.0));
            worst(stage, &with_cosines(&terms))
        };
    "fresnel-no-absorption"
        "a conductor with k = 0 is a dielectric: √(… − …) of two equal numbers"
        "conductors of k = 0, 1e-20 and 1e-7 with η from 0 to 20"
        "the share reflected is that of complex arithmetic in f64"
        || {
            let error = |(c, eta, k): (f32, f32, f32)| (f64::from(naive_conductor(c, eta, k)) - exact(c, eta, k)).abs();
            let worst = conductors(&ETAS, &[0.0, 1e-20, 1e-7]).into_iter().map(error);
            format!(
                "{:.1e}",
                worst.fold(0.0, |a: f64, b| if b.is_nan() || b > a { b } else { a })
            )
        },
        "error" 1e-3, |stage| worst(stage, &asked(&conductors(&ETAS, &[0.0, 1e-20, 1e-7])));
    "fresnel-huge-absorption"
        "k² overflows f32 from k = 4e9 on: inf − inf is NaN"
        "conductors of k = 20, 1e3, 1e6, 1e10 and 1e18 with η from 0 to 20"
        "the share reflected is that of complex arithmetic in f64"
        || {
            let all = conductors(&ETAS, &HUGE);
            let bad = all
                .iter()
                .filter(|&&(c, eta, k)| !naive_conductor(c, eta, k).is_finite());
            format!("{} of {} are NaN", bad.count(), all.len())
        },
        "error" 1e-6, |stage| worst(stage, &asked(&conductors(&ETAS, &HUGE)));
}

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
const ETAS: [f32; 7] = [0.0, 1e-6, 0.05, 0.5, 1.0, 1.5, 20.0];
const HUGE: [f32; 5] = [20.0, 1e3, 1e6, 1e10, 1e18];

fn conductors(etas: &[f32], ks: &[f32]) -> Vec<(f32, f32, f32)> {
    let of_eta = |&eta: &f32| {
        ks.iter()
            .flat_map(move |&k| COSINES.into_iter().map(move |cosine| (cosine, eta, k)))
    };
    etas.iter().flat_map(of_eta).collect()
}

fn asked(conductors: &[(f32, f32, f32)]) -> Vec<FresnelQuestion> {
    let question = |&(cosine, eta, k): &(f32, f32, f32)| FresnelQuestion {
        model: 1,
        cosine,
        eta,
        k,
        film: [0.0; 3],
    };
    conductors.iter().map(question).collect()
}

fn with_cosines(terms: &[(u32, f32, f32)]) -> Vec<FresnelQuestion> {
    let question = |&(model, eta, k): &(u32, f32, f32)| {
        let film = [0.0; 3];
        COSINES.map(|cosine| FresnelQuestion {
            model,
            cosine,
            eta,
            k,
            film,
        })
    };
    terms.iter().flat_map(question).collect()
}

/// The critical cosine from within an index below 1, and 40 neighbours on either side.
fn around_critical(ior: f32) -> impl Iterator<Item = f32> {
    let critical = (1.0 - f64::from(ior) * f64::from(ior)).sqrt() as f32;
    (-40..=40).map(move |step: i32| f32::from_bits(critical.to_bits().wrapping_add_signed(step)))
}

/// Largest difference from f64; infinite for NaN.
fn worst(stage: &Stage, questions: &[FresnelQuestion]) -> Result<f64, HardError> {
    let answers = stage.prober.fresnel(questions)?;
    let error = |(q, &share): (&FresnelQuestion, &f32)| {
        let error = (f64::from(share) - exact(q.cosine, q.eta, q.k)).abs();
        if error.is_nan() { f64::INFINITY } else { error }
    };
    Ok(questions.iter().zip(&answers).map(error).fold(0.0, f64::max))
}

/// Fresnel's equations with the complex index `eta` + i `k`, in f64.
fn exact(cosine: f32, eta: f32, k: f32) -> f64 {
    let (c, eta, k) = (f64::from(cosine), f64::from(eta), f64::from(k));
    // m² − sin², and its root in the upper right quadrant.
    let square = [(eta - 1.0) * (eta + 1.0) - k * k + c * c, 2.0 * eta * k];
    let size = square[0].hypot(square[1]);
    let half_sum = |sum: f64| (0.5 * sum).max(0.0).sqrt();
    let root = if square[0] >= 0.0 {
        let real = half_sum(size + square[0]);
        [real, if real > 0.0 { 0.5 * square[1] / real } else { 0.0 }]
    } else {
        let imaginary = half_sum(size - square[0]);
        [0.5 * square[1] / imaginary, imaginary]
    };
    let share = |[ar, ai]: [f64; 2], [br, bi]: [f64; 2]| {
        let (below, above) = ((ar + br).hypot(ai + bi), (ar - br).hypot(ai - bi));
        if below > 0.0 { (above / below).powi(2) } else { 0.0 }
    };
    let perpendicular = share([c, 0.0], root);
    // m² cos against the root. At normal incidence there is no plane of incidence, so that both are equal, even if terms
    // vanish.
    let parallel = if cosine < 1.0 {
        share([(eta * eta - k * k) * c, 2.0 * eta * k * c], root)
    } else {
        perpendicular
    };
    0.5 * (perpendicular + parallel)
}

/// The textbook form without guards.
fn naive_dielectric(cosine: f32, ior: f32) -> f32 {
    let g = (ior * ior - 1.0 + cosine * cosine).sqrt();
    let perpendicular = (cosine - g) / (cosine + g);
    let parallel = (ior * ior * cosine - g) / (ior * ior * cosine + g);
    0.5 * (perpendicular * perpendicular + parallel * parallel)
}

/// Reflectance of a conductor in the textbook form, without guards.
pub fn naive_conductor(cosine: f32, eta: f32, k: f32) -> f32 {
    let (cos2, sin2) = (cosine * cosine, 1.0 - cosine * cosine);
    let t0 = eta * eta - k * k - sin2;
    let size = (t0 * t0 + 4.0 * eta * eta * k * k).sqrt();
    let a = (0.5 * (size + t0)).sqrt();
    let (t1, t2) = (size + cos2, 2.0 * a * cosine);
    let perpendicular = (t1 - t2) / (t1 + t2);
    let (t3, t4) = (cos2 * size + sin2 * sin2, t2 * sin2);
    0.5 * (perpendicular + perpendicular * (t3 - t4) / (t3 + t4))
}
