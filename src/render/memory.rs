//! Check, before a render, whether it fits into memory.

pub use crate::import::free_memory::LIMIT_VARIABLE;
pub(super) use crate::import::free_memory::{free, limit};
use crate::job::Job;
use crate::job::effect::EffectId;
use crate::job::film::Extras;

/// Bytes per pixel besides the film: the mean image, the display image and the file's image.
const PICTURE_BYTES: u64 = 16 + 4 + 12;
/// Additional bytes per pixel with denoising: both halves with guides, and results. Measured, like the two below, by the
/// peak memory of renders of 512 to 3072 pixels a side.
const DENOISED_BYTES: u64 = 184;
/// Bytes per pixel of the library itself, up to the size from which it uses tiles.
const DENOISER_BYTES: u64 = 640;
const DENOISER_BYTES_MOST: u64 = 1_600 << 20;
/// Additional bytes per pixel if the GPU shares the CPU's memory: the GPU's sums.
const SOFTWARE_GPU_BYTES: u64 = 56;

/// Bytes per triangle of instances on a GPU: measured on software Vulkan, with 7.7 million triangles.
const INSTANCED_TRIANGLE_BYTES: u64 = 380;

/// The model's instances are too large for a GPU engine, which stores them one by one.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "on a GPU the {triangles} triangles of the model's instances take {needed_mib} MiB of memory, and {allowed_mib} MiB are \
     free for them. Render on the CPU with --engine cpu, which stores each mesh once, or close other programs"
)]
pub struct InstancesTooLarge {
    triangles: u64,
    needed_mib: u64,
    allowed_mib: u64,
}

/// The render is too large.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "an image of {width} x {height} pixels takes {needed_mib} MiB of memory, and {allowed_mib} MiB are free for it. \
     Make it smaller (at most about {side} x {side}), or close other programs{remedy}"
)]
pub struct TooLarge {
    width: u32,
    height: u32,
    needed_mib: u64,
    allowed_mib: u64,
    /// Side of the largest square image that fits, in pixels.
    side: u64,
    remedy: &'static str,
}

/// Refuses a job that needs more than `allowed` bytes. `is_software_gpu`: the GPU shares the CPU's memory.
pub(super) fn check(job: &Job, is_software_gpu: bool, allowed: u64) -> Result<(), TooLarge> {
    let needs = Needs::of(job, is_software_gpu);
    let needed = needs.bytes();
    if needed <= allowed {
        return Ok(());
    }
    let [width, height] = job.settings.image_size;
    Err(TooLarge {
        width,
        height,
        needed_mib: needed.div_ceil(1 << 20),
        allowed_mib: allowed >> 20,
        side: needs.pixels_within(allowed).isqrt(),
        remedy: if needs.is_denoised {
            ", or switch denoising off"
        } else {
            ""
        },
    })
}

/// Refuses a job for a GPU engine whose instances need more than `allowed` bytes, beside the image.
pub(super) fn check_instances(job: &Job, is_software_gpu: bool, allowed: u64) -> Result<(), InstancesTooLarge> {
    let triangles = job.geometry.triangles_to_copy() as u64;
    let needed = triangles * INSTANCED_TRIANGLE_BYTES;
    if triangles == 0 || needed + Needs::of(job, is_software_gpu).bytes() <= allowed {
        return Ok(());
    }
    Err(InstancesTooLarge {
        triangles,
        needed_mib: needed.div_ceil(1 << 20),
        allowed_mib: allowed >> 20,
    })
}

/// Memory of a job's render, including display and output.
#[derive(Clone, Copy, Debug)]
pub(super) struct Needs {
    pixels: u64,
    pixel_bytes: u64,
    is_denoised: bool,
}

impl Needs {
    pub(super) fn of(job: &Job, is_software_gpu: bool) -> Self {
        let given = |is_given: bool, bytes: u64| if is_given { bytes } else { 0 };
        let extras = Extras::of(job);
        // The GPU's sums of both are at most as large as the film's.
        let kept = extras.pixel_bytes()
            - Extras {
                guides: false,
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

    pub(super) fn bytes(&self) -> u64 {
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
