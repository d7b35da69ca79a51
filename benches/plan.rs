//! What the plan saves: specialised against general kernels, in time and in compiling; quoted in docs/PERFORMANCE.md.
//!
//! `cargo bench --bench plan`. Every shipped material on the teapot under `studio`, 256 × 256, specialised and general in
//! turn; the ratio is of medians of one run. Software Vulkan compiles at the first dispatch, which is timed.

use std::time::{Duration, Instant};

use glossmith::document::effect::EffectSwitches;
use glossmith::document::{Document, PRESETS};
use glossmith::render::{EngineChoice, Session, SessionError};

/// Turns of each pair.
const TURNS: usize = 5;
/// How long each turn lasts.
const TURN: Duration = Duration::from_millis(800);

fn main() -> Result<(), SessionError> {
    for engine in [EngineChoice::Gpu, EngineChoice::Cpu] {
        let mut sessions = [Session::open(engine)?, Session::open(engine)?];
        println!("## {}\n", sessions[0].engine());
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

fn scenes() -> Vec<(String, Document)> {
    let mut plain = Document::default();
    (plain.render.width, plain.render.height) = (256, 256);
    plain.render.samples = u32::MAX;
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
    scenes
}

fn row(name: &str, sessions: &mut [Session; 2], documents: &[Document; 2]) -> Result<(), SessionError> {
    let mut compile_s = [0.0; 2];
    let mut speeds = [const { Vec::new() }; 2];
    for turn in 0..=TURNS {
        for side in 0..2 {
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
    let [own, general] = speeds.map(|mut speeds| {
        speeds.sort_by(f64::total_cmp);
        speeds[speeds.len() / 2] * 1e-6
    });
    println!(
        "| {name} | {left_out} | {:.2} | {:.2} | {own:.2} | {general:.2} | {:.2} |",
        compile_s[0],
        compile_s[1],
        own / general
    );
    Ok(())
}
