//! Cost of sampling directions on the GPU in isolation (`shaders/pass/sampling.wgsl`).

use std::collections::HashMap;
use std::time::Instant;

use bytemuck::{Pod, Zeroable};

use super::device::{GpuDevice, GpuError};
use super::scatter::LobePass;
use super::scene_group;
use super::timer::Timer;
use crate::job::sampling::{QUAD_NORMAL, SamplingRequest, SamplingRun};
use crate::optics::vector::Vec3;

/// Pixels along a side of a workgroup.
const GROUP_SIDE: u32 = 8;

/// The uniforms, as in the shader.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Sampling {
    /// Normal of the quad.
    pub normal: Vec3<f32>,
    /// Roughness in (0, 1].
    pub roughness: f32,
    /// Width of the image in pixels.
    pub width: u32,
    /// Rows of pixels that are drawn.
    pub rows: u32,
    /// Height of the whole image in pixels.
    pub height: u32,
    /// Directions per pixel.
    pub samples: u32,
    /// Changes all random numbers.
    pub seed: u32,
    /// Nothing.
    pub reserved_a: u32,
    /// Nothing.
    pub reserved_b: u32,
    /// Nothing.
    pub reserved_c: u32,
}

/// Kernels of lobes, curves and stages, each compiled at its first use.
#[derive(Debug)]
pub struct SamplingMeter {
    gpu: GpuDevice,
    timer: Option<Timer>,
    kernels: HashMap<[u32; 3], LobePass>,
}

impl SamplingMeter {
    /// On an open device.
    pub fn new(gpu: GpuDevice) -> Self {
        Self {
            timer: Timer::new(&gpu),
            gpu,
            kernels: HashMap::new(),
        }
    }

    /// Runs the pass, timed by the GPU's clock if it has one.
    ///
    /// # Errors
    ///
    /// If the device fails, or with the errors of [`GpuDevice::empty_storage`].
    pub fn run(&mut self, request: &SamplingRequest) -> Result<SamplingRun, GpuError> {
        let kernel = [request.lobe as u32, request.curve as u32, request.stage as u32];
        if !self.kernels.contains_key(&kernel) {
            let names = ["SAMPLED_LOBE", "SAMPLED_CURVE", "SAMPLED_STAGE"];
            let constants: Vec<_> = std::iter::zip(names, kernel.map(f64::from)).collect();
            let pass = LobePass::new(&self.gpu, "sampling", "measure", &constants)?;
            self.kernels.insert(kernel, pass);
            // Some drivers compile at the first dispatch.
            self.run(&SamplingRequest {
                rows: request.rows.min(GROUP_SIDE),
                samples: 1,
                ..*request
            })?;
        }
        let pixels = request.width as usize * request.rows as usize;
        let gpu = &self.gpu;
        let tables = scene_group::tables(gpu, &[])?;
        let out = gpu.empty_storage("the sums", 4 * pixels as u64)?;
        let workgroups = [request.width, request.rows].map(|side| side.div_ceil(GROUP_SIDE));
        let begun = Instant::now();
        self.kernels[&kernel].dispatch(gpu, &tables, &out, &uniforms(request), workgroups, self.timer.as_ref());
        gpu.wait()?;
        let seconds = begun.elapsed().as_secs_f64();
        let by_timer = self.timer.as_ref().map(Timer::seconds).transpose()?;
        let sums: Vec<f32> = gpu.read(&out, pixels)?;
        Ok(SamplingRun {
            seconds: by_timer.unwrap_or(seconds),
            sum: sums.into_iter().map(f64::from).sum(),
        })
    }
}

fn uniforms(request: &SamplingRequest) -> Sampling {
    Sampling {
        normal: Vec3::from_f64(QUAD_NORMAL),
        roughness: request.roughness,
        width: request.width,
        rows: request.rows,
        height: request.height,
        samples: request.samples,
        seed: request.seed,
        reserved_a: 0,
        reserved_b: 0,
        reserved_c: 0,
    }
}
