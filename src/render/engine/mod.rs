//! The two engines behind one interface.

pub mod choice;
mod prober;

use std::{fmt, sync::Arc, time::Duration};

use crate::{
    cpu::CpuEngine,
    gpu::{GpuDevice, GpuEngine, GpuError, Traversal},
    job::{Job, film::Film, tiles::Schedule},
    named::named,
};

pub use choice::{MachineOptions, RayQueries};
pub use prober::Prober;

named! {
    /// The engine that a user asks for.
    #[derive(Default)]
    EngineChoice {
        #[default]
        Auto, "auto", "Automatic", "A hardware GPU if there is one, else the CPU.";
        Gpu, "gpu", "GPU", "The GPU, software Vulkan included.";
        Cpu, "cpu", "CPU", "The CPU.";
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

named! {
    /// Precision in which `evaluate` asks for a material on the CPU; the engines shade in f32.
    #[derive(Default)]
    Precision {
        #[default]
        Single, "f32", "f32", "What the engines shade in.";
        Double, "f64", "f64", "On the CPU alone.";
    }
}

/// One of the two engines.
pub enum Engine {
    Cpu(Box<CpuEngine>),
    Gpu(Box<GpuEngine>),
}

impl Default for Engine {
    fn default() -> Self {
        Self::Cpu(Box::default())
    }
}

impl Engine {
    pub fn submit(&mut self, job: Arc<Job>) -> Result<(), GpuError> {
        match self {
            Engine::Cpu(engine) => {
                engine.submit(job);
                Ok(())
            }
            Engine::Gpu(engine) => engine.submit(job),
        }
    }

    /// Renders for about `budget` towards a number of samples per pixel for each tile.
    pub fn step(&mut self, budget: Duration, goals: &[u32]) -> Result<(), GpuError> {
        match self {
            Engine::Cpu(engine) => {
                engine.step_towards(budget, goals);
                Ok(())
            }
            Engine::Gpu(engine) => engine.step_towards(budget, goals),
        }
    }

    /// The GPU's device, if it renders.
    pub fn device(&self) -> Option<&GpuDevice> {
        match self {
            Engine::Cpu(_) => None,
            Engine::Gpu(engine) => Some(engine.device()),
        }
    }

    pub fn schedule(&self) -> &Schedule {
        match self {
            Engine::Cpu(engine) => engine.schedule(),
            Engine::Gpu(engine) => engine.schedule(),
        }
    }

    /// GPU time of the job by its own clock, in seconds; `None` without one.
    pub fn gpu_seconds(&self) -> Option<f64> {
        match self {
            Engine::Cpu(_) => None,
            Engine::Gpu(engine) => engine.gpu_seconds(),
        }
    }

    pub fn film(&mut self) -> Result<&Film, GpuError> {
        match self {
            Engine::Cpu(engine) => Ok(engine.film()),
            Engine::Gpu(engine) => engine.film(),
        }
    }

    /// The film of an engine that ends.
    pub fn into_film(self) -> Result<Film, GpuError> {
        match self {
            Engine::Cpu(engine) => Ok(engine.hand_over().0),
            Engine::Gpu(engine) => engine.into_film(),
        }
    }
}

pub fn cpu(reason: String) -> (Engine, EngineInfo) {
    let threads = rayon::current_num_threads();
    let info = EngineInfo {
        kind: EngineKind::Cpu,
        adapter: format!("{} ({threads} threads)", cpu_name()),
        driver: String::new(),
        reason,
        traversal: Traversal::Own,
        is_software: true,
    };
    (Engine::default(), info)
}

pub fn gpu(device: GpuDevice, reason: String) -> Result<(Engine, EngineInfo), GpuError> {
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
pub fn cpu_name() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    name.map_or_else(
        || format!("{} CPU", std::env::consts::ARCH),
        |(_, name)| name.trim().to_owned(),
    )
}
