//! The geometric lobe's density against quadrature, in f64: section 4 of docs/MATHEMATICS.md as it is written there,
//! apart from the closed forms of `optics::chord`.

use std::{f64::consts::PI, sync::LazyLock};

use glossmith::{
    analysis::quadrature::{gauss_legendre, integrate},
    document::CustomCurve,
    optics::{
        curve::{CUSTOM_INTERVALS, Curve, curve_distance_max, curve_h},
        frame::Frame,
        lobe::{Horizon, Lobe, LobeShape, lobe_evaluate, lobe_sample, stretch_from_anisotropy},
        random::{Sequence, random_pair, random_state},
        vector::{Vec3, vec3},
    },
};
use rayon::prelude::*;

use crate::lobe_cases::{ANGLES_DEG, Case, ROUGHNESS, custom};

/// Stretch and relative index of refraction.
const KINDS: [(f64, f64); 5] = [(0.0, 0.0), (0.7, 0.0), (0.0, 1.5), (0.0, 1.0 / 1.5), (-0.5, 1.5)];
/// Range of u up to which a few nodes are enough.
const PIECE_MAX: f64 = 0.5;

/// The inputs of a case.
struct Inputs {
    shape: LobeShape<'static, f64>,
    frame: Frame<f64>,
    wo: Vec3<f64>,
}

/// Gauss–Legendre rules: for a smooth integrand, and for each piece of one with kinks.
struct Rules {
    whole: Vec<[f64; 2]>,
    piece: Vec<[f64; 2]>,
}

impl Rules {
    fn new(order: usize) -> Self {
        Self {
            whole: gauss_legendre(order),
            piece: gauss_legendre(order / 16),
        }
    }
}

/// The lobe to integrate: its axis (the normal on the side that it fills) and its middle, by Snell's law or mirrored.
fn axis_and_middle(inputs: &Inputs) -> [Vec3<f64>; 2] {
    let Inputs { shape, frame, wo } = inputs;
    let (normal, eta) = (frame.normal, shape.eta);
    let cosine = normal.dot(*wo);
    let sine_behind = (1.0 - cosine * cosine).max(0.0).sqrt() / eta;
    if eta == 0.0 || sine_behind > 1.0 {
        return [normal, normal * (2.0 * cosine) - *wo];
    }
    let along = (normal * cosine - *wo) / eta;
    [-normal, along - normal * (1.0 - sine_behind * sine_behind).sqrt()]
}

/// The lobe that is integrated: behind the surface of the roughness x for which x (3 + 4 x) is |1 − 1/η|/2 of the facets'
/// tilt, found by halving (mathematics, section 7).
fn narrowed(inputs: &Inputs, axis: Vec3<f64>) -> Inputs {
    let Inputs { mut shape, frame, wo } = *inputs;
    if axis.dot(frame.normal) < 0.0 {
        let r = shape.roughness;
        let turn = (1.0 - 1.0 / shape.eta).abs() / 2.0 * (3.0 * r + 3.2 * r.powi(2) + 2.2 * r.powi(4));
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..80 {
            let half: f64 = 0.5 * (low + high);
            *(if half * (3.0 + 4.0 * half) < turn {
                &mut low
            } else {
                &mut high
            }) = half;
        }
        shape.roughness = high;
    }
    Inputs { shape, frame, wo }
}

/// The density after the horizon policy.
fn reference(inputs: &Inputs, rules: &Rules, light: Vec3<f64>) -> f64 {
    let [axis, middle] = axis_and_middle(inputs);
    let inputs = &narrowed(inputs, axis);
    let raw = |light| raw_reference(inputs, rules, axis, middle, light);
    let height = axis.dot(light);
    match inputs.shape.horizon {
        Horizon::None => raw(light),
        _ if height <= 0.0 => 0.0,
        Horizon::Absorb => raw(light),
        Horizon::Mirror => raw(light) + raw(light - axis * (2.0 * height)),
    }
}

/// The density before the policy, in the frame where the lobe is a unit ball.
fn raw_reference(inputs: &Inputs, rules: &Rules, axis: Vec3<f64>, middle: Vec3<f64>, light: Vec3<f64>) -> f64 {
    let Inputs { shape, frame, .. } = inputs;
    let kappa = shape.roughness;
    if shape.anisotropy == 0.0 {
        return ball_density(
            shape,
            rules,
            axis,
            middle * ((1.0 - kappa) / kappa),
            light / light.length(),
        );
    }
    let stretch = stretch_from_anisotropy(shape.anisotropy);
    let axes = [frame.tangent, frame.bitangent, axis];
    let widths = [kappa * stretch, kappa / stretch, kappa];
    let divided = |v: Vec3<f64>| Vec3::from_f64([0, 1, 2].map(|i| axes[i].dot(v) / widths[i]));
    let (a, direction) = (divided(middle) * (1.0 - kappa), divided(light));
    let length = direction.length();
    let jacobian = widths[0] * widths[1] * widths[2] * length.powi(3);
    ball_density(shape, rules, vec3(0.0, 0.0, 1.0), a, direction / length) / jacobian
}

/// p(ω) = 1/(4π√A) ∫ t² h(D) du.
fn ball_density(shape: &LobeShape<'_, f64>, rules: &Rules, n: Vec3<f64>, a: Vec3<f64>, omega: Vec3<f64>) -> f64 {
    let kappa = shape.roughness;
    let k = (1.0 - kappa) * (1.0 + kappa);
    let (nu, c, mu) = (n.dot(omega), n.dot(a), a.dot(omega));
    let off = a.cross(omega).length();
    let tilted = a * nu - omega * c;
    let big_a = kappa * kappa * nu * nu + k;
    let delta = k * (kappa * kappa * tilted.dot(tilted) + k * off * off) / big_a;
    if delta == 0.0 {
        // R = 1: Lambert's lobe in this frame, whatever the curve.
        return nu.max(0.0) / PI;
    }
    let middle = (kappa * kappa * nu * c + k * mu) / big_a;
    let reach: f64 = curve_distance_max(shape.curve, shape.table);
    // Where the ray crosses the sphere of the points at a distance D.
    let crossings = |d: f64| {
        let centre = mu + d * kappa * nu;
        let square = centre * centre - (a.dot(a) + 2.0 * d * kappa * c - d * d * k);
        (square > 0.0).then(|| [centre - square.sqrt(), centre + square.sqrt()])
    };
    let [first, last] = crossings(reach).map_or([0.0, 0.0], |[from, to]| [from.max(0.0), to]);
    if last <= first {
        return 0.0;
    }
    let slope = (delta / big_a).sqrt();
    let integrand = |u: f64| {
        let t = middle + slope * u.sinh();
        let s = delta.sqrt() * u.cosh();
        let lift = t * nu - c;
        let distance = if lift >= 0.0 {
            ((t - mu).powi(2) + off * off) / (kappa * lift + s)
        } else {
            (s - kappa * lift) / k
        };
        t * t * curve_h(shape.curve, shape.table, distance)
    };
    let mut ends = vec![first, last];
    if shape.curve == Curve::Custom {
        // h has a kink at each node of the table.
        let nodes = (1..CUSTOM_INTERVALS).map(|i| reach * i as f64 / CUSTOM_INTERVALS as f64);
        ends.extend(
            nodes
                .filter_map(crossings)
                .flatten()
                .filter(|t| *t > first && *t < last),
        );
        ends.sort_by(f64::total_cmp);
    }
    let ends: Vec<f64> = ends.into_iter().map(|t| ((t - middle) / slope).asinh()).collect();
    let piece = |ends: &[f64]| {
        let rule = if ends[1] - ends[0] > PIECE_MAX {
            &rules.whole
        } else {
            &rules.piece
        };
        integrate(rule, ends[0], ends[1], integrand)
    };
    ends.windows(2).map(piece).sum::<f64>() / (4.0 * PI * big_a.sqrt())
}

/// Every curve; the one drawn by hand as the program offers it, and as nobody would draw it.
fn curves() -> Vec<(Curve, &'static [f32])> {
    static DRAWN: LazyLock<Vec<f32>> = LazyLock::new(|| CustomCurve::default().table());
    let named = Curve::ALL.iter().filter(|curve| **curve != Curve::Custom);
    let mut curves: Vec<(Curve, &[f32])> = named.map(|&curve| (curve, &[][..])).collect();
    curves.extend([(Curve::Custom, &DRAWN[..]), (Curve::Custom, custom())]);
    curves
}

/// A curve's whole grid: every policy, roughness and view; isotropic, stretched, into glass and out of it, and both.
fn cases((curve, table): (Curve, &'static [f32])) -> Vec<Case> {
    let mut cases = Vec::new();
    for &horizon in Horizon::ALL {
        for (stretch, eta) in KINDS {
            let grid = Case::grid(Lobe::Geometric, curve, horizon, &[stretch], ROUGHNESS, ANGLES_DEG);
            cases.extend(grid.into_iter().map(|case| Case { eta, table, ..case }));
        }
    }
    cases
}

/// Direction number `i` that a case draws; `None` where it is absorbed.
fn drawn(case: &Case, Inputs { shape, frame, wo }: &Inputs, i: u32) -> Option<Vec3<f64>> {
    let state = random_state(17, 0, case.seed, i, Sequence::Independent);
    let ([a, b], [c, _]) = (random_pair(state, 0), random_pair::<f64>(state, 1));
    let sample = lobe_sample(shape, frame, frame.normal, *wo, [a, b, c]);
    (sample.weight > 0.0).then_some(sample.wi)
}

/// In f64 the closed forms are the quadrature, and the quadrature has converged.
#[test]
fn closed_forms_are_the_quadrature() {
    let (rules, finer) = (Rules::new(128), Rules::new(256));
    let cases: Vec<Case> = curves().into_iter().flat_map(cases).collect();
    cases.par_iter().for_each(|case| {
        let inputs = Inputs {
            shape: case.shape(),
            frame: case.frame(),
            wo: case.wo(),
        };
        // The long tail has none: a rule of a few nodes.
        let limit = if case.curve == Curve::LongTail { 5e-4 } else { 1e-6 };
        for light in (0..8).filter_map(|i| drawn(case, &inputs, i)) {
            let expected = reference(&inputs, &rules, light);
            let change = (reference(&inputs, &finer, light) / expected - 1.0).abs();
            assert!(
                change < 1e-8,
                "{case:?}: finer rules change the reference by {change:e}"
            );
            let [_, found] = lobe_evaluate(&inputs.shape, &inputs.frame, inputs.frame.normal, inputs.wo, light);
            let error = (found / expected - 1.0).abs();
            assert!(error < limit, "{case:?} {light:?}: off by {error:e}");
        }
    });
}
