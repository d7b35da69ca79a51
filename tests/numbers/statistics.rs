//! χ² of every sampler against its density, in f64.

use crate::lobe_cases::{ANGLES_DEG, Case, ROUGHNESS, is_quick, lobes_and_curves, lobes_and_quick_curves};
use glossmith::{
    analysis::{
        chi_square::{ChiSquare, PolarGrid, sidak_level, test_samples, upper_tail},
        histogram::{Histogram, angle_density},
        quadrature::{gauss_legendre, integrate, integrate_hemisphere},
    },
    optics::{
        curve::Curve,
        frame::frame_from_normal,
        lobe::{Facets, Horizon, Lobe, LobeSample, lobe_evaluate, lobe_sample, raw_weight},
        random::{Sequence, random_pair, random_state},
        vector::{Vec3, vec3},
    },
};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Probability that chance alone fails a right sampler, over all cases of a test.
const LEVEL: f64 = 1e-3;

/// Samples of a case: they see a density that is off by 13 % in half of its cells with 99.9 %. What is off by 2 % is seen by
/// the samples of `glossmith check` (`tests/suite/check.rs`).
const SAMPLES: u32 = 10_000;
/// Degrees of freedom that are enough.
const CELLS: u32 = 40;

/// Sample number `i` of a case.
fn draw(case: &Case, i: u32) -> LobeSample<f64> {
    let state = random_state(11, 0, case.seed, i, Sequence::Independent);
    let ([a, b], [c, _]) = (random_pair(state, 0), random_pair::<f64>(state, 1));
    lobe_sample(
        &case.shape(),
        &case.frame(),
        case.surface_normal(),
        case.wo(),
        [a, b, c],
    )
}

/// So many samples of a case; nothing where one was absorbed.
fn drawn(case: &Case, count: u32) -> Vec<Option<Vec3<f64>>> {
    let kept = |sample: LobeSample<f64>| (sample.weight != 0.0).then_some(sample.wi);
    (0..count).map(|i| kept(draw(case, i))).collect()
}

/// The test of samples against the density.
fn chi_square(case: &Case, samples: &[Option<Vec3<f64>>]) -> ChiSquare {
    let mirror = case.middle();
    let grid = PolarGrid::following(
        frame_from_normal(mirror),
        12,
        12,
        samples.iter().flatten().take(4000).copied(),
    );
    let (shape, frame, normal, wo) = (case.shape(), case.frame(), case.surface_normal(), case.wo());
    // Both horizons, the plane at which Phong's lobe ends, and what the mirror policy makes of them.
    let folded = |plane: Vec3<f64>| plane.reflected_at_plane(normal);
    let cuts = [normal, frame.normal, mirror, folded(frame.normal), folded(mirror)];
    test_samples(&grid, samples, &cuts, |wi| {
        lobe_evaluate(&shape, &frame, normal, wo, wi)[1]
    })
}

/// Fails with the cases whose samples do not follow their density.
fn assert_all_follow(cases: &[Case]) {
    assert_follow(cases, 0.9);
}

/// The same where at least this share of the cases has cells enough.
fn assert_follow(cases: &[Case], share: f64) {
    let limit = sidak_level(LEVEL, cases.len());
    let outcomes: Vec<_> = cases
        .par_iter()
        .map(|case| {
            let test = |samples| chi_square(case, &drawn(case, samples));
            let found = test(SAMPLES);
            // What has too few cells gets more samples.
            let is_coarse = found.degrees_of_freedom < CELLS;
            (case, if is_coarse { test(4 * SAMPLES) } else { found })
        })
        .collect();
    let failed = outcomes.iter().filter(|(_, outcome)| outcome.p_value <= limit);
    let failed: Vec<String> = failed.map(|(case, outcome)| format!("{case:?} {outcome:?}")).collect();
    assert!(
        failed.is_empty(),
        "{} of {} cases fail:\n{}",
        failed.len(),
        cases.len(),
        failed.join("\n")
    );
    // Had pooling left nothing to test, nothing could have failed.
    let tested = outcomes
        .iter()
        .filter(|(_, outcome)| outcome.degrees_of_freedom >= CELLS)
        .count();
    assert!(
        tested as f64 >= share * cases.len() as f64,
        "only {tested} of {} cases have cells enough",
        cases.len()
    );
    // Right p-values are uniform: as many below a half as above, and not all of them at 1.
    let small = outcomes.iter().filter(|(_, outcome)| outcome.p_value < 0.5).count() as f64;
    let (middle, sigma) = (0.5 * cases.len() as f64, 0.5 * (cases.len() as f64).sqrt());
    assert!(
        (small - middle).abs() < 5.0 * sigma,
        "{small} of {} p-values are below a half",
        cases.len()
    );
}

/// Of the lobes whose curve is quick to integrate, or of the others.
fn assert_flat_follow(quick: bool) {
    let mut cases = Vec::new();
    for (lobe, curve) in lobes_and_curves() {
        // Above a flat surface the policies differ only for the lobe that draws below it, and not by its curve: so slow
        // curves have the rest of theirs in `make test-thorough`.
        let policies = if lobe == Lobe::Geometric && (is_quick(curve) || cfg!(feature = "thorough")) {
            Horizon::ALL
        } else {
            &[Horizon::Mirror]
        };
        for &horizon in policies {
            cases.extend(Case::grid(lobe, curve, horizon, &[0.0], ROUGHNESS, ANGLES_DEG));
        }
    }
    cases.retain(|case| is_quick(case.curve) == quick);
    assert_all_follow(&cases);
}

#[test]
fn samples_follow_their_densities() {
    assert_flat_follow(true);
}

#[test]
fn samples_of_slow_curves_follow_their_densities() {
    assert_flat_follow(false);
}

/// Of the lobes that can be stretched.
fn assert_stretched_follow(anisotropy: f64) {
    let lobes = lobes_and_quick_curves().into_iter();
    let grid = |(lobe, curve)| Case::grid(lobe, curve, Horizon::Mirror, &[anisotropy], ROUGHNESS, ANGLES_DEG);
    let cases: Vec<_> = lobes.filter(|(lobe, _)| lobe.is_anisotropic()).flat_map(grid).collect();
    assert_all_follow(&cases);
}

#[test]
fn stretched_samples_follow_their_densities() {
    assert_stretched_follow(0.7);
}

#[test]
fn samples_stretched_across_follow_their_densities() {
    assert_stretched_follow(-0.7);
}

/// Lobes turned about the refracted direction, into glass and out of it (beyond the critical angle they reflect): every
/// lobe, every policy on one of the sides.
#[test]
fn refracted_samples_follow_their_densities() {
    let (entering, leaving) = (1.5, 1.0 / 1.5);
    let of_geometric = [
        (Horizon::Mirror, entering, 0.0),
        (Horizon::Mirror, leaving, 0.0),
        (Horizon::Mirror, entering, 0.7),
        (Horizon::Absorb, leaving, 0.0),
        (Horizon::None, entering, 0.0),
    ];
    let mut cases = Vec::new();
    for (lobe, curve) in lobes_and_quick_curves() {
        if lobe.facets() != Facets::None {
            continue;
        }
        let kinds = if lobe == Lobe::Geometric {
            &of_geometric[..]
        } else {
            &of_geometric[..2]
        };
        for &(horizon, eta, stretch) in kinds {
            let grid = Case::grid(lobe, curve, horizon, &[stretch], ROUGHNESS, ANGLES_DEG);
            cases.extend(refracting(grid, eta, cases.len()));
        }
    }
    assert_all_follow(&cases);
}

/// The microfacet lobes, each facet refracting by itself.
fn assert_refracted_at_facets_follow(eta: f64, share: f64) {
    let mut cases = Vec::new();
    for &lobe in Lobe::ALL.iter().filter(|lobe| lobe.facets() != Facets::None) {
        let stretched: &[f64] = if lobe.is_anisotropic() { &[0.0, 0.7] } else { &[0.0] };
        let grid = Case::grid(lobe, Curve::Sqrt, Horizon::Mirror, stretched, ROUGHNESS, ANGLES_DEG);
        cases.extend(refracting(grid, eta, cases.len()));
    }
    // Beyond the critical angle narrow lobes refract next to nothing.
    cases.retain(|case| eta > 1.0 || case.angle_deg < 45.0 || case.roughness >= 0.3);
    assert_follow(&cases, share);
}

#[test]
fn samples_refracted_at_facets_follow_their_densities() {
    assert_refracted_at_facets_follow(1.5, 0.95);
}

#[test]
fn samples_refracted_at_facets_of_diamond_follow_their_densities() {
    assert_refracted_at_facets_follow(2.4, 0.95);
}

#[test]
fn samples_refracted_out_of_glass_at_facets_follow_their_densities() {
    // Beyond the critical angle facets let light out into a few cells only.
    assert_refracted_at_facets_follow(1.0 / 1.5, 0.68);
}

/// The cases with another index, and seeds of their own.
fn refracting(cases: Vec<Case>, eta: f64, first: usize) -> impl Iterator<Item = Case> {
    (0x8000 + first as u32..)
        .zip(cases)
        .map(move |(seed, case)| Case { eta, seed, ..case })
}

/// Where the shading normal leans, samples cross either of two horizons.
#[test]
fn samples_over_a_leaning_normal_follow_their_densities() {
    let mut cases = Vec::new();
    for (lobe, curve) in lobes_and_quick_curves() {
        for horizon in [Horizon::Mirror, Horizon::Absorb] {
            for mut case in Case::grid(lobe, curve, horizon, &[0.0], &[0.1, 0.6, 1.0], &[0.0, 45.0, 70.0]) {
                case.lean_deg = if case.seed % 2 == 0 { 20.0 } else { -15.0 };
                cases.push(case);
            }
        }
    }
    assert_all_follow(&cases);
}

/// Evaluate over density is the weight that the sampler hands out.
#[test]
fn weights_are_evaluate_over_density() {
    for (lobe, curve) in lobes_and_curves() {
        let grid = Case::grid(lobe, curve, Horizon::Mirror, &[0.0, 0.5], ROUGHNESS, ANGLES_DEG);
        let indices = [0.0, 1.5, 1.0 / 1.5];
        for case in grid
            .iter()
            .flat_map(|case| indices.map(|eta| Case { eta, ..case.clone() }))
        {
            for i in 0..50 {
                let sample = draw(&case, i);
                let (shape, frame) = (case.shape(), case.frame());
                let [value, density] = lobe_evaluate(&shape, &frame, frame.normal, case.wo(), sample.wi);
                if sample.weight > 0.0 {
                    let error = (value - sample.weight * density).abs();
                    assert!(
                        error <= 1e-9 * value.max(1e-9),
                        "{case:?}: {value} {density} {sample:?}"
                    );
                    if case.eta != 0.0 {
                        continue;
                    }
                    // Were both computed from a weight of 1, the check above would prove nothing.
                    let weight = raw_weight(&shape, &frame, case.wo(), sample.wi);
                    assert!((weight - sample.weight).abs() <= 1e-12 * weight, "{case:?}");
                }
            }
        }
    }
}

#[track_caller]
fn assert_near(found: f64, expected: f64, tolerance: f64) {
    let error = (found / expected - 1.0).abs();
    assert!(error < tolerance, "{found} instead of {expected}: off by {error}");
}

#[test]
fn the_tail_of_chi_square_is_a_poisson_sum_for_even_degrees_of_freedom() {
    // Γ(n, x)/Γ(n) = e^−x Σ x^k/k! over k < n.
    for n in [1, 2, 3, 7, 20, 60] {
        for x in [0.01, 0.5, 1.0, 3.0, 9.5, 21.0, 40.0, 80.0, 200.0] {
            let terms = (1..n).scan(1.0, |term, k| {
                *term *= x / f64::from(k);
                Some(*term)
            });
            let expected = (-x).exp() * (1.0 + terms.sum::<f64>());
            assert_near(upper_tail(2.0 * x, f64::from(2 * n)), expected, 1e-12);
        }
    }
    for (freedom, quantile) in [
        (1.0, 3.841_458_820_694_124),
        (10.0, 18.307_038_053_275_146),
        (100.0, 124.342_113_404_004_07),
    ] {
        assert_near(upper_tail(quantile, freedom), 0.05, 1e-12);
    }
    assert_eq!(upper_tail(2e6, 1.0), 0.0);
}

#[test]
fn gauss_legendre_is_exact_for_polynomials() {
    for order in [1, 2, 5, 16, 128] {
        let rule = gauss_legendre(order);
        let degree = 2 * order as i32 - 2;
        let value = integrate(&rule, -1.0, 1.0, |x| x.powi(degree));
        assert!(
            (value - 2.0 / f64::from(degree + 1)).abs() < 1e-13,
            "order {order}: {value}"
        );
    }
    assert!((integrate_hemisphere(8, |w| w.z * w.z) - TAU / 3.0).abs() < 1e-12);
}

#[test]
fn the_density_of_an_angle_is_that_of_all_directions_around_the_axis() {
    let axis = vec3(0.6, 0.0, 0.8);
    let frame = frame_from_normal(axis);
    // ∫ (t·ω)² dφ sin α = π sin³ α about the tangent t.
    for alpha_rad in [0.3_f64, 1.2, 2.5] {
        let found = angle_density(&frame, alpha_rad, 64, |wi| frame.tangent.dot(wi).powi(2));
        let expected = PI * alpha_rad.sin().powi(3);
        assert!((found - expected).abs() < 1e-12, "{alpha_rad}: {found} {expected}");
    }
}

#[test]
fn values_are_counted_in_their_bins_and_densities_add_up() {
    let mut histogram = Histogram::new(1.0, 3.0, 4);
    for value in [1.0, 1.49, 2.6, 3.0, 0.99, 3.01, f64::NAN] {
        histogram.add(value);
    }
    assert_eq!(histogram.counts, [2, 0, 0, 2], "the upper end is the last bin's");
    assert_eq!(histogram.total, 7);
    let within: f64 = histogram.density().iter().map(|[_, density]| density * 0.5).sum();
    assert!((within - 4.0 / 7.0).abs() < 1e-12, "{within}");
}
