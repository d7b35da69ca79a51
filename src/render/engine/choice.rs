//! Choice and opening of the engine.

use std::sync::OnceLock;

use super::{Engine, EngineChoice, EngineInfo, cpu, gpu};
use crate::{
    gpu::{AdapterKind, GpuAdapter, GpuDevice, GpuError, Traversal},
    named::named,
    render::denoise::DenoiseDevice,
};

named! {
    /// Whether kernels use ray queries instead of our own traversal.
    #[derive(Default)]
    RayQueries {
        #[default]
        Auto, "auto", "Automatic", "On a hardware GPU that has them.";
        On, "on", "On", "Wherever the adapter has them.";
        Off, "off", "Off", "Never.";
    }
}

/// What the command line says of the machine. It holds for the whole process, and is never changed: each session, worker,
/// queue and study would carry the same two choices otherwise.
#[derive(Clone, Copy, Debug, Default)]
pub struct MachineOptions {
    pub ray_queries: RayQueries,
    pub denoise_device: DenoiseDevice,
}

static MACHINE: OnceLock<MachineOptions> = OnceLock::new();

impl MachineOptions {
    /// Holds from now on, if nothing was asked for before.
    pub fn set(ray_queries: RayQueries, denoise_device: DenoiseDevice) {
        MACHINE.get_or_init(|| Self {
            ray_queries,
            denoise_device,
        });
    }

    pub fn get() -> Self {
        *MACHINE.get_or_init(Self::default)
    }
}

/// The reason given for an engine that the user chose.
pub const CHOSEN_BY_YOU: &str = "chosen by you";

/// Opens the requested engine.
pub fn open(choice: EngineChoice) -> Result<(Engine, EngineInfo), GpuError> {
    match choice {
        EngineChoice::Cpu => Ok(cpu(CHOSEN_BY_YOU.to_owned())),
        EngineChoice::Gpu => on_adapter(&GpuAdapter::find(AdapterKind::Any)?, CHOSEN_BY_YOU),
        EngineChoice::Auto => Ok(auto()),
    }
}

/// An adapter's engine, chosen for the reason `why`, with its preferred traversal; with our own if ray queries fail.
fn on_adapter(adapter: &GpuAdapter, why: &str) -> Result<(Engine, EngineInfo), GpuError> {
    let (traversal, about_it) = traversal(adapter);
    let reason = match about_it {
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

fn auto() -> (Engine, EngineInfo) {
    let hardware = GpuAdapter::find(AdapterKind::Hardware);
    hardware
        .and_then(|adapter| on_adapter(&adapter, "a hardware GPU"))
        .unwrap_or_else(|error| match error {
            GpuError::NoAdapter(_) => cpu("no hardware GPU".to_owned()),
            error => cpu(format!("the hardware GPU does not work: {error}")),
        })
}

/// Traversal on an adapter, with what there is to say about the choice. On software Vulkan, ray queries are slower than our
/// own traversal.
fn traversal(adapter: &GpuAdapter) -> (Traversal, &'static str) {
    match (MachineOptions::get().ray_queries, adapter.has_ray_queries()) {
        (RayQueries::On, true) => (Traversal::RayQueries, "with ray queries, chosen by you"),
        (RayQueries::On, false) => (Traversal::Own, "without ray queries, which the adapter does not have"),
        (RayQueries::Off, true) => (Traversal::Own, "without ray queries, chosen by you"),
        (RayQueries::Auto, true) if !adapter.is_software() => (Traversal::RayQueries, "with its ray queries"),
        _ => (Traversal::Own, ""),
    }
}

/// The device for single functions; `None` for the CPU, which `auto` uses without a hardware GPU.
pub(super) fn device_for_functions(choice: EngineChoice) -> Result<Option<GpuDevice>, GpuError> {
    let open = |kind| {
        let adapter = GpuAdapter::find(kind)?;
        adapter.open(traversal(&adapter).0)
    };
    match choice {
        EngineChoice::Cpu => Ok(None),
        EngineChoice::Gpu => open(AdapterKind::Any).map(Some),
        EngineChoice::Auto => Ok(open(AdapterKind::Hardware).ok()),
    }
}
