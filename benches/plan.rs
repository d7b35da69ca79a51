//! What the plan saves: specialised against general kernels, in time and in compiling; quoted in docs/PERFORMANCE.md.
//!
//! `cargo bench --bench plan [-- kernels|ledger|random] [cpu|gpu]`. `kernels`: every shipped material on the teapot under
//! `studio`, 256 × 256, specialised and general in turn; the ratio is the median over the turns of one run. Software Vulkan
//! compiles at the first dispatch, which is timed. `ledger`: what the ledger says of an effect, against the clock.
//! `random`: how far pictures of 200 random documents by both kernels are apart, with the same random numbers.

use std::time::{Duration, Instant};

use glossmith::{
    document::Document,
    document::effect::{EffectSwitches, Switch},
    job::effect::EffectId,
    render::{EngineChoice, Session},
    scene::{ModelSource, environment::EnvironmentSource},
    store::PRESETS,
    study::ledger::{LedgerOptions, ledger},
};

#[path = "../tests/suite/random_documents.rs"]
mod random_documents;
#[allow(dead_code, reason = "the tests need more of it")]
#[path = "../tests/suite/support.rs"]
mod support;

use random_documents::{apart, random_document};
use support::Random;

type Failure = Box<dyn std::error::Error>;
type Edit = fn(&mut Document);

/// Turns of each pair.
const TURNS: usize = 9;
/// How long each turn lasts.
const TURN: Duration = Duration::from_millis(500);
/// Random documents that are rendered by both kernels.
const DOCUMENTS: usize = 200;
/// Samples of a pixel in each turn by the clock.
const SAMPLES: u32 = 24;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().collect();
    let has = |name: &str| arguments.iter().any(|argument| argument == name);
    let engines = [(EngineChoice::Gpu, "cpu"), (EngineChoice::Cpu, "gpu")];
    for (engine, _) in engines.into_iter().filter(|(_, other)| !has(other)) {
        let mut sessions = [Session::open(engine)?, Session::open(engine)?];
        println!("## {}\n", sessions[0].engine());
        let chosen = |name: &str| has(name) || !["kernels", "ledger", "random"].iter().any(|name| has(name));
        if chosen("ledger") {
            ledger_and_clock(engine, &mut sessions)?;
        }
        if chosen("random") {
            random(&mut sessions)?;
        }
        if !chosen("kernels") {
            continue;
        }
        println!("| scene | left out | kernel s | general s | M samples/s | general | ratio |");
        println!("| --- | --- | --- | --- | --- | --- | --- |");
        for (name, document) in scenes() {
            let mut general = document.clone();
            general.render.effects = EffectSwitches::all_on();
            row(&name, &mut sessions, &[document, general])?;
        }
        println!();
    }
    Ok(())
}

/// The cost of an effect by the ledger, and by rendering the scene with and without it for as many samples by the clock.
fn ledger_and_clock(engine: EngineChoice, sessions: &mut [Session; 2]) -> Result<(), Failure> {
    println!("| effect | by the ledger, ms a sample of every pixel | by the clock | apart, of the time with it |");
    println!("| --- | --- | --- | --- |");
    let cases: [(EffectId, Edit); 5] = [
        (EffectId::Anisotropy, |document| document.materials[0].anisotropy = 0.5),
        (EffectId::Coat, |document| document.materials[0].coat_weight = 1.0),
        (EffectId::Ground, |document| document.ground = true),
        (EffectId::DepthOfField, |document| document.camera.aperture = 0.05),
        (EffectId::LightSampling, |_| {}),
    ];
    for (effect, add) in cases {
        let mut with = plain();
        add(&mut with);
        let entries = ledger(&with, &LedgerOptions::new(engine), &mut |_| true)?.entries;
        let Some(entry) = entries.into_iter().find(|entry| entry.name == effect.name()) else {
            continue;
        };
        let mut without = with.clone();
        without.render.effects.set(effect, Switch::Off);
        let mut milliseconds = [const { Vec::new() }; 2];
        for turn in 0..=TURNS {
            for (side, document) in [&with, &without].into_iter().enumerate() {
                let mut document = document.clone();
                (document.render.samples, document.render.seed) = (SAMPLES, turn as u32);
                sessions[side].submit(&document)?;
                let begun = Instant::now();
                while !sessions[side].step(TURN)?.is_done {}
                // The first turn compiles.
                if turn > 0 {
                    milliseconds[side].push(1e3 * begun.elapsed().as_secs_f64() / f64::from(SAMPLES));
                }
            }
        }
        let [with_ms, without_ms] = milliseconds.map(median);
        println!(
            "| {effect} | {:.2} | {:.2} | {:.1} % |",
            entry.ms,
            with_ms - without_ms,
            100.0 * (entry.ms - (with_ms - without_ms)).abs() / with_ms
        );
    }
    println!();
    Ok(())
}

/// Pictures of random documents by the kernel made for each and by the general one.
fn random(sessions: &mut [Session; 2]) -> Result<(), Failure> {
    let mut random = Random::new(23);
    let mut kernels = std::collections::HashSet::new();
    let (mut same, mut pixels_off, mut wholes_off) = (0, Vec::new(), Vec::new());
    for _ in 0..DOCUMENTS {
        let document = random_document(&mut random);
        let mut general = document.clone();
        general.render.effects = EffectSwitches::all_on();
        let mut pictures = [const { Vec::new() }; 2];
        for ((session, document), picture) in sessions.iter_mut().zip([document, general]).zip(&mut pictures) {
            session.submit(&document)?;
            while !session.step(TURN)?.is_done {}
            *picture = session.film()?.luminance();
        }
        kernels.extend(sessions[0].job().map(|job| job.plan.specialisation()));
        let [own, general] = pictures;
        let [pixels, whole] = apart(&own, &general);
        same += usize::from(own == general);
        pixels_off.push(pixels);
        wholes_off.push(whole);
    }
    let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    println!(
        "{DOCUMENTS} random documents, {} kernels: {same} pictures are the same to the last bit; pixels off by more than \
         1e-3: at most {:.2} %, {:.3} % in the mean; whole images off by at most {:.1e}\n",
        kernels.len(),
        100.0 * most(&pixels_off),
        100.0 * pixels_off.iter().sum::<f64>() / DOCUMENTS as f64,
        most(&wholes_off)
    );
    Ok(())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn plain() -> Document {
    let mut plain = Document::default();
    (plain.render.width, plain.render.height) = (256, 256);
    plain.render.samples = u32::MAX;
    plain
}

fn scenes() -> Vec<(String, Document)> {
    let plain = plain();
    let mut scenes = vec![("plain metal teapot".to_owned(), plain.clone())];
    scenes.extend(PRESETS.iter().map(|material| {
        let materials = vec![material.clone()];
        (
            material.name.clone(),
            Document {
                materials,
                ..plain.clone()
            },
        )
    }));
    let others = [
        ("shaderball, sky", ModelSource::Shaderball, EnvironmentSource::Sky),
        ("sphere, studio", ModelSource::Sphere, EnvironmentSource::Studio),
        ("plane, sky", ModelSource::Plane, EnvironmentSource::Sky),
        ("teapot, furnace", ModelSource::Teapot, EnvironmentSource::Furnace),
    ];
    scenes.extend(others.map(|(name, model, environment)| {
        let mut document = Document { model, ..plain.clone() };
        document.lighting.environment = environment;
        (name.to_owned(), document)
    }));
    scenes
}

fn row(name: &str, sessions: &mut [Session; 2], documents: &[Document; 2]) -> Result<(), Failure> {
    let mut compile_s = [0.0; 2];
    let mut speeds = [const { Vec::new() }; 2];
    for turn in 0..=TURNS {
        // By turns first, as the second finds a warmer cache.
        for side in [turn % 2, (turn + 1) % 2] {
            let mut document = documents[side].clone();
            document.render.seed = turn as u32;
            sessions[side].submit(&document)?;
            let begun = Instant::now();
            let progress = if turn == 0 {
                sessions[side].step(Duration::from_millis(1))?
            } else {
                sessions[side].step(TURN)?
            };
            let seconds = begun.elapsed().as_secs_f64();
            if turn == 0 {
                compile_s[side] = seconds;
            } else {
                speeds[side].push(progress.samples_per_second);
            }
        }
    }
    let left_out = sessions[0].job().map_or(0, |job| job.plan.left_out());
    let ratio = median(
        std::iter::zip(&speeds[0], &speeds[1])
            .map(|(own, general)| own / general)
            .collect(),
    );
    let [own, general] = speeds.map(|speeds| 1e-6 * median(speeds));
    println!(
        "| {name} | {left_out} | {:.2} | {:.2} | {own:.2} | {general:.2} | {ratio:.2} |",
        compile_s[0], compile_s[1]
    );
    Ok(())
}
