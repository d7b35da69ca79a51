//! The benchmark: speed of every engine and adapter of a machine, in one report.
//!
//! Each step of each engine has a share of the time; what does not fit is left out and named. Turns of a step go through all
//! scenes in order, so that the spread of a scene's turns holds the drift of the machine.

pub mod compare;
mod goal;
mod rate;
pub mod report;
pub mod scene;

use std::{io, time::Duration, time::Instant};

use sysinfo::{MemoryRefreshKind, RefreshKind, System};
use tempfile::TempDir;

use super::{Steps, StudyError, Watch};
use crate::{
    document::Document,
    gpu::{AdapterKind, GpuAdapter, GpuError, Traversal},
    render::{EngineChoice, Session, cpu_name, denoise::Library},
};
use goal::Goal;
use report::{EngineReport, Machine, Report, SCHEMA, SCHEMA_VERSION};
use scene::Scene;

/// Relative mean squared error of a clean image.
pub const GOAL: f64 = 0.003;
/// Time of a run in seconds: a full one, and a quick one.
pub const SECONDS: [f64; 2] = [120.0, 20.0];
/// Share of the time for references, which all engines use.
const REFERENCE_SHARE: f64 = 0.08;

/// Options of a run.
#[derive(Clone, Debug)]
pub struct BenchmarkOptions {
    /// Engine to measure; `auto` stands for the CPU and every adapter.
    pub engine: EngineChoice,
    /// Time of the run in seconds, about.
    pub seconds: f64,
    /// Small images, few scenes and turns: to see that it works.
    pub quick: bool,
}

/// How much is measured.
#[derive(Clone, Copy, Debug)]
struct Extent {
    /// Side of images for rates, and for the time to the goal, in pixels.
    size: u32,
    goal_size: u32,
    /// Scenes besides the default one.
    scenes: usize,
    /// Length of a turn, and the most turns.
    turn: Duration,
    turns: usize,
}

const FULL: Extent = Extent {
    size: 512,
    goal_size: 256,
    scenes: 9,
    turn: Duration::from_millis(250),
    turns: 9,
};
const QUICK: Extent = Extent {
    size: 32,
    goal_size: 32,
    scenes: 1,
    turn: Duration::from_millis(10),
    turns: 3,
};

/// Turns 0 to `last` with every scene in each, as long as there is time. The first scene is warmed and measured once in any
/// case.
fn turns(end: Instant, last: usize, scenes: usize) -> impl Iterator<Item = (usize, usize)> {
    let is_due = move |&(turn, scene): &(usize, usize)| Instant::now() < end || (turn <= 1 && scene == 0);
    (0..=last).flat_map(move |turn| (0..scenes).map(move |scene| (turn, scene)).take_while(is_due))
}

/// An engine to measure: an adapter's, or the CPU's.
type TestedEngine = Option<GpuAdapter>;

fn opened(place: &TestedEngine, traversal: Traversal) -> Result<Session, StudyError> {
    Ok(match place {
        None => Session::open(EngineChoice::Cpu)?,
        Some(adapter) => Session::on_adapter(adapter, traversal)?,
    })
}

/// A document with its name.
struct Case {
    name: String,
    document: Document,
}

/// A run in progress.
struct Run<'a, 'b> {
    options: &'a BenchmarkOptions,
    extent: Extent,
    begun: Instant,
    steps: Steps<'a, 'b>,
    cases: Vec<Case>,
    goals: Vec<Goal>,
}

/// Steps of an engine, with their weights in its time. Each begins no turn after its end.
type Step = fn(&mut Run<'_, '_>, &TestedEngine, &mut EngineReport, Instant) -> Result<(), StudyError>;
const STEPS: [(&str, f64, Step); 2] = [("rate", 0.65, rate::rates), ("to clean", 0.35, goal::goals)];

/// Measures the machine. `watch` receives the progress and may stop the run.
///
/// # Errors
/// [`StudyError::Stopped`]; a temporary folder that cannot be written to. An engine that fails is part of the report.
pub fn benchmark(options: &BenchmarkOptions, watch: &mut Watch<'_>) -> Result<Report, StudyError> {
    let extent = if options.quick { QUICK } else { FULL };
    let folder = TempDir::new()?;
    let mut run = Run {
        options,
        extent,
        begun: Instant::now(),
        steps: Steps::new(watch, options.seconds),
        cases: Vec::new(),
        goals: Vec::new(),
    };
    run.report("the scenes")?;
    Scene::write_files(folder.path()).map_err(io::Error::other)?;
    run.cases = cases(&folder, extent);
    run.goals = goal::references(&mut run, &folder)?;
    let mut report = Report {
        schema: SCHEMA.to_owned(),
        schema_version: SCHEMA_VERSION,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        build: if cfg!(debug_assertions) { "debug" } else { "release" }.to_owned(),
        quick: options.quick,
        seconds: 0.0,
        machine: machine(),
        denoiser: Library::get().ok().map(ToString::to_string),
        peak_memory_mib: None,
        engines: Vec::new(),
    };
    let places = places(options.engine);
    if places.is_empty() {
        return Err(GpuError::NoAdapter("").into());
    }
    for (number, place) in places.iter().enumerate() {
        let left = Duration::from_secs_f64(options.seconds).saturating_sub(run.begun.elapsed());
        let share = left.div_f64((places.len() - number) as f64);
        report.engines.push(run.engine(place, share)?);
    }
    report.peak_memory_mib = peak_memory_mib();
    report.seconds = run.begun.elapsed().as_secs_f64();
    Ok(report)
}

/// The default scene, and those of the table in docs/PERFORMANCE.md.
fn cases(folder: &TempDir, extent: Extent) -> Vec<Case> {
    let of_scene = |scene: Scene| Case {
        name: scene.name(),
        document: scene.document(folder.path(), extent.size),
    };
    let default = Case {
        name: "default".to_owned(),
        document: default_scene(extent.size),
    };
    let scenes = Scene::all().take(extent.scenes).map(of_scene);
    std::iter::once(default).chain(scenes).collect()
}

fn default_scene(size: u32) -> Document {
    let mut document = Document::default();
    (document.render.width, document.render.height) = (size, size);
    document.render.adaptive = Some(false);
    document
}

fn places(engine: EngineChoice) -> Vec<TestedEngine> {
    let cpu = (engine != EngineChoice::Gpu).then_some(None);
    let adapters = if engine == EngineChoice::Cpu {
        Vec::new()
    } else {
        GpuAdapter::of_kind(AdapterKind::Any)
    };
    cpu.into_iter().chain(adapters.into_iter().map(Some)).collect()
}

impl Run<'_, '_> {
    /// Reports the current step; fails if the run is stopped.
    fn report(&mut self, what: &str) -> Result<(), StudyError> {
        self.steps.report(what, self.begun.elapsed().as_secs_f64())
    }

    /// All steps of an engine within a time.
    fn engine(&mut self, place: &TestedEngine, time: Duration) -> Result<EngineReport, StudyError> {
        let mut report = described(place);
        let begun = Instant::now();
        let mut share = 0.0;
        for (name, weight, step) in STEPS {
            share += weight;
            let end = begun + time.mul_f64(share);
            self.report(&format!("{}, {name}", report.name()))?;
            match step(self, place, &mut report, end) {
                Err(StudyError::Stopped) => return Err(StudyError::Stopped),
                Err(error) => report.leave_out(name, "", error.to_string()),
                Ok(()) => {}
            }
        }
        Ok(report)
    }
}

fn described(place: &TestedEngine) -> EngineReport {
    let [engine, adapter, backend, driver] = match place {
        None => ["cpu".to_owned(), cpu_name(), String::new(), String::new()],
        Some(adapter) => {
            let backend = adapter.info.backend.to_string();
            ["gpu".to_owned(), adapter.info.name.clone(), backend, adapter.driver()]
        }
    };
    EngineReport {
        engine,
        adapter,
        backend,
        driver,
        is_software: place.as_ref().is_none_or(GpuAdapter::is_software),
        rows: Vec::new(),
        left_out: Vec::new(),
    }
}

fn machine() -> Machine {
    let system =
        System::new_with_specifics(RefreshKind::nothing().with_memory(MemoryRefreshKind::nothing().with_ram()));
    Machine {
        cpu: cpu_name(),
        threads: rayon::current_num_threads(),
        memory_mib: system.map_or(0, |system| system.total_memory() >> 20),
        system: System::long_os_version().unwrap_or_else(|_| std::env::consts::OS.to_owned()),
        instructions: crate::cpu::instruction_set().to_owned(),
    }
}

/// Peak memory of the process; `None` if the system does not report it.
fn peak_memory_mib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kib / 1024.0)
}

/// What a step comes to.
type Done = Result<(), StudyError>;
