//! Time to a clean image, with and without denoising.
//!
//! The error of an image is its distance from a reference less the reference's own error. The reference is the mean of two
//! renders, whose difference gives that error.

use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::{
    Done, GOAL, REFERENCE_SHARE, Run, TestedEngine, default_scene, opened, report::EngineReport, scene::Scene, turns,
};
use crate::{
    analysis::error::{colors, relative_mean_squared_error},
    document::{Denoise, Document},
    gpu::Traversal,
    job::film::Image,
    render::{EngineChoice, Session, denoise::Denoiser},
    study::{StudyError, UNLIMITED},
};

/// Unit of the rows; less is better.
const SECONDS: (&str, bool) = ("s", false);
/// Seeds of the reference's two renders.
const REFERENCE_SEEDS: [u32; 2] = [1000, 1001];
/// Materials of the scenes besides the default one.
const MATERIALS: [&str; 2] = ["diffuse", "metal 0.25"];
/// Most turns, after one of few samples that warms kernels and denoiser.
const TURNS: usize = 5;
const WARM: usize = 0;
/// Render time in seconds after which the rest is extrapolated: the error falls with the number of samples.
const PATIENCE: f64 = 4.0;

/// A scene with its reference.
pub struct Goal {
    name: String,
    document: Document,
    reference: Vec<f32>,
    /// Relative mean squared error of the reference.
    reference_error: f64,
}

/// Renders the references on the CPU engine.
pub fn references(run: &mut Run<'_, '_>, folder: &TempDir) -> Result<Vec<Goal>, StudyError> {
    let size = run.extent.goal_size;
    let chosen =
        Scene::all().filter(|scene| MATERIALS.contains(&scene.material) && scene.mesh == "60k" && !scene.ground);
    let scenes = chosen.map(|scene| (scene.name(), scene.document(folder.path(), size)));
    let mut all: Vec<_> = std::iter::once(("default".to_owned(), default_scene(size)))
        .chain(scenes)
        .collect();
    all.truncate(1 + run.extent.scenes);
    let time = run.options.seconds * REFERENCE_SHARE / (all.len() * REFERENCE_SEEDS.len()) as f64;
    let mut session = Session::open(EngineChoice::Cpu)?;
    let mut goals = Vec::new();
    for (name, document) in all {
        let mut halves = Vec::new();
        for seed in REFERENCE_SEEDS {
            run.report(&format!("reference: {name}"))?;
            let mut document = document.clone();
            (document.render.samples, document.render.seed) = (UNLIMITED, seed);
            session.submit(&document)?;
            session.step(Duration::from_secs_f64(time))?;
            halves.push(colors(&session.image()?));
        }
        let [a, b] = [&halves[0], &halves[1]];
        let reference: Vec<f32> = std::iter::zip(a, b).map(|(a, b)| 0.5 * (a + b)).collect();
        // Twice the variance of one render, and four times that of their mean.
        let reference_error = relative_mean_squared_error(a, b) / 4.0;
        goals.push(Goal {
            name,
            document,
            reference,
            reference_error,
        });
    }
    Ok(goals)
}

/// Measures the times of all scenes with a reference.
pub fn goals(run: &mut Run<'_, '_>, place: &TestedEngine, report: &mut EngineReport, end: Instant) -> Done {
    let mut session = opened(place, Traversal::Own)?;
    session.keep_guides("for the benchmark");
    let mut denoiser = Denoiser::open();
    let mut times = vec![[const { Vec::new() }; 2]; run.goals.len()];
    for (turn, number) in turns(end, TURNS, times.len()) {
        let goal = &run.goals[number];
        let (raw, denoised) = goal.times(&mut session, denoiser.as_mut().ok(), turn)?;
        if turn != WARM {
            times[number][0].push(raw);
            times[number][1].extend(denoised);
        }
        let what = format!("{}, to a clean image: {}", report.name(), goal.name);
        run.report(&what)?;
    }
    for (goal, [raw, denoised]) in std::iter::zip(&run.goals, &times) {
        report.add("to clean", &goal.name, SECONDS, raw);
        match &denoiser {
            Err(error) => report.leave_out("to clean, denoised", &goal.name, error.to_string()),
            Ok(_) if denoised.is_empty() && !raw.is_empty() => {
                let why = format!("a relative mean squared error of {GOAL} is not reached in {PATIENCE} s");
                report.leave_out("to clean, denoised", &goal.name, why);
            }
            Ok(_) => report.add("to clean, denoised", &goal.name, SECONDS, denoised),
        }
    }
    Ok(())
}

impl Goal {
    /// Renders with doubling samples until raw and denoised image are clean.
    fn times(
        &self,
        session: &mut Session,
        denoiser: Option<&mut Denoiser>,
        turn: usize,
    ) -> Result<(f64, Option<f64>), StudyError> {
        let mut document = self.document.clone();
        document.render.seed = turn as u32;
        let mut denoiser = denoiser;
        let (mut denoised, mut before) = (None, None);
        let doublings = if turn == WARM { 2 } else { u32::MAX };
        for exponent in 0..doublings {
            document.render.samples = 1 << exponent.min(30);
            session.submit(&document)?;
            let progress = session.step(Duration::from_secs_f64(PATIENCE))?;
            let seconds = progress.render_seconds;
            if let Some(tool) = denoiser.as_mut().filter(|_| denoised.is_none()) {
                let begun = Instant::now();
                let noisy = session.noisy()?;
                let image = tool.denoise(&noisy, Denoise::High).map(|done| done.image);
                let total = seconds + begun.elapsed().as_secs_f64();
                denoised = image.ok().filter(|image| self.error(image) <= GOAL).map(|_| total);
            }
            let error = self.error(&session.image()?);
            if error <= GOAL || seconds > PATIENCE || !progress.is_done {
                let raw = between(before, (seconds, error));
                return Ok((raw, denoised));
            }
            before = Some((seconds, error));
        }
        Ok((f64::NAN, denoised))
    }

    fn error(&self, image: &Image) -> f64 {
        (relative_mean_squared_error(&colors(image), &self.reference) - self.reference_error).max(1e-9)
    }
}

/// Time at which the error was, or will be, the goal: on the line between two points as logarithms, or from one point by the
/// error of independent samples.
fn between(before: Option<(f64, f64)>, (seconds, error): (f64, f64)) -> f64 {
    match before {
        Some((seconds_before, error_before)) if error <= GOAL && error_before > error => {
            let along = (error_before / GOAL).ln() / (error_before / error).ln();
            seconds_before * (seconds / seconds_before).powf(along)
        }
        _ => seconds * (error / GOAL).max(if error <= GOAL { 1.0 } else { 0.0 }),
    }
}
