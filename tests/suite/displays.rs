//! Displays of the render at every step: an image, its maps and its facts are of one film.

use std::sync::{Arc, Mutex, OnceLock, atomic::AtomicU64, atomic::Ordering::Relaxed};

use glossmith::{
    document::Denoise,
    render::{
        EngineChoice,
        shown::Shown,
        worker::{Activity, Pace, Picture, Snapshot, Worker},
    },
};

use super::{
    renders::adjust,
    worker::{small_document, wait},
};

/// What of an image is not of its size.
pub fn faults(picture: &Picture) -> Vec<String> {
    let full = &picture.document.render;
    let size = [full.width, full.height].map(|side| side.div_ceil(picture.reduction));
    let pixels = size.map(|side| side as usize).iter().product::<usize>();
    let facts = picture.facts.as_deref();
    let lengths = [
        ("bytes", Some(picture.rgba.len() / 4)),
        ("pixels", Some(picture.image.pixels.len())),
        ("samples' pixels", Some(picture.samples.pixels.len())),
        ("errors", facts.map(|facts| facts.errors.len())),
        ("numbers of samples", facts.map(|facts| facts.features.samples.len())),
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
    // The smallest with a step of 1/4.
    adjust(&mut document, "render.width=384 render.height=384 render.samples=2");
    document.view.denoise = Denoise::Fast;
    let mut coarse = Vec::new();
    for (turn, &shown) in Shown::ALL.iter().enumerate() {
        let label = shown.label();
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
        let first = wait(worker, "a first image", |snapshot| {
            is_there(snapshot, revision).is_some()
        });
        let first = is_there(&first, revision).unwrap();
        coarse.push(first.reduction);
        worker.show(shown);
        wait(worker, "the next image", |snapshot| {
            let next = is_there(snapshot, revision);
            snapshot.activity == Activity::Done || next.is_some_and(|picture| picture.serial > first.serial)
        });
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
