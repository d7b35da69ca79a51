//! Without a hardware GPU: is software Vulkan or our own processor engine faster on this machine?
//!
//! Measured once on a small picture of the default document, and remembered for this driver and version.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::assets::Assets;
use super::compile::Compiler;
use super::engine::{Engine, EngineInfo, Precision, cpu, gpu};
use crate::document::Document;
use crate::document::job::Job;
use crate::gpu::{AdapterKind, GpuDevice};

/// Side of the picture that is measured on, in pixels.
const SIZE: u32 = 96;
/// How long each engine is measured.
const DURATION: Duration = Duration::from_millis(120);

/// Opens whichever engine is faster.
pub(super) fn fastest_without_hardware() -> (Engine, EngineInfo) {
    let device = match GpuDevice::open(AdapterKind::Software) {
        Ok(device) => device,
        Err(_) => return cpu("there is no Vulkan driver".to_owned()),
    };
    let machine = format!(
        "{} | {} | {} threads | {}",
        device.info.name,
        device.driver(),
        rayon::current_num_threads(),
        env!("CARGO_PKG_VERSION")
    );
    let remembered = read_verdict(&machine);
    if let Some(verdict) = remembered.as_ref().filter(|verdict| verdict.ratio >= 1.0) {
        return cpu(verdict.reason());
    }
    let Ok(mut software) = gpu(device, String::new()) else {
        return cpu("software Vulkan does not run the renderer".to_owned());
    };
    let verdict = match remembered {
        Some(verdict) => verdict,
        None => {
            let Some(verdict) = measure(&mut software.0, machine) else {
                return cpu("software Vulkan does not run the renderer".to_owned());
            };
            write_verdict(&verdict);
            verdict
        }
    };
    if verdict.ratio >= 1.0 {
        return cpu(verdict.reason());
    }
    software.1.reason = verdict.reason();
    software
}

/// What was measured.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
struct Verdict {
    /// Adapter, driver, threads, version.
    machine: String,
    /// Samples a second of the processor engine over those of software Vulkan.
    ratio: f64,
}

impl Verdict {
    fn reason(&self) -> String {
        let (winner, loser, ratio) = if self.ratio >= 1.0 {
            ("the processor engine", "software Vulkan", self.ratio)
        } else {
            ("software Vulkan", "the processor engine", 1.0 / self.ratio)
        };
        format!("no hardware GPU; {winner} was measured {ratio:.1} × as fast here as {loser}")
    }
}

fn measure(software: &mut Engine, machine: String) -> Option<Verdict> {
    let mut document = Document::default();
    (document.render.width, document.render.height) = (SIZE, SIZE);
    let job = Arc::new(Compiler::default().compile(&document, &Assets::default()).ok()?);
    let (mut processor, _) = cpu(String::new());
    let ratio = samples_per_second(&mut processor, &job)? / samples_per_second(software, &job)?;
    Some(Verdict { machine, ratio })
}

fn samples_per_second(engine: &mut Engine, job: &Arc<Job>) -> Option<f64> {
    engine.submit(job.clone()).ok()?;
    // The first sample compiles.
    let tiles = engine.schedule().grid().tiles();
    engine
        .step(Duration::from_secs(60), &vec![1; tiles], Precision::Single)
        .ok()?;
    engine.submit(job.clone()).ok()?;
    let begun = Instant::now();
    engine.step(DURATION, &vec![u32::MAX; tiles], Precision::Single).ok()?;
    let samples = engine.film().ok()?.samples();
    Some(samples as f64 / begun.elapsed().as_secs_f64())
}

fn verdict_path() -> Option<PathBuf> {
    Some(
        directories::ProjectDirs::from("", "", "glossmith")?
            .cache_dir()
            .join("engine.json"),
    )
}

fn read_verdict(machine: &str) -> Option<Verdict> {
    let text = std::fs::read(verdict_path()?).ok()?;
    let verdict: Verdict = serde_json::from_slice(&text).ok()?;
    (verdict.machine == machine && verdict.ratio.is_finite() && verdict.ratio > 0.0).then_some(verdict)
}

/// A cache: where it can't be written, the next start measures again.
fn write_verdict(verdict: &Verdict) {
    let write = || {
        let path = verdict_path()?;
        std::fs::create_dir_all(path.parent()?).ok()?;
        std::fs::write(path, serde_json::to_vec(verdict).ok()?).ok()
    };
    if write().is_none() {
        log::debug!("the engine's measurement could not be cached");
    }
}
