//! The checks that `glossmith check` runs: χ² of every sampler on both engines, and that the tests can fail.

use std::sync::atomic::AtomicBool;

use glossmith::{
    job::scatter::ScatterRequest,
    optics::lobe::Lobe,
    render::{EngineChoice, Prober},
    study::check::{Check, CheckOptions, chi_square, run, sample_cases},
};

/// The quick grid holds every lobe and curve as a reflecting, a refracting and, where it can be, a stretched one.
#[test]
fn the_quick_cases_miss_no_kind_of_lobe() {
    for thorough in [false, true] {
        let cases = sample_cases(thorough);
        let lobes = Lobe::ALL.iter();
        for (&lobe, curve) in lobes.flat_map(|lobe| lobe.curves().iter().map(move |&curve| (lobe, curve))) {
            for (is_refracting, is_stretched) in [(false, false), (true, false), (false, true), (true, true)] {
                let kind = (lobe, curve, is_refracting, is_stretched);
                let mut kinds = cases.iter().map(|ScatterRequest { model, .. }| {
                    (model.lobe, model.curve, model.eta != 0.0, model.anisotropy != 0.0)
                });
                assert_eq!(
                    kinds.any(|of| of == kind),
                    lobe.is_anisotropic() || !is_stretched,
                    "{kind:?}"
                );
            }
        }
        println!("thorough {thorough}: {} cases", cases.len());
    }
}

/// A density that is off by 2 % on one side and right in total is found.
#[test]
fn a_density_off_by_two_per_cent_fails() {
    for case in sample_cases(false)
        .into_iter()
        .filter(|case| case.model.roughness as f32 == 0.6)
        .step_by(12)
    {
        let case = ScatterRequest {
            count: 2_000_000,
            ..case
        };
        let cloud = Prober::Cpu.scatter(&case).unwrap();
        let tilted = chi_square(&case, &cloud, |wi| if wi.y > 0.0 { 1.02 } else { 0.98 });
        assert!(tilted < 1e-6, "{case:?}: p = {tilted}");
        let right = chi_square(&case, &cloud, |_| 1.0);
        assert!(right > 1e-5, "{case:?}: p = {right}");
    }
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "thorough")]
fn the_whole_check_passes() {
    for engine in [EngineChoice::Cpu, EngineChoice::Gpu] {
        let checks = run(
            CheckOptions {
                engine,
                thorough: false,
            },
            &AtomicBool::new(false),
            |_, _| {},
        )
        .unwrap()
        .expect("nobody stops it");
        let failed: Vec<_> = checks.iter().filter(|check| !check.passed).collect();
        assert!(failed.is_empty(), "{engine:?}: {failed:#?}");
        assert!(checks.len() > 100);
        // Every lobe's samples on this engine against their density.
        let sampled = checks.iter().filter(|check| check.group == "samples").count();
        assert_eq!(sampled, sample_cases(false).len());
    }
}

#[test]
fn limits_have_the_digits_that_decide() {
    for (measure, value, limit, texts) in [
        ("error", 2.05e-7, 2.5e-7, ["2.05e-7", "2.5e-7"]),
        ("error", 2.50004e-7, 2.5e-7, ["2.50004e-7", "2.5e-7"]),
        ("error", 0.0, 0.0, ["0.00e0", "0e0"]),
        ("p", 1.6674e-6, 1.66717e-6, ["1.6674e-6", "1.6672e-6"]),
        ("sigma", 5.0, 5.0, ["5.00e0", "5e0"]),
        ("count", 835.0, 0.0, ["835", "0"]),
    ] {
        assert_eq!(Check::new("a", "b", measure, value, limit).texts(), texts);
    }
}

#[test]
fn a_stopped_check_has_no_verdict() {
    let stop = AtomicBool::new(false);
    let options = CheckOptions {
        engine: EngineChoice::Cpu,
        thorough: true,
    };
    let told = std::cell::RefCell::new(Vec::new());
    let checks = run(options, &stop, |group, _| {
        told.borrow_mut().push(group.to_owned());
        stop.store(true, std::sync::atomic::Ordering::Relaxed);
    });
    assert!(checks.expect("the processor").is_none());
    assert_eq!(
        told.into_inner(),
        ["samples against densities"],
        "nothing is begun any more"
    );
}
