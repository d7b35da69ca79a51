//! How soon a drag shows: from a changed roughness, a changed plan, or a moved light to the first picture of it; quoted in
//! docs/PERFORMANCE.md.
//!
//! `cargo bench --bench latency [-- light]`. The viewport of a window of 1440 × 900, the default scene, and a light over a
//! model of 600 000 triangles. Reduced resolutions count, as they do in the window.

mod bumpy;

use std::time::{Duration, Instant};

use bumpy::bumpy_sphere;
use glossmith::{
    document::{AreaLight, Document},
    render::EngineChoice,
    render::worker::{Activity, Pace, Worker},
    scene::{Model, ModelSource, Slot, environment::EnvironmentSource},
};

/// Viewport of a window of 1440 × 900, in pixels.
const VIEWPORT: [u32; 2] = [806, 780];
/// Least time that a hand needs between two edits.
const INTERVAL: Duration = Duration::from_millis(16);
/// Polling interval of the worker.
const GLANCE: Duration = Duration::from_millis(1);
/// Samples of a render that is always interrupted.
const SAMPLES: u32 = 1 << 20;
/// Steps of a drag.
const STEPS: u32 = 60;
/// Longer than any kernel is compiled.
const PATIENCE: Duration = Duration::from_secs(600);

fn main() -> std::io::Result<()> {
    println!("| engine | edit | median ms | 95 % ms | longest ms |");
    println!("| --- | --- | --- | --- | --- |");
    for engine in [EngineChoice::Cpu, EngineChoice::Gpu] {
        light_dragged(engine)?;
        if std::env::args().any(|argument| argument == "light") {
            continue;
        }
        let worker = Worker::spawn(engine, || {})?;
        let mut document = viewport();
        first_picture(&worker, &document);
        await_kernel(&worker);
        let name = name(&worker);
        let drag = (0..STEPS).map(|step| {
            document.materials[0].roughness = 0.1 + 0.8 * step as f32 / STEPS as f32;
            let milliseconds = first_picture(&worker, &document);
            std::thread::sleep(INTERVAL);
            milliseconds
        });
        report(&name, "roughness dragged", drag.collect());
        // Each crosses zero for the first time: its kernel has not been compiled.
        let crossings: [fn(&mut Document); 4] = [
            |document| document.materials[0].anisotropy = 0.3,
            |document| document.materials[0].emission_strength = 0.2,
            |document| document.camera.aperture = 0.05,
            |document| {
                (
                    document.materials[0].metalness,
                    document.materials[0].transmission_weight,
                ) = (0.0, 0.1)
            },
        ];
        let crossed = crossings.iter().map(|cross| {
            cross(&mut document);
            let milliseconds = first_picture(&worker, &document);
            let begun = Instant::now();
            await_kernel(&worker);
            eprintln!(
                "  {milliseconds:.0} ms, kernel after {:.1} s",
                begun.elapsed().as_secs_f64()
            );
            milliseconds
        });
        report(&name, "plan changed", crossed.collect());
    }
    Ok(())
}

/// Drags an area light over a large model.
fn light_dragged(engine: EngineChoice) -> std::io::Result<()> {
    let worker = Worker::spawn(engine, || {})?;
    let mut document = viewport();
    document.model = ModelSource::File("bumpy sphere of 600 000 triangles".into());
    let model = Model {
        mesh: bumpy_sphere(600_000),
        slots: vec![Slot::neutral("sphere")],
        ..Model::default()
    };
    worker.assets().keep_model(document.model.clone(), model);
    document.lighting.area_lights = vec![AreaLight::default()];
    first_picture(&worker, &document);
    await_kernel(&worker);
    let drag = (0..STEPS).map(|step| {
        document.lighting.area_lights[0].yaw_deg = f64::from(step);
        let milliseconds = first_picture(&worker, &document);
        std::thread::sleep(INTERVAL);
        milliseconds
    });
    report(&name(&worker), "light dragged, 600 000 triangles", drag.collect());
    Ok(())
}

fn name(worker: &Worker) -> String {
    let snapshot = worker.snapshot();
    snapshot.engine.as_ref().map_or_else(String::new, ToString::to_string)
}

/// The default scene under the studio in a viewport.
fn viewport() -> Document {
    let mut document = Document::default();
    document.lighting.environment = EnvironmentSource::Studio;
    [document.render.width, document.render.height] = VIEWPORT;
    document.render.samples = SAMPLES;
    document
}

/// Milliseconds from submitting a document to its first picture.
fn first_picture(worker: &Worker, document: &Document) -> f64 {
    let revision = worker.submit(document, Pace::Moving);
    let shown = || {
        let snapshot = worker.snapshot();
        let image = snapshot.picture.as_ref();
        let is_shown = image.is_some_and(|image| image.revision == revision);
        snapshot.first_picture.filter(|_| is_shown)
    };
    awaited(shown).map_or(f64::INFINITY, |time| 1e3 * time.as_secs_f64())
}

/// Waits until the engine itself renders, not the CPU engine in its place.
fn await_kernel(worker: &Worker) {
    awaited(|| {
        let snapshot = worker.snapshot();
        (snapshot.activity == Activity::Rendering && !snapshot.progress.is_fallback).then_some(())
    });
}

fn awaited<A>(look: impl Fn() -> Option<A>) -> Option<A> {
    let begun = Instant::now();
    while begun.elapsed() < PATIENCE {
        let found = look();
        if found.is_some() {
            return found;
        }
        std::thread::sleep(GLANCE);
    }
    None
}

fn report(engine: &str, edit: &str, mut milliseconds: Vec<f64>) {
    milliseconds.sort_by(f64::total_cmp);
    let at = |share: f64| milliseconds[((milliseconds.len() - 1) as f64 * share).round() as usize];
    println!(
        "| {engine} | {edit} | {:.0} | {:.0} | {:.0} |",
        at(0.5),
        at(0.95),
        at(1.0)
    );
}
