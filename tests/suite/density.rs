//! The geometric lobe's density in f32 against quadrature in f64: section 4 of docs/MATHEMATICS.md as it is written there,
//! apart from the closed forms of `optics::chord`. And no direction for which it is not a number.

use std::f64::consts::PI;

use glossmith::analysis::quadrature::{gauss_legendre, integrate};
use glossmith::optics::curve::{CUSTOM_INTERVALS, Curve, curve_distance_max, curve_h};
use glossmith::optics::frame::Frame;
use glossmith::optics::lobe::{Horizon, Lobe, LobeShape, lobe_evaluate, lobe_sample, stretch_from_anisotropy};
use glossmith::optics::random::{Sequence, random_pair, random_state};
use glossmith::optics::real::Real;
use glossmith::optics::vector::{Vec3, vec3};
use rayon::prelude::*;

use crate::lobe_cases::{ANGLES_DEG, Case, ROUGHNESS};

/// The inputs of a case in a precision: those of f32, so that both see the same directions.
struct Inputs<T> {
    shape: LobeShape<'static, T>,
    frame: Frame<T>,
    wo: Vec3<T>,
}

fn inputs<T: Real>(case: &Case) -> Inputs<T> {
    let single = |v: Vec3<f64>| Vec3::from_f32(v.to_f32());
    let number = |x: f64| T::from_f64(f64::from(x as f32));
    let frame = case.frame();
    let shape = case.shape();
    Inputs {
        shape: LobeShape {
            lobe: shape.lobe,
            curve: shape.curve,
            horizon: shape.horizon,
            roughness: number(shape.roughness),
            anisotropy: number(shape.anisotropy),
            eta: number(shape.eta),
            table: shape.table,
        },
        frame: Frame {
            tangent: single(frame.tangent),
            bitangent: single(frame.bitangent),
            normal: single(frame.normal),
        },
        wo: single(case.wo()),
    }
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
fn axis_and_middle(inputs: &Inputs<f64>) -> [Vec3<f64>; 2] {
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

/// The density after the horizon policy.
fn reference(inputs: &Inputs<f64>, rules: &Rules, light: Vec3<f64>) -> f64 {
    let [axis, middle] = axis_and_middle(inputs);
    let raw = |light| raw_reference(inputs, rules, axis, middle, light);
    let height = axis.dot(light);
    match inputs.shape.horizon {
        Horizon::None => raw(light),
        _ if height <= 0.0 => 0.0,
        Horizon::Absorb => raw(light),
        Horizon::Mirror => raw(light) + raw(light - axis * (2.0 * height)),
    }
}

/// The density before the policy: turned into the frame where the lobe is a unit ball.
fn raw_reference(inputs: &Inputs<f64>, rules: &Rules, axis: Vec3<f64>, middle: Vec3<f64>, light: Vec3<f64>) -> f64 {
    let Inputs { shape, frame, .. } = inputs;
    let stretch = stretch_from_anisotropy(shape.anisotropy);
    let kappa = shape.roughness;
    let axes = [frame.tangent, frame.bitangent, axis];
    let widths = [kappa * stretch, kappa / stretch, kappa];
    // In this frame the normal is +z.
    let divided = |v: Vec3<f64>| {
        let [x, y, z] = [0, 1, 2].map(|i| axes[i].dot(v) / widths[i]);
        vec3(x, y, z)
    };
    let (a, direction) = (divided(middle) * (1.0 - kappa), divided(light));
    let length = direction.length();
    let jacobian = widths[0] * widths[1] * widths[2] * length.powi(3);
    ball_density(shape, rules, a, direction / length) / jacobian
}

/// p(ω) = 1/(4π√A) ∫ t² h(D) du, n = +z.
fn ball_density(shape: &LobeShape<'_, f64>, rules: &Rules, a: Vec3<f64>, omega: Vec3<f64>) -> f64 {
    let kappa = shape.roughness;
    let k = (1.0 - kappa) * (1.0 + kappa);
    let (nu, c, mu) = (omega.z, a.z, a.dot(omega));
    let off = a.cross(omega).length();
    let big_a = kappa * kappa * nu * nu + k;
    let big_b = kappa * kappa * nu * c + k * mu;
    let n = vec3(0.0, 0.0, 1.0);
    let lean = n * -mu + a * nu;
    // |νa − cω|², the part along ω and the part across it.
    let lean = {
        let v = a * nu - omega * c;
        let _ = lean;
        v.dot(v)
    };
    let delta = k * (kappa * kappa * lean + k * off * off) / big_a;
    if delta == 0.0 {
        // R = 1: the lobe is Lambert's in this frame, whatever the curve.
        return nu.max(0.0) / PI;
    }
    let (root, slope) = (big_a.sqrt(), (delta / big_a).sqrt());
    let reach: f64 = curve_distance_max(shape.curve, shape.table);
    // Where the ray crosses the sphere of the points at a distance D.
    let crossings = |d: f64| {
        let centre = mu + d * kappa * nu;
        let square = centre * centre - (a.dot(a) + 2.0 * d * kappa * c - d * d * k);
        (square > 0.0).then(|| [centre - square.sqrt(), centre + square.sqrt()])
    };
    let Some([first, last]) = crossings(reach) else {
        return 0.0;
    };
    let first = first.max(0.0);
    if last <= first {
        return 0.0;
    }
    let u_of = |t: f64| ((t - big_b / big_a) / slope).asinh();
    let integrand = |u: f64| {
        let t = big_b / big_a + slope * u.sinh();
        let s = delta.sqrt() * u.cosh();
        let square = (t - mu).powi(2) + off * off;
        let lift = t * nu - c;
        let distance = if lift >= 0.0 {
            square / (kappa * lift + s)
        } else {
            (s - kappa * lift) / k
        };
        t * t * curve_h(shape.curve, shape.table, distance)
    };
    let mut ends = vec![first, last];
    if shape.curve == Curve::Custom {
        let nodes = (1..CUSTOM_INTERVALS).map(|i| reach * i as f64 / CUSTOM_INTERVALS as f64);
        ends.extend(nodes.filter_map(crossings).flatten().filter(|t| *t > first && *t < last));
        ends.sort_by(f64::total_cmp);
    }
    let rule = if ends.len() == 2 { &rules.whole } else { &rules.piece };
    let pieces = ends.windows(2).map(|piece| integrate(rule, u_of(piece[0]), u_of(piece[1]), integrand));
    pieces.sum::<f64>() / (4.0 * PI * root)
}

#[derive(Clone, Copy, Debug)]
struct Kind { stretch: f64, eta: f64 }

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for &curve in Curve::ALL {
        for &horizon in Horizon::ALL {
            for (stretch, eta) in [(0.0, 0.0), (0.7, 0.0), (0.0, 1.5), (0.0, 1.0 / 1.5), (-0.5, 1.5)] {
                let grid = Case::grid(Lobe::Geometric, curve, horizon, &[stretch], &ROUGHNESS, &ANGLES_DEG);
                cases.extend(grid.into_iter().map(|case| Case { eta, ..case }));
            }
        }
    }
    cases
}

#[test]
fn explore() {
    let rules = Rules::new(128);
    let more = Rules::new(512);
    let count = 500;
    let mut out: Vec<(String, Vec<f64>, f64, f64)> = Vec::new();
    let start = std::time::Instant::now();
    let results: Vec<_> = cases().par_iter().map(|case| {
        let single = inputs::<f32>(case);
        let double = inputs::<f64>(case);
        let mut errors = Vec::new();
        let mut conv = 0.0f64;
        let mut e64 = 0.0f64;
        for i in 0..count {
            let state = random_state(17, 0, case.seed, i, Sequence::Independent);
            let ([a, b], [c, _]) = (random_pair(state, 0), random_pair::<f32>(state, 1));
            let drawn = lobe_sample(&single.shape, &single.frame, single.frame.normal, single.wo, [a, b, c]);
            if drawn.weight <= 0.0 { continue; }
            let [_, p] = lobe_evaluate(&single.shape, &single.frame, single.frame.normal, single.wo, drawn.wi);
            let wi = Vec3::<f64>::from_f32(drawn.wi.to_f32());
            let q = reference(&double, &rules, wi);
            if i < 20 { let r = reference(&double, &more, wi); conv = conv.max((q / r - 1.0).abs()); }
            let [_, d] = lobe_evaluate(&double.shape, &double.frame, double.frame.normal, double.wo, wi);
            e64 = e64.max((d / q - 1.0).abs());
            errors.push((f64::from(p) / q - 1.0).abs());
        }
        (case.clone(), errors, conv, e64)
    }).collect();
    println!("{:?}", start.elapsed());
    for (case, errors, conv, e64) in results {
        let name = format!("{} R {} st {} eta {:.2}", case.curve.name(), case.roughness, case.anisotropy, case.eta);
        match out.iter_mut().find(|o| o.0 == name) {
            Some(o) => { o.1.extend(errors); o.2 = o.2.max(conv); o.3 = o.3.max(e64); }
            None => out.push((name, errors, conv, e64)),
        }
    }
    for (name, mut errors, conv, e64) in out {
        errors.sort_by(f64::total_cmp);
        let n = errors.len();
        println!("{name}: n {n} median {:.1e} 99% {:.1e} 99.9% {:.1e} max {:.1e}  conv {conv:.1e} f64 {e64:.1e}", errors[n/2], errors[n*99/100], errors[n*999/1000], errors[n-1]);
    }
}
