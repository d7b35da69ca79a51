//! Studies: the race and the ledger, in numbers small enough for a test.

use super::{cli_support::Workplace, renders::adjust};
use glossmith::{
    document::{Document, MaterialSettings},
    optics::{fresnel::Fresnel, lobe::Lobe},
    render::EngineChoice,
    scene::{ModelSource, environment::EnvironmentSource},
    study::{
        StudyError,
        ledger::{LedgerOptions, ledger},
        race::{Race, RaceOptions, Runner, race},
    },
};
use serde_json::Value;
use std::time::Duration;

fn sphere(side: u32) -> Document {
    let mut document = Document {
        model: ModelSource::Sphere,
        ..Document::default()
    };
    adjust(&mut document, &format!("render.width={side} render.height={side}"));
    document
}

fn quick(names: &[&str]) -> RaceOptions {
    let techniques = names.iter().map(|name| name.parse().unwrap()).collect();
    RaceOptions {
        seconds: 0.3,
        noise: 0.05,
        slice: Duration::from_millis(10),
        reference_seconds: 1.0,
        ..RaceOptions::new(EngineChoice::Cpu, techniques)
    }
}

fn run(document: &Document, options: &RaceOptions) -> Race {
    race(document, options, &mut |_| true).unwrap()
}

fn runner<'a>(race: &'a Race, name: &str) -> &'a Runner {
    let found = race.runners.iter().find(|runner| runner.technique.to_string() == name);
    found.unwrap_or_else(|| panic!("{name} takes part"))
}

#[test]
fn a_race_tells_noise_from_bias() {
    let mut document = sphere(24);
    document.ground = true;
    // Even light, under which a bias of 2 % is told at once, also where other tests take their part of the processor.
    document.lighting.environment = EnvironmentSource::Furnace;
    let race = run(
        &document,
        &quick(&["strategy=light", "bounces=1", "fresnel=exact", "strategy=mis"]),
    );
    // What changes nothing does not take part twice.
    assert_eq!(
        race.runners.len(),
        4,
        "{:?}",
        race.runners.iter().map(|r| &r.label).collect::<Vec<_>>()
    );
    for runner in &race.runners {
        assert!(
            runner.seconds >= 0.29 && runner.seconds < 1.5,
            "{}: {}",
            runner.label,
            runner.seconds
        );
        assert!(
            runner.error.value > 0.0 && runner.error.low <= runner.error.value,
            "{}",
            runner.label
        );
        assert!(
            runner.time_to_noise > 0.0 && runner.time_to_noise.is_finite(),
            "{}",
            runner.label
        );
        // The error against a reference is about the one that a picture tells of itself.
        let ratio = runner.error.value / runner.estimated_noise;
        assert!((0.5..2.0).contains(&ratio), "{}: {ratio}", runner.label);
        assert_eq!(runner.equal_time.pixels.len(), 24 * 24);
        assert_eq!(runner.equal_error.pixels.len(), 24 * 24);
    }
    // The document uses Schlick's approximation; the most accurate setting does not.
    let [as_is, one] = ["as-is", "bounces=1"].map(|name| runner(&race, name));
    assert!(runner(&race, "fresnel=exact").is_unbiased);
    assert!(!as_is.is_unbiased && as_is.bias.is_resolved(), "{:?}", as_is.bias);
    // Light between ground and sphere is more than what Fresnel changes.
    assert!(one.bias.low > as_is.bias.high, "{:?} {:?}", one.bias, as_is.bias);
    // Strategies converge to the same picture.
    assert_eq!(runner(&race, "strategy=light").bias, as_is.bias);
    assert!(race.runners.iter().any(|runner| runner.is_on_front));
    let slowest = race.runners.iter().map(|r| r.error.value).fold(0.0, f64::max);
    assert_eq!(race.equal_error, slowest);
    for runner in race.runners.iter().filter(|runner| runner.error.value < 0.3 * slowest) {
        assert!(runner.equal_error_seconds < 0.5 * runner.seconds, "{}", runner.label);
    }
}

/// What single scattering loses is a bias that multiple scattering has not.
#[test]
fn a_race_shows_what_multiple_scattering_brings() {
    let mut document = sphere(16);
    let material = &mut document.materials[0];
    (material.lobe, material.roughness, material.base_color) = (Lobe::Ggx, 0.9, [1.0; 3]);
    let techniques = ["scattering=multiple", "scattering=single"];
    let race = run(&document, &quick(&techniques));
    let single = &runner(&race, "scattering=single").bias;
    assert!(single.is_resolved() && single.value > 0.1, "{single:?}");
    // The document scatters so already: with it the other takes part under its own name alone.
    let multiple = race
        .runners
        .iter()
        .filter(|runner| !runner.technique.to_string().contains("single"));
    let most = multiple.map(|runner| runner.bias.low).fold(0.0, f64::max);
    assert!(most < 0.5 * single.value, "{most}, {single:?}");
}

#[test]
fn a_race_is_stopped_when_it_is_no_longer_wanted() {
    let mut told = 0;
    let stopped = race(&sphere(16), &quick(&["bounces=1"]), &mut |_| {
        told += 1;
        told < 3
    });
    assert!(matches!(stopped, Err(StudyError::Stopped)));
    assert_eq!(told, 3);
}

#[test]
fn a_black_picture_has_no_relative_error() {
    let mut document = sphere(16);
    document.lighting.strength = 0.0;
    let error = race(&document, &quick(&[]), &mut |_| true);
    assert!(matches!(error, Err(StudyError::Black)));
}

#[test]
fn the_ledger_tells_what_is_known_of_a_scene() {
    let mut document = sphere(24);
    document.ground = true;
    document.materials = vec![MaterialSettings {
        metalness: 0.0,
        fresnel: Fresnel::Dielectric,
        ..MaterialSettings::default()
    }];
    let options = LedgerOptions {
        turns: 5,
        slice: Duration::from_millis(20),
        // However slow the machine: of four samples on one side and forty on the other the noise alone is a tenth.
        samples_min: 64.0,
        ..LedgerOptions::new(EngineChoice::Cpu)
    };
    let found = ledger(&document, &options, &mut |_| true).unwrap();
    let entry = |name: &str| found.entries.iter().find(|entry| entry.name == name).unwrap();
    for entry in &found.entries {
        assert!(entry.ms_with > 0.0 && entry.ms_without > 0.0, "{}", entry.words);
        assert!(
            entry.share_of_frame.is_finite() && entry.noise_share.is_finite(),
            "{}",
            entry.words
        );
        assert!(entry.words.starts_with(&entry.label), "{}", entry.words);
    }
    // Half of the picture is ground, nearly as bright as what is seen without it.
    assert!(entry("ground").picture_change.low > 0.05, "{}", entry("ground").words);
    let fresnel = entry("fresnel");
    assert!(
        fresnel.words.starts_with("Exact Fresnel (instead of Schlick's): "),
        "{}",
        fresnel.words
    );
    // They differ by some percent of the reflection off the normal, which is a small part of a plastic's light.
    assert!(fresnel.picture_change.high < 0.1, "{}", fresnel.words);
    let strategy = entry("strategy");
    assert!(
        strategy.is_picture_kept && strategy.noise_share < -0.5,
        "{}",
        strategy.words
    );
    assert!(
        strategy.words.contains("removes") && strategy.words.contains("leaves the image"),
        "{}",
        strategy.words
    );
    assert!(entry("kernel").is_picture_kept && entry("sequence").is_picture_kept);
    assert!(
        found.entries.iter().all(|entry| entry.name != "coat"),
        "what is not there has no line"
    );
}

fn json(workplace: &Workplace, name: &str) -> Value {
    workplace.json(name)
}

fn number(value: &Value, key: &str) -> f64 {
    let found = value[key].as_f64().unwrap_or_else(|| panic!("{key} in {value}"));
    assert!(found.is_finite(), "{key}: {found}");
    found
}

fn has_plots(workplace: &Workplace, folder: &str, names: &[&str]) {
    for name in names {
        let svg = workplace.read(&format!("{folder}/{name}.svg"));
        assert!(svg.starts_with("<svg"), "{name}");
        let picture = image::open(workplace.path(format!("{folder}/{name}.png"))).unwrap();
        assert!(picture.width() > 400 && picture.height() > 100, "{name}");
    }
}

#[test]
fn accuracy_writes_the_race() {
    let workplace = Workplace::new();
    workplace.done(
        "study accuracy --quick --engine cpu --model sphere --size 24x24 --technique strategy --technique bounces=1 \
         --output found",
    );
    let race = json(&workplace, "found/accuracy.json");
    assert_eq!(race["machine"]["engine"], "cpu");
    let runners = race["runners"].as_array().unwrap();
    assert_eq!(runners.len(), 4);
    for runner in runners {
        assert!(runner["technique"].is_string() && runner["is_on_front"].is_boolean());
        for key in [
            "seconds",
            "samples_per_pixel",
            "time_to_noise",
            "equal_error_seconds",
            "told_noise",
        ] {
            assert!(number(runner, key) > 0.0, "{key} of {runner}");
        }
        for distance in ["error", "bias"] {
            let [low, value, high] = ["low", "value", "high"].map(|key| number(&runner[distance], key));
            assert!(low <= value && value <= high, "{runner}");
        }
    }
    let csv = workplace.read("found/accuracy.csv");
    assert_eq!(csv.lines().count(), 5);
    assert!(csv.starts_with("technique,label,seconds,"));
    has_plots(&workplace, "found", &["accuracy"]);
    for sheet in ["equal-time", "equal-error"] {
        assert!(
            image::open(workplace.path(format!("found/{sheet}.png")))
                .unwrap()
                .width()
                >= 400,
            "{sheet}"
        );
    }
    workplace.refused(2, "study accuracy --technique velvet", &["velvet", "strategy"]);
    workplace.refused(2, "study accuracy --technique bounces=99", &["bounces", "64"]);
}
