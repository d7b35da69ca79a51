//! Choice and opening of the engine.

use super::calibration;
use super::{Engine, EngineChoice, EngineInfo, cpu, gpu};
use crate::gpu::scatter::Scatterer;
use crate::gpu::{AdapterKind, GpuAdapter, GpuDevice, GpuError, Traversal};
use crate::job::scatter::{ScatterCloud, ScatterRequest};

/// The reason given for an engine that the user chose.
const CHOSEN: &str = "chosen by you";

/// Opens the requested engine. If the faster engine is unknown, it is measured for seconds; or, with `may_wait` false,
/// in the background for the next start.
pub(in crate::render) fn open(choice: EngineChoice, may_wait: bool) -> Result<(Engine, EngineInfo), GpuError> {
    match choice {
        EngineChoice::Cpu => Ok(cpu(CHOSEN.to_owned())),
        EngineChoice::Gpu => on_adapter(&GpuAdapter::find(AdapterKind::Any)?, CHOSEN, may_wait),
        EngineChoice::Auto => Ok(auto(may_wait)),
    }
}

/// The engine of an open device.
pub(in crate::render) fn on_device(device: GpuDevice) -> Result<(Engine, EngineInfo), GpuError> {
    gpu(device, CHOSEN.to_owned())
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
pub(crate) fn device_for_functions(choice: EngineChoice) -> Result<Option<GpuDevice>, GpuError> {
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
