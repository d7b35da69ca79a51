//! Known values of elementary functions: Fresnel's equations, points of the Sobol sequence, and the step from a mirror to a lobe.

use std::collections::HashSet;

use glossmith::optics::curve::Curve;
use glossmith::optics::fresnel::{
    Fresnel, FresnelTerms, METALS, fresnel, fresnel_conductor, fresnel_dielectric, fresnel_f0, fresnel_left,
    fresnel_schlick, fresnel_transmitted,
};
use glossmith::optics::lobe::{Horizon, Lobe, LobeShape, MIRROR_WIDTH, is_mirror, lobe_sample};
use glossmith::optics::random::{Sequence, random_pair, random_pair_bits, random_state};
use glossmith::optics::thin_film::{FilmTerms, film_path};
use glossmith::optics::vector::{Vec3, vec3};

use crate::lobe_cases::Case;

const INDICES: [f64; 6] = [0.4, 1.0 / 1.5, 1.1, 1.33, 1.5, 2.4];

/// Fresnel's equations as he wrote them, with the sine and the tangent of the angles' difference and sum.
#[test]
fn dielectrics_follow_the_sine_and_the_tangent_law() {
    for ior in INDICES {
        for angle_deg in 1..90 {
            let before = f64::from(angle_deg).to_radians();
            let value = fresnel_dielectric(before.cos(), ior);
            let sine_behind = before.sin() / ior;
            let expected = if sine_behind >= 1.0 {
                1.0
            } else {
                let (less, more) = (before - sine_behind.asin(), before + sine_behind.asin());
                0.5 * ((less.sin() / more.sin()).powi(2) + (less.tan() / more.tan()).powi(2))
            };
            let what = format!("index {ior} at {angle_deg} degrees");
            assert!((value - expected).abs() < 1e-12, "{what}: {value}, expected {expected}");
            let single = f64::from(fresnel_dielectric(before.cos() as f32, ior as f32));
            assert!(
                (single - expected).abs() < 2e-5,
                "{what} in f32: {single}, expected {expected}"
            );
        }
        assert!((fresnel_dielectric(0.0, ior) - 1.0).abs() < 1e-12);
        assert!((fresnel_dielectric(1.0, ior) - fresnel_f0(ior)).abs() < 1e-15);
    }
    assert!((fresnel_f0(1.5_f64) - 0.04).abs() < 1e-15);
}

/// What is let through is what is not reflected, and keeps its digits where that is next to nothing.
#[test]
fn what_is_let_through_keeps_its_digits() {
    for ior in INDICES {
        for angle_deg in [0.0_f64, 10.0, 30.0, 60.0, 85.0, 89.99] {
            let sine_behind = angle_deg.to_radians().sin() / ior;
            if sine_behind >= 1.0 {
                continue;
            }
            let (cosine, behind) = (angle_deg.to_radians().cos(), sine_behind.asin().cos());
            let through = fresnel_transmitted(cosine, behind, ior);
            let reflected = fresnel_dielectric(cosine, ior);
            assert!(
                (through + reflected - 1.0).abs() < 1e-10,
                "index {ior} at {angle_deg} degrees"
            );
        }
        // A hair from grazing: 4 cosθ (1 + ior²)/(2 ior cosθt) in the limit.
        let (cosine, ior) = (1e-9, ior.max(1.1));
        let behind = (1.0 - 1.0 / (ior * ior)).sqrt();
        let expected = 2.0 * cosine * (1.0 + ior * ior) / (ior * behind);
        let single = f64::from(fresnel_transmitted(cosine as f32, behind as f32, ior as f32));
        assert!(
            (single / expected - 1.0).abs() < 1e-6,
            "index {ior}: {single}, expected {expected}"
        );
    }
}

/// What a facet leaves over is one minus what it would reflect untinted.
#[test]
fn what_a_facet_leaves_over_is_what_it_does_not_reflect() {
    for has_film in [false, true] {
        let terms = FresnelTerms {
            model: Fresnel::Dielectric,
            has_film,
            film: FilmTerms {
                weight: 0.6,
                ior: 1.4,
                path: Vec3::from_f64(film_path(0.5).to_f64()),
                ..FilmTerms::none_over(1.5)
            },
            metal_f0: vec3(0.9, 0.6, 0.2),
            metalness: 0.0,
            tint: vec3(1.0, 0.8, 0.1),
            metal_tint: vec3(1.0, 1.0, 1.0),
            edge_tint: vec3(0.5, 1.0, 0.9),
            weight: 0.7,
            ior: 1.5,
            eta: vec3(0.2, 0.9, 1.1),
            k: vec3(3.9, 2.4, 2.1),
            before: 1.0,
        };
        for cosine in [0.02_f64, 0.3, 0.8, 1.0] {
            let behind = (1.0 - (1.0 - cosine * cosine) / 2.25).sqrt();
            let sum = fresnel(&terms.untinted(), cosine) + fresnel_left(&terms, cosine, behind);
            let off = (sum - vec3(1.0, 1.0, 1.0)).map(f64::abs).max_component();
            assert!(off < 1e-12, "at {cosine}, film {has_film}: {sum:?}");
        }
    }
}

/// At Brewster's angle all that is reflected is polarised across: half of ((n^2 - 1)/(n^2 + 1))^2.
#[test]
fn nothing_parallel_is_reflected_at_brewsters_angle() {
    for ior in INDICES {
        let square = ior * ior;
        let expected = 0.5 * ((square - 1.0) / (square + 1.0)).powi(2);
        let value = fresnel_dielectric(ior.atan().cos(), ior);
        assert!(
            (value - expected).abs() < 1e-13,
            "index {ior}: {value}, expected {expected}"
        );
    }
}

/// Fresnel's equations with a complex index, in complex numbers.
fn complex_fresnel(cosine: f64, eta: f64, k: f64) -> f64 {
    // (eta + ik)^2, and the root of that less the squared sine.
    let (re, im) = (eta * eta - k * k, 2.0 * eta * k);
    let (x, y) = (re - (1.0 - cosine * cosine), im);
    let (length, angle) = (x.hypot(y).sqrt(), 0.5 * y.atan2(x));
    let (root_re, root_im) = (length * angle.cos(), length * angle.sin());
    let share = |p: f64, q: f64| {
        // |(p + iq - root)/(p + iq + root)|^2.
        ((p - root_re).powi(2) + (q - root_im).powi(2)) / ((p + root_re).powi(2) + (q + root_im).powi(2))
    };
    0.5 * (share(cosine, 0.0) + share(re * cosine, im * cosine))
}

#[test]
fn conductors_follow_the_complex_equations() {
    for metal in METALS {
        for channel in 0..3 {
            let (eta, k) = (metal.eta[channel], metal.k[channel]);
            for step in 0..=100 {
                let cosine = f64::from(step) / 100.0;
                let (value, expected) = (fresnel_conductor(cosine, eta, k), complex_fresnel(cosine, eta, k));
                let what = format!("{} channel {channel} at cosine {cosine}", metal.name);
                assert!((value - expected).abs() < 1e-9, "{what}: {value}, expected {expected}");
            }
            let head_on = ((eta - 1.0).powi(2) + k * k) / ((eta + 1.0).powi(2) + k * k);
            assert!(
                (fresnel_conductor(1.0, eta, k) - head_on).abs() < 1e-12,
                "{}",
                metal.name
            );
            assert!((fresnel_conductor(0.0, eta, k) - 1.0).abs() < 1e-12, "{}", metal.name);
        }
    }
}

/// A conductor that absorbs nothing is a dielectric.
#[test]
fn conductors_without_absorption_are_dielectrics() {
    for ior in INDICES {
        for step in 0..=100 {
            let cosine = f64::from(step) / 100.0;
            let (value, expected) = (fresnel_conductor(cosine, ior, 0.0), fresnel_dielectric(cosine, ior));
            assert!(
                (value - expected).abs() < 1e-7,
                "index {ior}, cosine {cosine}: {value}, expected {expected}"
            );
        }
    }
}

#[test]
fn schlick_runs_from_normal_incidence_to_one() {
    let f0 = vec3(0.04, 0.5, 1.0);
    assert_eq!(fresnel_schlick(f0, 1.0), f0);
    assert_eq!(fresnel_schlick(f0, 0.0), Vec3::splat(1.0));
    // At 60 degrees 1 - cos is a half: 1/32 of the way.
    assert!((fresnel_schlick(f0, 0.5_f64).x - (0.04 + 0.96 / 32.0)).abs() < 1e-15);
}

/// The first 2^k samples of a pair, and every aligned block of as many after them: one in each elementary interval, for
/// every way of sharing k between the two coordinates.
#[test]
fn sobol_points_fill_elementary_intervals() {
    for (x, y, seed) in [(0, 0, 0), (17, 3, 0), (511, 300, 7), (65_535, 65_535, u32::MAX)] {
        for dimension in [0, 1, 5, 40] {
            let pair = |sample: u32| random_pair_bits(random_state(x, y, seed, sample, Sequence::Sobol), dimension);
            for k in 0..=11 {
                for block in [0, 1, 6] {
                    let points: Vec<_> = (0..1_u32 << k).map(|i| pair((block << k) + i)).collect();
                    for split in 0..=k {
                        let cell =
                            |[a, b]: &[u32; 2]| (u64::from(*a) >> (32 - split), u64::from(*b) >> (32 - (k - split)));
                        let cells: HashSet<_> = points.iter().map(cell).collect();
                        assert_eq!(
                            cells.len(),
                            points.len(),
                            "pixel {x}, {y}, seed {seed}, pair {dimension}: 2^{k} points from block {block}, {split} bits in x"
                        );
                    }
                }
            }
        }
    }
    // Pixels and pairs are scrambled each by itself.
    let first = |x: u32, dimension: u32| random_pair_bits(random_state(x, 0, 0, 0, Sequence::Sobol), dimension);
    let starts: HashSet<_> = (0..16)
        .flat_map(|x| (0..16).map(move |dimension| first(x, dimension)))
        .collect();
    assert_eq!(starts.len(), 256);
}

/// Mean direction and mean weight of a lobe of a width, and whether it is weighed as a mirror.
fn means(lobe: Lobe, width: f64, angle_deg: f64) -> (Vec3<f64>, f64, bool) {
    let roughness = if lobe == Lobe::Geometric { width } else { width.sqrt() };
    let case = Case::new(lobe, Curve::Smooth, Horizon::Mirror, roughness, angle_deg);
    let (shape, frame): (LobeShape<'_, f64>, _) = (case.shape(), case.frame());
    let (mut direction, mut weight) = (Vec3::ZERO, 0.0);
    for i in 0..4096 {
        let state = random_state(3, 0, 0, i, Sequence::Sobol);
        let ([a, b], [c, _]) = (random_pair(state, 0), random_pair::<f64>(state, 1));
        let sample = lobe_sample(&shape, &frame, frame.normal, case.wo(), [a, b, c]);
        direction += sample.wi * (sample.weight / 4096.0);
        weight += sample.weight / 4096.0;
    }
    (direction, weight, is_mirror(&shape))
}

/// Where a lobe stops to be weighed as a mirror neither its middle nor its energy jumps, and both are the mirror's.
#[test]
fn narrow_lobes_go_over_into_mirrors() {
    for &lobe in Lobe::ALL.iter().filter(|lobe| **lobe != Lobe::Lambert) {
        for angle_deg in [0.0, 45.0, 80.0] {
            let below = means(lobe, 0.999 * MIRROR_WIDTH, angle_deg);
            let above = means(lobe, 1.001 * MIRROR_WIDTH, angle_deg);
            assert_eq!((below.2, above.2), (true, false), "{lobe:?}");
            let what = format!("{lobe:?} at {angle_deg} degrees: {below:?} {above:?}");
            assert!(
                (below.0 - above.0).length() < 1e-4 && (below.1 - above.1).abs() < 1e-4,
                "{what}"
            );
            // Lafortune and Willems' model returns the cosine even as a mirror.
            let energy = if lobe == Lobe::Phong {
                angle_deg.to_radians().cos()
            } else {
                1.0
            };
            let mirror = Case::new(lobe, Curve::Smooth, Horizon::Mirror, 0.0, angle_deg).middle() * energy;
            assert!(
                (above.0 - mirror).length() < 3e-3 && (above.1 - energy).abs() < 3e-3,
                "{what}"
            );
        }
    }
}
