//! Time from an edit to its first image, as the window's worker shows it.

use std::time::{Duration, Instant};

use super::report::EngineReport;
use super::{Done, Place, Run, StepTime};
use crate::document::Document;
use crate::render::worker::{Activity, Pace, Worker};
use crate::scene::environment::EnvironmentSource;

/// Viewport of a window of 1440 × 900, in pixels.
pub const VIEWPORT: [u32; 2] = [806, 780];
/// Least time that a hand needs between two edits.
pub const INTERVAL: Duration = Duration::from_millis(16);
/// Least time to wait for an image.
const PATIENCE_MIN: Duration = Duration::from_secs(15);
/// Polling interval of the worker.
const GLANCE: Duration = Duration::from_millis(1);
/// Samples of a render that is always interrupted.
const SAMPLES: u32 = 1 << 20;

/// The default scene under the studio in a viewport.
pub fn viewport([width, height]: [u32; 2]) -> Document {
    let mut document = Document::default();
    document.lighting.environment = EnvironmentSource::Studio;
    (document.render.width, document.render.height) = (width, height);
    document.render.samples = SAMPLES;
    document
}

/// Milliseconds from submitting a document to its first image; `None` after `patience`.
pub fn first_image(worker: &Worker, document: &Document, patience: Duration) -> Option<f64> {
    let revision = worker.submit(document, Pace::Moving);
    let shown = || {
        let snapshot = worker.snapshot();
        let image = snapshot.picture.as_ref();
        let is_shown = image.is_some_and(|image| image.revision == revision);
        snapshot.first_picture.filter(|_| is_shown)
    };
    awaited(patience, shown).map(|time| 1e3 * time.as_secs_f64())
}

/// Waits until the engine itself renders, not the CPU engine in its place. False after `patience`.
pub fn await_kernel(worker: &Worker, patience: Duration) -> bool {
    let renders = || {
        let snapshot = worker.snapshot();
        (snapshot.activity == Activity::Rendering && !snapshot.progress.is_fallback).then_some(())
    };
    awaited(patience, renders).is_some()
}

fn awaited<A>(patience: Duration, look: impl Fn() -> Option<A>) -> Option<A> {
    let begun = Instant::now();
    while begun.elapsed() < patience {
        if let Some(found) = look() {
            return Some(found);
        }
        std::thread::sleep(GLANCE);
    }
    None
}

/// Measures a drag of the roughness.
pub(super) fn edits(run: &mut Run<'_, '_>, place: &Place, report: &mut EngineReport, slot: StepTime) -> Done {
    let name = "roughness dragged";
    let mut document = viewport(run.extent.viewport);
    let worker = match Worker::spawn(place.choice(), || {}) {
        Ok(worker) => worker,
        Err(error) => {
            report.leave_out("edit", name, error.to_string());
            return Ok(());
        }
    };
    // What is compiled now is not compiled again: the time of the next steps gives way.
    let patience = (2 * slot.left()).max(PATIENCE_MIN);
    let lacking = if first_image(&worker, &document, patience).is_none() {
        Some("image")
    } else if !await_kernel(&worker, patience) {
        Some("kernel")
    } else {
        None
    };
    if let Some(what) = lacking {
        report.leave_out(
            "edit",
            name,
            format!("no {what} within {:.0} s", patience.as_secs_f64()),
        );
        return Ok(());
    }
    let mut milliseconds = Vec::new();
    for edit in 0..run.extent.edits {
        document.materials[0].roughness = 0.1 + 0.8 * edit as f32 / run.extent.edits as f32;
        milliseconds.extend(first_image(&worker, &document, patience));
        std::thread::sleep(INTERVAL);
        run.report(&format!("{}, edit {edit}", report.name()))?;
    }
    report.add("edit", name, ("ms", false), &milliseconds);
    Ok(())
}
