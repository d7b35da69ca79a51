//! Displays of the render at every step: an image, its maps and its facts are of one film.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, OnceLock};
use std::time::{Duration, Instant};

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use glossmith::app::actions::{Action, Command};
use glossmith::app::layout::Pane;
use glossmith::app::{App, Options, Resolution};
use glossmith::document::Denoise;
use glossmith::render::EngineChoice;
use glossmith::render::shown::Shown;
use glossmith::render::worker::{Pace, Picture, Snapshot, Worker};
use glossmith::scene::environment::EnvironmentSource;
use glossmith::store::PRESETS;

use super::support::{Random, broken, listen};
use super::ui::options;
use super::worker::{small_document, wait};

/// What of an image is not of its size.
fn faults(picture: &Picture) -> Vec<String> {
    let full = &picture.document.render;
    let size = [full.width, full.height].map(|side| side.div_ceil(picture.reduction));
    let pixels = size.map(|side| side as usize).iter().product::<usize>();
    let facts = picture.facts.as_deref();
    let lengths = [
        ("bytes", Some(picture.rgba.len() / 4)),
        ("pixels", Some(picture.image.pixels.len())),
        ("samples' pixels", Some(picture.samples.pixels.len())),
        ("errors", facts.map(|facts| facts.errors.len())),
        ("numbers of samples", facts.map(|facts| facts.samples.len())),
        ("normals", facts.map(|facts| facts.features.normal.len())),
    ];
    let wrong = lengths
        .into_iter()
        .filter(|(_, found)| found.is_some_and(|found| found != pixels));
    let told = |(what, found): (&str, Option<usize>)| {
        let (of, step) = (picture.map, picture.reduction);
        format!("{what} of {of:?} at 1/{step}: {found:?} instead of {pixels}")
    };
    let mut faults: Vec<String> = wrong.map(told).collect();
    if [picture.width, picture.height] != size {
        faults.push(format!("{} × {} instead of {size:?}", picture.width, picture.height));
    }
    if picture.samples_per_pixel == 0 {
        faults.push("an image without a sample".to_owned());
    }
    faults
}

/// A worker on the CPU, and what is wrong with the images that it publishes: all of them are looked at.
fn watched() -> (Arc<OnceLock<Worker>>, Arc<Mutex<Vec<String>>>) {
    let (desk, wrong): (Arc<OnceLock<Worker>>, Arc<Mutex<Vec<String>>>) = Default::default();
    let look = {
        let (desk, wrong) = (Arc::downgrade(&desk), wrong.clone());
        let last_serial = AtomicU64::new(0);
        move || {
            let Some(desk) = desk.upgrade() else { return };
            if let Some(picture) = desk.get().and_then(|worker| worker.snapshot().picture.clone())
                && last_serial.swap(picture.serial, Relaxed) != picture.serial
            {
                wrong.lock().unwrap().extend(faults(&picture));
            }
        }
    };
    desk.set(Worker::spawn(EngineChoice::Cpu, look).unwrap()).ok().unwrap();
    (desk, wrong)
}

/// Each display is chosen, and the exposure changed, while the first coarse step is shown and the next is being rendered.
#[test]
fn every_display_at_every_step_is_of_one_film() {
    let (desk, wrong) = watched();
    let worker = desk.get().unwrap();
    let mut document = small_document();
    // The smallest with a step of 1/8.
    (document.render.width, document.render.height, document.render.samples) = (768, 768, 2);
    document.view.denoise = Denoise::Fast;
    let mut coarse = Vec::new();
    for (turn, (shown, label, _)) in Shown::ALL.into_iter().enumerate() {
        let has_map = !matches!(shown, Shown::Picture | Shown::Precision);
        worker.set_inspected(turn % 2 == 1);
        // A new engine has no known speed, so that it begins with the coarsest step.
        worker.use_engine(EngineChoice::Cpu);
        document.camera.yaw_deg += 5.0;
        let revision = worker.submit(&document, Pace::Still);
        let is_there = |snapshot: &Snapshot, revision: u64| {
            let picture = snapshot.picture.as_ref();
            picture.filter(|picture| picture.revision == revision).cloned()
        };
        wait(worker, "a first image", |snapshot| {
            is_there(snapshot, revision).is_some()
        });
        coarse.extend(is_there(&worker.snapshot(), revision).map(|picture| picture.reduction));
        worker.show(shown);
        std::thread::sleep(Duration::from_millis(10));
        document.view.exposure_ev += 0.1;
        let revision = worker.submit(&document, Pace::Still);
        wait(worker, label, |snapshot| {
            is_there(snapshot, revision).is_some_and(|picture| {
                let of = picture.map.map(|(of, _)| of);
                picture.reduction == 1 && of == has_map.then_some(shown)
            })
        });
        let faults = wrong.lock().unwrap().clone();
        assert!(faults.is_empty(), "{label}: {faults:#?}");
    }
    assert!(coarse.iter().any(|reduction| *reduction > 1), "{coarse:?}");
}

/// An image of a coarse step that is shown in another way stays one: it is not saved as the whole.
#[test]
fn a_coarse_image_shown_brighter_stays_coarse() {
    let (desk, wrong) = watched();
    let worker = desk.get().unwrap();
    let mut document = small_document();
    (document.render.width, document.render.height, document.render.samples) = (768, 768, 1);
    let revision = worker.submit(&document, Pace::Still);
    wait(worker, "a first image", |snapshot| {
        snapshot
            .picture
            .as_ref()
            .is_some_and(|picture| picture.revision == revision)
    });
    for _ in 0..20 {
        document.view.exposure_ev += 0.05;
        worker.submit(&document, Pace::Still);
        std::thread::sleep(Duration::from_millis(5));
    }
    wait(worker, "the whole image", |snapshot| {
        snapshot.picture.as_ref().is_some_and(|picture| picture.reduction == 1)
    });
    let faults = wrong.lock().unwrap().clone();
    assert!(faults.is_empty(), "{faults:#?}");
}

/// How long the soak goes on: `GLOSSMITH_SOAK_MINUTES`, else 20 minutes.
fn soak_time() -> Duration {
    let chosen = std::env::var("GLOSSMITH_SOAK_MINUTES").ok();
    let default = 20.0;
    let minutes = chosen.map_or(default, |text| text.parse().expect("minutes"));
    Duration::from_secs_f64(60.0 * minutes)
}

/// Something that changes what is shown.
fn action(random: &mut Random) -> Action {
    match random.below(20) {
        0..8 => Action::Show(Shown::ALL[random.below(Shown::ALL.len())].0),
        8..13 => Action::LookFrom(f64::from(360.0 * random.unit()), f64::from(80.0 * random.unit())),
        13..15 => Action::UseMaterial(Box::new(PRESETS[random.below(PRESETS.len())].clone())),
        15 => Action::Do(Command::Denoise),
        16 => Action::Do(Command::Compare),
        17 => Action::Reveal([Pane::Inspector, Pane::Material][random.below(2)]),
        18 => Action::UseEnvironment([EnvironmentSource::Sky, EnvironmentSource::Furnace][random.below(2)].clone()),
        _ => Action::Do([Command::Pause, Command::Undo, Command::Restart][random.below(3)]),
    }
}

/// Random displays, steps, edits and orbits in a window with the denoiser on.
#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "thorough")]
fn displays_soak() {
    listen();
    let mut document = small_document();
    document.view.denoise = Denoise::Auto;
    document.render.samples = 4;
    let made = Options {
        document: Some(document),
        resolution: Some(Resolution::Auto),
        ..options()
    };
    let mut harness = Harness::builder()
        .with_size(egui::Vec2::new(1300.0, 1000.0))
        .build_eframe(move |creation| App::new(creation, made).expect("a thread to render on"));
    let seed = std::env::var("GLOSSMITH_MONKEY_SEED").map_or(1, |seed| seed.parse().expect("a number"));
    let mut random = Random::new(seed);
    let (begun, length) = (Instant::now(), soak_time());
    let mut done = Vec::new();
    while begun.elapsed() < length {
        let next = action(&mut random);
        done.push(format!("{next:?}"));
        harness.state_mut().request(next);
        if random.below(4) == 0
            && let Some(exposure) = harness.query_by_role_and_label(Role::SpinButton, "Exposure")
        {
            exposure.set_value_accesskit(f64::from(4.0 * random.unit() - 2.0));
        }
        // From within a step to past the last one.
        let pause = Duration::from_secs_f32(2.0 * random.unit().powi(4));
        let asked = Instant::now();
        while asked.elapsed() <= pause {
            harness.step();
            std::thread::sleep(Duration::from_millis(5));
        }
        let app = harness.state();
        let both = [Some(app.snapshot()), app.rival_snapshot()];
        let mut faults: Vec<String> = both
            .into_iter()
            .flatten()
            .flat_map(|snapshot| snapshot.picture.as_deref().map(faults).unwrap_or_default())
            .collect();
        faults.append(&mut broken());
        faults.extend(
            app.messages()
                .into_iter()
                .filter(|text| text.contains("the renderer failed")),
        );
        let last = &done[done.len().saturating_sub(12)..];
        assert!(faults.is_empty(), "seed {seed}: {faults:#?} after {last:#?}");
    }
    println!(
        "{} actions in {:.0} s without a fault",
        done.len(),
        begun.elapsed().as_secs_f64()
    );
}
