//! What light sampling gains: error after equal time, quoted in docs/PERFORMANCE.md.
//!
//! `cargo bench --bench strategies [-- FILE.hdr…]`: the teapot under the sky with its sun and under each file given, for
//! each strategy the relative mean squared error against a long render, after the same time on the CPU engine.
//! Strategies take turns, so that whatever else the machine does meets all of them.

use std::{path::PathBuf, time::Duration};

use glossmith::{
    analysis::error::relative_mean_squared_error,
    document::{Background, Document, Strategy},
    render::{EngineChoice, Session},
    scene::environment::EnvironmentSource,
};

/// How long each strategy renders, how often, and how long the reference does.
const DURATION: Duration = Duration::from_secs(2);
const ROUNDS: u32 = 3;
const REFERENCE_DURATION: Duration = Duration::from_secs(30);
/// Pixels along a side.
const SIZE: u32 = 128;
const STRATEGIES: [Strategy; 3] = [Strategy::Lobe, Strategy::Light, Strategy::Mis];

fn main() {
    let files = std::env::args().skip(1).filter(|argument| !argument.starts_with("--"));
    let environments = [EnvironmentSource::Sky]
        .into_iter()
        .chain(files.map(|file| EnvironmentSource::File(PathBuf::from(file))));
    println!("## Relative mean squared error after {DURATION:?}: teapot, {SIZE} x {SIZE}, 6 bounces, processor engine");
    println!("| environment | material | lobe | light | mis | mis against the better of the two |");
    println!("| --- | --- | --- | --- | --- | --- |");
    for environment in environments {
        for material in [Some(0.1), Some(0.3), Some(0.6), None] {
            if let Err(error) = compare(&environment, material) {
                println!("{environment:?}: {error}");
            }
        }
    }
}

/// A line of the table, for a metal of a roughness or the diffuse material.
fn compare(environment: &EnvironmentSource, roughness: Option<f32>) -> Result<(), Box<dyn std::error::Error>> {
    let reference = render(
        &document(environment, roughness, Strategy::Mis, 1000),
        REFERENCE_DURATION,
    )?;
    let mut errors = [0.0; 3];
    for round in 0..ROUNDS {
        for (error, strategy) in errors.iter_mut().zip(STRATEGIES) {
            let picture = render(&document(environment, roughness, strategy, round), DURATION)?;
            *error += relative_mean_squared_error(&picture, &reference) / f64::from(ROUNDS);
        }
    }
    let [lobe, light, mis] = errors;
    let name = match environment {
        EnvironmentSource::File(path) => path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        built_in => format!("{built_in:?}").to_lowercase(),
    };
    let material = roughness.map_or("diffuse".to_owned(), |roughness| format!("metal, R {roughness}"));
    let against = lobe.min(light) / mis;
    println!("| {name} | {material} | {lobe:.2e} | {light:.2e} | {mis:.2e} | {against:.2} × |");
    Ok(())
}

fn document(environment: &EnvironmentSource, roughness: Option<f32>, strategy: Strategy, seed: u32) -> Document {
    let mut document = Document::default();
    document.lighting.environment = environment.clone();
    // The sun in the background would rule the error.
    document.lighting.background = Background::Transparent;
    (document.render.width, document.render.height) = (SIZE, SIZE);
    document.render.samples = u32::MAX;
    document.render.bounces = 6;
    (document.render.strategy, document.render.seed) = (strategy, seed);
    let material = &mut document.materials[0];
    match roughness {
        Some(roughness) => material.roughness = roughness,
        None => (material.metalness, material.specular_weight) = (0.0, 0.0),
    }
    document
}

/// Linear RGB of a render of a given time.
fn render(document: &Document, duration: Duration) -> Result<Vec<f32>, Box<dyn std::error::Error>> {
    let mut session = Session::open(EngineChoice::Cpu)?;
    session.submit(document)?;
    session.step(duration)?;
    let image = session.film()?.image();
    Ok(image.pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect())
}
