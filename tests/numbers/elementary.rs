//! Known values of elementary functions: Fresnel's equations, points of the Sobol sequence, and the step from a mirror to a lobe.

use std::collections::HashSet;

use glossmith::optics::{
    curve::Curve,
    fresnel::{
        METALS, fresnel_conductor, fresnel_dielectric, fresnel_f0, fresnel_metal, fresnel_schlick, fresnel_transmitted,
    },
    lobe::{Horizon, Lobe, LobeShape, MIRROR_WIDTH, is_mirror, lobe_sample},
    random::{Sequence, random_pair, random_pair_bits, random_state},
    vector::{Vec3, vec3},
};

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
    let of_metals = METALS.iter().flat_map(|metal| std::iter::zip(metal.eta, metal.k));
    // A conductor that absorbs nothing is a dielectric.
    for (eta, k) in of_metals.chain(INDICES.map(|index| (index, 0.0))) {
        for step in 0..=100 {
            let cosine = f64::from(step) / 100.0;
            let (value, expected) = (fresnel_conductor(cosine, eta, k), complex_fresnel(cosine, eta, k));
            let what = format!("{eta} + {k}i at cosine {cosine}");
            assert!((value - expected).abs() < 1e-7, "{what}: {value}, expected {expected}");
        }
    }
}

/// At a cosine of 1/7 the edge tint is what is left of Schlick's reflectance; head-on and at grazing angles nothing changes.
#[test]
fn metals_of_colours_have_their_closed_values() {
    let (f0, tint, seventh) = (vec3(0.04, 0.5, 1.0), vec3(0.3, 0.8, 1.0), 1.0 / 7.0);
    // At 60 degrees 1 - cos is a half: 1/32 of the way.
    assert!((fresnel_schlick(f0, 0.5_f64).x - (0.04 + 0.96 / 32.0)).abs() < 1e-15);
    let off = fresnel_metal(f0, tint, seventh) - fresnel_schlick(f0, seventh) * tint;
    assert!(off.map(f64::abs).max_component() < 1e-12, "{off:?}");
    for tint in [tint, Vec3::splat(1.0)] {
        assert_eq!(
            [1.0, 0.0].map(|cosine| fresnel_metal(f0, tint, cosine)),
            [f0, Vec3::splat(1.0)]
        );
    }
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
