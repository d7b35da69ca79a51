//! Choice of the device that denoises.

use crate::named::named;

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

impl DenoiseDevice {
    /// Devices to try in order, by their places in the library's list, which begins with the fastest; given their kinds.
    pub fn candidates(self, kinds: &[i32]) -> Vec<usize> {
        let (cpus, gpus): (Vec<_>, Vec<_>) = (0..kinds.len()).partition(|place| kinds[*place] == CPU);
        match self {
            Self::Auto => (0..kinds.len()).collect(),
            Self::Gpu => [gpus, cpus].concat(),
            Self::Cpu => cpus,
        }
    }
}

/// The library's number of this kind of device (`OIDNDeviceType`).
pub const CPU: i32 = 1;

/// Name of a kind of device, by the library's number.
pub fn kind_name(kind: i32) -> &'static str {
    let names = ["unknown device", "CPU", "SYCL", "CUDA", "HIP", "Metal"];
    names.get(kind as usize).unwrap_or(&names[0])
}
