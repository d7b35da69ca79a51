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
use crate::gpu::{AdapterKind, GpuDevice};
use crate::job::Job;

/// Side of the picture that is measured on, in pixels.
const SIZE: u32 = 96;
/// How often the engines are measured in turns, and how long each time.
const TURNS: usize = 7;
const DURATION: Duration = Duration::from_millis(60);

/// Opens whichever engine is faster. Where that is to be measured and nobody may wait for it, the processor's is opened:
/// compiling a kernel to measure takes software Vulkan some ten seconds, and what is found counts the next time.
pub(super) fn fastest_without_hardware(may_wait: bool) -> (Engine, EngineInfo) {
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
        None if may_wait => match measured(&mut software.0, machine) {
            Some(verdict) => verdict,
            None => return cpu("software Vulkan does not run the renderer".to_owned()),
        },
        None => {
            let work = move || measured(&mut software.0, machine);
            // Without a thread the next start tries again.
            let _ = std::thread::Builder::new().name("calibration".to_owned()).spawn(work);
            return cpu("no hardware GPU; software Vulkan is being measured, for the next start".to_owned());
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

/// Measures, and remembers it; `None` where one of the engines fails.
fn measured(software: &mut Engine, machine: String) -> Option<Verdict> {
    let mut document = Document::default();
    (document.render.width, document.render.height) = (SIZE, SIZE);
    let job = Arc::new(Compiler::default().compile(&document, &Assets::default()).ok()?);
    let (mut processor, _) = cpu(String::new());
    // On threads of its own, as software Vulkan has its own: the window may be rendering on the common ones.
    let threads = rayon::ThreadPoolBuilder::new().build().ok()?;
    threads.install(|| warm(&mut processor, &job))?;
    warm(software, &job)?;
    let mut ratios = Vec::new();
    for _ in 0..TURNS {
        let own = threads.install(|| samples_per_second(&mut processor, &job))?;
        ratios.push(own / samples_per_second(software, &job)?);
    }
    // The middle one, as other work may come in between.
    ratios.sort_by(f64::total_cmp);
    let verdict = Verdict {
        machine,
        ratio: ratios[TURNS / 2],
    };
    write_verdict(&verdict);
    Some(verdict)
}

/// Renders a sample of every pixel: the first one compiles.
fn warm(engine: &mut Engine, job: &Arc<Job>) -> Option<()> {
    engine.submit(job.clone()).ok()?;
    let tiles = engine.schedule().grid().tiles();
    let goals = vec![1; tiles];
    engine.step(Duration::from_secs(60), &goals, Precision::Single).ok()
}

fn samples_per_second(engine: &mut Engine, job: &Arc<Job>) -> Option<f64> {
    engine.submit(job.clone()).ok()?;
    let tiles = engine.schedule().grid().tiles();
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
