//! The checks that `glossmith check` runs: χ² of every sampler on both engines, and that the tests can fail.

use glossmith::analysis::chi_square::sidak_level;
use glossmith::analysis::scatter::{ScatterCloud, ScatterRequest};
use glossmith::cpu;
use glossmith::render::check::{CheckOptions, chi_square, run, sample_cases};
use glossmith::render::{EngineChoice, Sampler};
use rayon::prelude::*;

/// Fails where a case's samples do not follow its density.
fn assert_all_follow(draw: impl Fn(&ScatterRequest) -> ScatterCloud) {
    let cases = sample_cases(false);
    let clouds: Vec<_> = cases.iter().map(draw).collect();
    let limit = sidak_level(1e-3, cases.len());
    let failed: Vec<_> = cases
        .par_iter()
        .zip(&clouds)
        .map(|(case, cloud)| (case, chi_square(case, cloud, |_| 1.0)))
        .filter(|(_, p)| *p <= limit)
        .map(|(case, p)| format!("{case:?}: p = {p:e}"))
        .collect();
    assert!(
        failed.is_empty(),
        "{} of {} cases fail:\n{}",
        failed.len(),
        cases.len(),
        failed.join("\n")
    );
}

#[test]
fn processor_samples_follow_their_densities() {
    assert_all_follow(cpu::scatter::scatter);
}

#[test]
fn gpu_samples_follow_their_densities() {
    let sampler = Sampler::open(EngineChoice::Gpu).expect("a Vulkan driver: install mesa-vulkan-drivers");
    assert_all_follow(|case| sampler.draw(case).unwrap());
}

/// A density that is off by 2 % on one side and right in total is found.
#[test]
fn a_density_off_by_two_per_cent_fails() {
    for case in sample_cases(false)
        .into_iter()
        .filter(|case| case.roughness == 0.6)
        .step_by(12)
    {
        let case = ScatterRequest {
            count: 2_000_000,
            ..case
        };
        let cloud = cpu::scatter::scatter(&case);
        let tilted = chi_square(&case, &cloud, |wi| if wi.y > 0.0 { 1.02 } else { 0.98 });
        assert!(tilted < 1e-6, "{case:?}: p = {tilted}");
        let right = chi_square(&case, &cloud, |_| 1.0);
        assert!(right > 1e-5, "{case:?}: p = {right}");
    }
}

#[test]
fn the_whole_check_passes() {
    for engine in [EngineChoice::Cpu, EngineChoice::Gpu] {
        let checks = run(
            CheckOptions {
                engine,
                thorough: false,
            },
            |_| {},
        )
        .unwrap();
        let failed: Vec<_> = checks.iter().filter(|check| !check.passed).collect();
        assert!(failed.is_empty(), "{engine:?}: {failed:#?}");
        assert!(checks.len() > 100);
    }
}
