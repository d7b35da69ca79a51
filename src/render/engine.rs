//! Choice and opening of the engine.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;
use std::time::Duration;

use super::calibration;
use crate::cpu::CpuEngine;
use crate::gpu::scatter::Scatterer;
use crate::gpu::{AdapterKind, GpuAdapter, GpuDevice, GpuEngine, GpuError, Traversal};
use crate::job::Job;
use crate::job::film::Film;
use crate::job::scatter::{ScatterCloud, ScatterRequest};
use crate::job::tiles::Schedule;
use crate::named::{Named, named};

named! {
    /// The engine that a user asks for.
    #[derive(Default)]
    EngineChoice {
        #[default]
        Auto, "auto", "Automatic", "A hardware GPU if there is one, else the faster of software Vulkan and the CPU.";
        Gpu, "gpu", "GPU", "The GPU, software Vulkan included.";
        Cpu, "cpu", "CPU", "The CPU.";
    }
}

impl FromStr for EngineChoice {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        Self::by_name(text).ok_or_else(|| format!("no engine is called {text}: auto, gpu or cpu"))
    }
}

named! {
    /// Kind of engine: CPU or GPU.
    EngineKind {
        Gpu, "gpu", "GPU", "Compute shaders on an adapter.";
        Cpu, "cpu", "CPU", "Rust on the cores of the CPU.";
    }
}

impl From<EngineKind> for EngineChoice {
    fn from(kind: EngineKind) -> Self {
        match kind {
            EngineKind::Gpu => Self::Gpu,
            EngineKind::Cpu => Self::Cpu,
        }
    }
}

/// The engine in use, and why it was chosen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EngineInfo {
    /// Kind of the engine.
    pub kind: EngineKind,
    /// Name of the adapter or CPU.
    pub adapter: String,
    /// Driver of the adapter; empty for the CPU.
    pub driver: String,
    /// Why this engine, in words.
    pub reason: String,
    /// How rays are traced on the engine.
    pub traversal: Traversal,
    /// True if the CPU does the work, by either engine.
    pub is_software: bool,
}

impl fmt::Display for EngineInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} on {}", self.kind.name(), self.adapter)
    }
}

/// Precision of shading on the CPU; the GPU has f32 only. Sums are f64 in either case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize)]
pub enum Precision {
    /// f32.
    #[default]
    #[serde(rename = "f32")]
    Single,
    /// f64.
    #[serde(rename = "f64")]
    Double,
}

/// One of the two engines.
pub(super) enum Engine {
    Cpu(Box<CpuEngine>),
    Gpu(Box<GpuEngine>),
}

/// The reason given for an engine that the user chose.
const CHOSEN: &str = "chosen by you";

impl Engine {
    /// Opens the requested engine. If the faster engine is unknown, it is measured for seconds; or, with `may_wait` false,
    /// in the background for the next start.
    pub(super) fn open(choice: EngineChoice, may_wait: bool) -> Result<(Self, EngineInfo), GpuError> {
        match choice {
            EngineChoice::Cpu => Ok(cpu(CHOSEN.to_owned())),
            EngineChoice::Gpu => on_adapter(&GpuAdapter::find(AdapterKind::Any)?, CHOSEN, may_wait),
            EngineChoice::Auto => Ok(auto(may_wait)),
        }
    }

    pub(super) fn submit(&mut self, job: Arc<Job>) -> Result<(), GpuError> {
        match self {
            Engine::Cpu(engine) => {
                engine.submit(job);
                Ok(())
            }
            Engine::Gpu(engine) => engine.submit(job),
        }
    }

    /// Renders for about `budget` towards a number of samples per pixel for each tile.
    pub(super) fn step(&mut self, budget: Duration, goals: &[u32], precision: Precision) -> Result<(), GpuError> {
        match self {
            Engine::Cpu(engine) => {
                match precision {
                    Precision::Single => engine.step_towards(budget, goals),
                    Precision::Double => engine.step_double_towards(budget, goals),
                }
                Ok(())
            }
            Engine::Gpu(engine) => engine.step_towards(budget, goals),
        }
    }

    /// The GPU's device, if it renders.
    pub(super) fn device(&self) -> Option<&GpuDevice> {
        match self {
            Engine::Cpu(_) => None,
            Engine::Gpu(engine) => Some(engine.device()),
        }
    }

    pub(super) fn schedule(&self) -> &Schedule {
        match self {
            Engine::Cpu(engine) => engine.schedule(),
            Engine::Gpu(engine) => engine.schedule(),
        }
    }

    /// GPU time of the job by its own clock, in seconds; `None` without one.
    pub(super) fn gpu_seconds(&self) -> Option<f64> {
        match self {
            Engine::Cpu(_) => None,
            Engine::Gpu(engine) => engine.gpu_seconds(),
        }
    }

    pub(super) fn film(&mut self) -> Result<&Film, GpuError> {
        match self {
            Engine::Cpu(engine) => Ok(engine.film()),
            Engine::Gpu(engine) => engine.film(),
        }
    }
}

pub(super) fn cpu(reason: String) -> (Engine, EngineInfo) {
    let threads = rayon::current_num_threads();
    let info = EngineInfo {
        kind: EngineKind::Cpu,
        adapter: format!("{} ({threads} threads)", cpu_name()),
        driver: String::new(),
        reason,
        traversal: Traversal::Own,
        is_software: true,
    };
    (Engine::Cpu(Box::default()), info)
}

pub(super) fn gpu(device: GpuDevice, reason: String) -> Result<(Engine, EngineInfo), GpuError> {
    let info = EngineInfo {
        kind: EngineKind::Gpu,
        adapter: device.info.name.clone(),
        driver: device.driver(),
        reason,
        traversal: device.traversal,
        is_software: device.is_software(),
    };
    Ok((Engine::Gpu(Box::new(GpuEngine::new(device)?)), info))
}

/// Name of the CPU, if the system reports it.
pub(super) fn cpu_name() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    name.map_or_else(
        || format!("{} CPU", std::env::consts::ARCH),
        |(_, name)| name.trim().to_owned(),
    )
}

/// An adapter's engine, chosen for the reason `why`, with its preferred traversal; with our own if ray queries fail.
fn on_adapter(adapter: &GpuAdapter, why: &str, may_wait: bool) -> Result<(Engine, EngineInfo), GpuError> {
    let (traversal, about_it) = calibration::traversal(adapter, may_wait);
    let reason = match about_it.as_str() {
        "" => why.to_owned(),
        about_it => format!("{why}; {about_it}"),
    };
    match adapter.open(traversal).and_then(|device| gpu(device, reason)) {
        Err(error) if traversal == Traversal::RayQueries => {
            let reason = format!("{why}; its ray queries do not work: {error}");
            gpu(adapter.open(Traversal::Own)?, reason)
        }
        opened => opened,
    }
}

fn auto(may_wait: bool) -> (Engine, EngineInfo) {
    let hardware = GpuAdapter::find(AdapterKind::Hardware);
    match hardware.and_then(|adapter| on_adapter(&adapter, "a hardware GPU", may_wait)) {
        Ok(opened) => opened,
        Err(_) => calibration::fastest_without_hardware(may_wait),
    }
}

/// The device for single functions; `None` for the CPU, which `auto` uses without a hardware GPU.
///
/// # Errors
///
/// If a GPU was requested and fails.
pub(super) fn device_for_functions(choice: EngineChoice) -> Result<Option<GpuDevice>, GpuError> {
    let open = |kind| {
        let adapter = GpuAdapter::find(kind)?;
        adapter.open(calibration::traversal(&adapter, false).0)
    };
    match choice {
        EngineChoice::Cpu => Ok(None),
        EngineChoice::Gpu => open(AdapterKind::Any).map(Some),
        EngineChoice::Auto => Ok(open(AdapterKind::Hardware).ok()),
    }
}

/// Draws samples of lobes with the function that the chosen engine renders with.
pub enum Sampler {
    /// On the CPU.
    Cpu,
    /// On the GPU.
    Gpu(Box<Scatterer>),
}

impl Sampler {
    /// Opens the requested engine; `auto` uses the CPU without a hardware GPU.
    ///
    /// # Errors
    ///
    /// If a GPU was requested and fails.
    pub fn open(choice: EngineChoice) -> Result<Self, GpuError> {
        Ok(match device_for_functions(choice)? {
            Some(device) => Self::Gpu(Box::new(Scatterer::new(device)?)),
            None => Self::Cpu,
        })
    }

    /// Draws the samples.
    ///
    /// # Errors
    /// If the GPU fails.
    pub fn draw(&self, request: &ScatterRequest) -> Result<ScatterCloud, GpuError> {
        match self {
            Self::Cpu => Ok(crate::cpu::scatter::scatter(request)),
            Self::Gpu(scatterer) => scatterer.draw(request),
        }
    }
}
