//! How soon a drag shows: from a changed roughness, a changed plan, or a moved light to the first picture of it; quoted in
//! docs/PERFORMANCE.md.
//!
//! `cargo bench --bench latency [-- light]`. The viewport of a window of 1440 × 900, the default scene, and a light over a
//! model of 600 000 triangles. Reduced resolutions count, as they do in the window.

use std::time::{Duration, Instant};

use glossmith::document::{AreaLight, Document};
use glossmith::render::EngineChoice;
use glossmith::render::worker::Worker;
use glossmith::scene::shapes::bumpy_sphere;
use glossmith::scene::{Model, ModelSource, Slot};
use glossmith::study::benchmark::latency::{INTERVAL, VIEWPORT, await_kernel, first_image, viewport};

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
        let mut document = viewport(VIEWPORT);
        first_picture(&worker, &document);
        await_kernel(&worker, PATIENCE);
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
            await_kernel(&worker, PATIENCE);
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
    let mut document = viewport(VIEWPORT);
    document.model = ModelSource::File("bumpy sphere of 600 000 triangles".into());
    let model = Model {
        mesh: bumpy_sphere(600_000),
        slots: vec![Slot::neutral("sphere")],
        ..Model::default()
    };
    worker.assets().keep_model(document.model.clone(), model);
    document.lighting.area_lights = vec![AreaLight::default()];
    first_picture(&worker, &document);
    await_kernel(&worker, PATIENCE);
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

/// Milliseconds from submitting a document to its first picture.
fn first_picture(worker: &Worker, document: &Document) -> f64 {
    first_image(worker, document, PATIENCE).unwrap_or(f64::INFINITY)
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
