//! Choice of the device that denoises.

use std::str::FromStr;

use crate::named::{Named, named};
use crate::render::chosen::Chosen;

named! {
    /// Device that the user asks for.
    #[derive(Default)]
    DenoiseDevice {
        #[default]
        Auto, "auto", "Automatic", "The fastest by the library's own estimate.";
        Gpu, "gpu", "GPU", "A GPU (CUDA, HIP, SYCL, Metal); the CPU where none works.";
        Cpu, "cpu", "CPU", "The CPU.";
    }
}

impl FromStr for DenoiseDevice {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        Self::by_name(text).ok_or_else(|| format!("images are denoised on auto, gpu or cpu, not {text}"))
    }
}

static CHOSEN: Chosen<DenoiseDevice> = Chosen::first();

impl DenoiseDevice {
    /// Holds for all denoisers that are opened from now on.
    pub fn choose(self) {
        CHOSEN.set(self);
    }

    pub fn chosen() -> Self {
        CHOSEN.get()
    }

    /// Devices to try in order, by their places in the library's list, which begins with the fastest.
    pub(super) fn candidates(self, kinds: &[DeviceKind]) -> Vec<usize> {
        let places = |is_wanted: fn(DeviceKind) -> bool| (0..kinds.len()).filter(move |place| is_wanted(kinds[*place]));
        let is_cpu = |kind| kind == DeviceKind::Cpu;
        match self {
            Self::Auto => (0..kinds.len()).collect(),
            Self::Gpu => places(|kind| kind != DeviceKind::Cpu).chain(places(is_cpu)).collect(),
            Self::Cpu => places(is_cpu).collect(),
        }
    }
}

/// Kind of a device, as the library numbers it (`OIDNDeviceType`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DeviceKind {
    Cpu,
    Sycl,
    Cuda,
    Hip,
    Metal,
    Unknown,
}

impl DeviceKind {
    pub(super) fn of(number: i32) -> Self {
        match number {
            1 => Self::Cpu,
            2 => Self::Sycl,
            3 => Self::Cuda,
            4 => Self::Hip,
            5 => Self::Metal,
            _ => Self::Unknown,
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Cpu => "CPU",
            Self::Sycl => "SYCL",
            Self::Cuda => "CUDA",
            Self::Hip => "HIP",
            Self::Metal => "Metal",
            Self::Unknown => "unknown device",
        }
    }
}
