//! The renderer's thread: what is submitted is shown, failures leave what was there.

use crate::renders::adjust;
use std::{sync::Arc, time::Duration, time::Instant};

use glossmith::{
    document::Document,
    render::EngineChoice,
    render::worker::{Activity, Event, Level, Pace, Picture, Snapshot, Worker},
    scene::{ModelOptions, ModelSource},
};

const PATIENCE: Duration = Duration::from_secs(600);

/// A sphere in few pixels.
pub fn small_document() -> Document {
    let mut document = Document {
        model: ModelSource::Sphere,
        ..Document::default()
    };
    adjust(
        &mut document,
        "render.width=40 render.height=24 render.samples=3 render.bounces=3",
    );
    document
}

fn worker() -> Worker {
    Worker::spawn(EngineChoice::Cpu, || {}).expect("a thread")
}

pub fn wait(worker: &Worker, what: &str, until: impl Fn(&Snapshot) -> bool) -> Arc<Snapshot> {
    let begun = Instant::now();
    loop {
        let snapshot = worker.snapshot();
        if until(&snapshot) {
            return snapshot;
        }
        assert!(
            begun.elapsed() < PATIENCE,
            "waited in vain for {what}: {:?}",
            worker.snapshot().activity
        );
        std::thread::sleep(Duration::from_millis(2));
    }
}

pub fn finished(worker: &Worker, revision: u64) -> Arc<Picture> {
    let is_finished = |snapshot: &Snapshot| {
        let picture = snapshot.picture.as_ref();
        snapshot.activity == Activity::Done
            && picture.is_some_and(|picture| picture.revision == revision && picture.reduction == 1)
    };
    let snapshot = wait(worker, "a finished picture", is_finished);
    snapshot.picture.clone().expect("checked above")
}

pub fn errors(worker: &Worker) -> Vec<String> {
    let error = |event| match event {
        Event::Message(Level::Error, text) => Some(text),
        _ => None,
    };
    worker.take_events().into_iter().filter_map(error).collect()
}

#[test]
fn a_document_becomes_its_picture() {
    let worker = worker();
    let document = small_document();
    let picture = finished(&worker, worker.submit(&document, Pace::Still));
    assert_eq!((picture.width, picture.height, picture.samples_per_pixel), (40, 24, 3));
    assert_eq!(picture.rgba.len(), 4 * 40 * 24);
    let mut session = glossmith::render::Session::open(EngineChoice::Cpu).expect("the processor");
    session.submit(&document).expect("a sphere");
    while !session.step(Duration::from_millis(50)).expect("no GPU to fail").is_done {}
    assert_eq!(*picture.image, session.image().expect("no GPU to fail"));
}

#[test]
fn layers_are_of_what_was_there_when_they_were_asked_for() {
    let worker = worker();
    let mut document = small_document();
    let before = finished(&worker, worker.submit(&document, Pace::Still));
    let made = worker.make_layers();
    document.materials[0].base_color = [0.0; 3];
    worker.submit(&document, Pace::Still);
    assert_eq!(made.recv().expect("an image").0.image, *before.image);
}

/// The panel says so: once every pixel has two samples.
#[test]
fn the_error_is_known_from_the_second_sample_on() {
    let mut document = small_document();
    document.render.samples = 8;
    let mut session = glossmith::render::Session::open(EngineChoice::Cpu).expect("the processor");
    session.submit(&document).expect("a sphere");
    while session.history().is_empty() {
        session.step(Duration::from_millis(1)).expect("no GPU to fail");
    }
    assert_eq!(session.history()[0].samples_per_pixel, 2.0);
}

#[test]
fn the_last_of_many_submissions_is_what_stays() {
    let worker = worker();
    let mut document = small_document();
    let mut revision = 0;
    for step in 0..50 {
        document.camera.yaw_deg = f64::from(step);
        revision = worker.submit(&document, Pace::Moving);
    }
    let picture = finished(&worker, revision);
    let snapshot = worker.snapshot();
    let scene = snapshot.scene.as_ref().expect("a scene was rendered");
    assert_eq!(scene.document.camera.yaw_deg, 49.0);
    assert_eq!(picture.revision, 50);
}

#[test]
fn a_steady_stream_of_changes_is_shown_while_it_lasts() {
    let worker = worker();
    let mut document = small_document();
    // Large enough that a change every 3 ms never leaves time for a whole image.
    adjust(&mut document, "render.width=1600 render.height=1000");
    finished_first_look(&worker, worker.submit(&document, Pace::Still));
    let begun = Instant::now();
    let mut shown = 0;
    let mut last_serial = worker.snapshot().picture.as_ref().map(|picture| picture.serial);
    while begun.elapsed() < Duration::from_secs(60) && shown < 4 {
        document.camera.yaw_deg += 1.0;
        worker.submit(&document, Pace::Moving);
        std::thread::sleep(Duration::from_millis(3));
        let picture = worker.snapshot().picture.clone().expect("there was one before");
        if Some(picture.serial) != last_serial && picture.reduction > 1 {
            shown += 1;
            last_serial = Some(picture.serial);
        }
    }
    assert!(shown >= 4, "only {shown} pictures were shown while the camera moved");
}

fn finished_first_look(worker: &Worker, revision: u64) {
    wait(worker, "a first look", |snapshot| {
        snapshot
            .picture
            .as_ref()
            .is_some_and(|picture| picture.revision == revision)
    });
}

#[test]
fn exposure_is_shown_without_rendering_again() {
    let worker = worker();
    let mut document = small_document();
    let first = finished(&worker, worker.submit(&document, Pace::Still));
    document.view.exposure_ev = 2.0;
    let brighter = finished(&worker, worker.submit(&document, Pace::Still));
    assert!(Arc::ptr_eq(&first.image, &brighter.image), "it was rendered again");
    let sum = |picture: &Picture| picture.rgba.iter().map(|byte| u64::from(*byte)).sum::<u64>();
    assert!(sum(&brighter) > sum(&first));
    assert!(brighter.serial > first.serial);
}

#[test]
fn more_samples_go_on_where_rendering_stopped() {
    let worker = worker();
    let mut document = small_document();
    finished(&worker, worker.submit(&document, Pace::Still));
    document.render.samples = 6;
    worker.submit(&document, Pace::Still);
    let snapshot = wait(&worker, "six samples", |snapshot| {
        snapshot.progress.samples_per_pixel == 6
    });
    assert_eq!(snapshot.progress.samples_wanted, 6);
}

#[test]
fn a_model_that_is_not_there_leaves_the_old_picture_and_is_named() {
    let worker = worker();
    let document = small_document();
    let revision = worker.submit(&document, Pace::Still);
    let before = finished(&worker, revision);
    let broken = Document {
        model: ModelSource::File("no/such/model.glb".into()),
        ..document.clone()
    };
    worker.submit(&broken, Pace::Still);
    let begun = Instant::now();
    let mut said = Vec::new();
    while said.is_empty() && begun.elapsed() < PATIENCE {
        said = errors(&worker);
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(said.iter().any(|text| text.contains("no/such/model.glb")), "{said:?}");
    let snapshot = wait(&worker, "calm", |snapshot| snapshot.activity == Activity::Done);
    assert_eq!(
        snapshot.picture.as_ref().map(|picture| picture.serial),
        Some(before.serial)
    );
    // And it still works.
    finished(
        &worker,
        worker.submit(
            &Document {
                ground: true,
                ..document
            },
            Pace::Still,
        ),
    );
}

#[test]
fn a_pause_shows_the_first_sample_and_waits() {
    let worker = worker();
    worker.pause(true);
    let mut document = small_document();
    document.render.samples = 100_000;
    let revision = worker.submit(&document, Pace::Still);
    let snapshot = wait(&worker, "the pause", |snapshot| snapshot.activity == Activity::Paused);
    let picture = snapshot.picture.as_ref().expect("something to look at");
    assert_eq!(picture.revision, revision);
    let samples = snapshot.progress.samples_per_pixel;
    assert!(samples < 100_000);
    // It does what is asked for meanwhile, and no sample.
    for exposure in [1.0, 2.0, 3.0] {
        document.view.exposure_ev = exposure;
        let revision = worker.submit(&document, Pace::Still);
        finished_first_look(&worker, revision);
    }
    assert_eq!(worker.snapshot().progress.samples_per_pixel, samples);
    worker.pause(false);
    wait(&worker, "more samples", |snapshot| {
        snapshot.progress.samples_per_pixel > samples
    });
}

#[test]
fn files_are_opened_beside_the_document() {
    let worker = worker();
    worker.open_model(ModelSource::Shaderball, ModelOptions::default());
    worker.open_environment(glossmith::scene::environment::EnvironmentSource::File(
        "missing.hdr".into(),
    ));
    let begun = Instant::now();
    let (mut slots, mut why) = (0, String::new());
    while (slots == 0 || why.is_empty()) && begun.elapsed() < PATIENCE {
        for event in worker.take_events() {
            match event {
                Event::ModelOpened(ModelSource::Shaderball, _, model) => slots = model.slots.len(),
                Event::OpenFailed(_, _, text) => why = text,
                _ => {}
            }
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    assert_eq!(slots, 2);
    assert!(why.contains("missing.hdr"), "{why}");
}
