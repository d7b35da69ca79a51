//! Check, before a render, whether it fits into memory.

use super::engine::{EngineInfo, EngineKind};
pub use crate::import::limits::{LIMIT_VARIABLE, free, limit};
use crate::job::{Job, effect::EffectId, film::Extras};

/// Bytes per pixel besides the film: the mean image, the display image and the file's image.
const PICTURE_BYTES: u64 = 16 + 4 + 12;
/// Additional bytes per pixel with denoising: both halves with guides, and results. Measured, like the two below, by the
/// peak memory of renders of 512 to 3072 pixels a side.
const DENOISED_BYTES: u64 = 184;
/// Bytes per pixel of the library itself, up to the size from which it uses tiles.
const DENOISER_BYTES: u64 = 640;
const DENOISER_BYTES_MOST: u64 = 700 << 20;
/// Additional bytes per pixel if the GPU shares the CPU's memory: the GPU's sums.
const SOFTWARE_GPU_BYTES: u64 = 56;

/// Bytes per triangle of instances on a GPU: measured on software Vulkan, with 7.7 million triangles.
const INSTANCED_TRIANGLE_BYTES: u64 = 380;

/// Has large allocations go back to the system as soon as they are freed, from now on. The C library would soon keep what
/// has up to 32 MiB, in pieces that later images do not fit into. It keeps 4 MiB for small ones: below 128 KiB, as it would
/// be now, the threads' tiles would be new pages each time, which took a sixth of a first image's time.
pub fn return_what_is_freed() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: settings of the allocator's, for all of its later allocations.
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, 1 << 20);
        libc::mallopt(libc::M_TRIM_THRESHOLD, 4 << 20);
    }
}

/// Refuses a job that needs more than `allowed` bytes, in words: its image, or beside it the instances of its model, which a
/// GPU stores one by one.
pub fn check(job: &Job, engine: &EngineInfo, allowed: u64) -> Result<(), String> {
    let needs = Needs::of(job, engine);
    let needed = needs.bytes();
    let in_mib = |bytes: u64| bytes.div_ceil(1 << 20);
    let allowed_mib = allowed >> 20;
    if needed > allowed {
        let [width, height] = job.settings.image_size;
        let side = needs.pixels_within(allowed).isqrt();
        let remedy = if needs.is_denoised {
            ", or switch denoising off"
        } else {
            ""
        };
        return Err(format!(
            "an image of {width} x {height} pixels takes {} MiB of memory, and {allowed_mib} MiB are free for it. \
             Make it smaller (at most about {side} x {side}), or close other programs{remedy}",
            in_mib(needed)
        ));
    }
    let triangles = match engine.kind {
        EngineKind::Gpu => job.geometry.triangles_to_copy() as u64,
        EngineKind::Cpu => 0,
    };
    let copied = triangles * INSTANCED_TRIANGLE_BYTES;
    if triangles > 0 && copied + needed > allowed {
        return Err(format!(
            "on a GPU the {triangles} triangles of the model's instances take {} MiB of memory, and {allowed_mib} MiB are \
             free for them. Render on the CPU with --engine cpu, which stores each mesh once, or close other programs",
            in_mib(copied)
        ));
    }
    Ok(())
}

/// Memory of a job's render, including display and output.
#[derive(Clone, Copy, Debug)]
pub struct Needs {
    pixels: u64,
    pixel_bytes: u64,
    is_denoised: bool,
}

impl Needs {
    pub fn of(job: &Job, engine: &EngineInfo) -> Self {
        let is_software_gpu = engine.kind == EngineKind::Gpu && engine.is_software;
        let given = |is_given: bool, bytes: u64| if is_given { bytes } else { 0 };
        let extras = Extras::of(job);
        // The GPU's sums of both are at most as large as the film's.
        let kept = extras.pixel_bytes()
            - Extras {
                guides: 0,
                light_groups: 0,
                ..extras
            }
            .pixel_bytes();
        let [width, height] = job.settings.image_size;
        let is_denoised = job.plan.has(EffectId::Denoising);
        Self {
            pixels: u64::from(width) * u64::from(height),
            pixel_bytes: extras.pixel_bytes()
                + PICTURE_BYTES
                + given(is_denoised, DENOISED_BYTES)
                + given(is_software_gpu, SOFTWARE_GPU_BYTES + kept),
            is_denoised,
        }
    }

    pub fn bytes(&self) -> u64 {
        let of_library = (self.pixels * DENOISER_BYTES).min(DENOISER_BYTES_MOST);
        self.pixels * self.pixel_bytes + if self.is_denoised { of_library } else { 0 }
    }

    /// Number of pixels that fit into `bytes`.
    fn pixels_within(&self, bytes: u64) -> u64 {
        if !self.is_denoised {
            return bytes / self.pixel_bytes;
        }
        let in_one = bytes / (self.pixel_bytes + DENOISER_BYTES);
        let in_tiles = bytes.saturating_sub(DENOISER_BYTES_MOST) / self.pixel_bytes;
        in_one.max(in_tiles)
    }
}
