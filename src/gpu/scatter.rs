//! Samples of a lobe, drawn by the shader function that the path tracer runs (`shaders/pass/scatter.wgsl`).

use bytemuck::{Pod, Zeroable};

use super::compute::{self, UNIFORMS, WRITE};
use super::device::{GpuDevice, GpuError};
use super::scene_group;
use super::traversal::Traversal;
use crate::job::scatter::{ScatterCloud, ScatterRequest};
use crate::optics::vector::Vec3;

/// Samples a dispatch: within the limit of 65 535 workgroups of 64.
const BATCH: u32 = 1 << 20;

/// The uniforms, as in the shader.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Scatter {
    /// Unit direction to the viewer.
    pub wo: Vec3<f32>,
    /// Roughness in [0, 1].
    pub roughness: f32,
    /// Stretch in [−1, 1].
    pub anisotropy: f32,
    /// Relative index of refraction; 0 for reflection.
    pub eta: f32,
    /// The lobe as a number.
    pub lobe: u32,
    /// The curve as a number.
    pub curve: u32,
    /// The horizon policy as a number.
    pub horizon: u32,
    /// Changes all random numbers.
    pub seed: u32,
    /// Index of the first sample.
    pub first: u32,
    /// Samples of the dispatch.
    pub count: u32,
}

/// The shader that draws, compiled.
#[derive(Debug)]
pub struct Scatterer {
    gpu: GpuDevice,
    pipeline: wgpu::ComputePipeline,
    /// Layouts of the lobes' tables, and of uniforms and output.
    groups: [wgpu::BindGroupLayout; 2],
}

impl Scatterer {
    /// Compiles the shader.
    pub fn new(gpu: GpuDevice) -> Result<Self, GpuError> {
        let name = "scatter";
        let module = compute::module(&gpu, name, Traversal::Own)?;
        let groups = [
            scene_group::tables_layout(&gpu),
            compute::group_layout(&gpu, name, &[(0, UNIFORMS), (1, WRITE)]),
        ];
        let layout = compute::pipeline_layout(&gpu, name, &groups.each_ref().map(Some));
        let pipeline = compute::pipeline(&gpu, &module, &layout, "draw", &[], None)?;
        Ok(Self { gpu, pipeline, groups })
    }

    /// Draws the samples.
    pub fn draw(&self, request: &ScatterRequest) -> Result<ScatterCloud, GpuError> {
        let gpu = &self.gpu;
        let tables = scene_group::tables(gpu, &request.model.table)?;
        let out = gpu.empty_storage("the samples", u64::from(request.count.min(BATCH)) * 16)?;
        let mut samples = Vec::with_capacity(request.count as usize);
        for first in (0..request.count).step_by(BATCH as usize) {
            let count = (request.count - first).min(BATCH);
            let workgroups = [count.div_ceil(64), 1];
            let uniforms = gpu.uniforms(&uniforms(request, first, count));
            let groups = [
                scene_group::bind_tables(gpu, &self.groups[0], &tables),
                compute::bind_group(gpu, &self.groups[1], &[(0, &uniforms), (1, &out)], &[]),
            ];
            compute::dispatch(gpu, &self.pipeline, &groups.each_ref(), workgroups, None);
            samples.extend(gpu.read::<[f32; 4]>(&out, count as usize)?);
        }
        Ok(ScatterCloud::from_raw(samples))
    }
}

fn uniforms(request: &ScatterRequest, first: u32, count: u32) -> Scatter {
    let shape = request.model.shape();
    Scatter {
        wo: request.wo(),
        roughness: shape.roughness,
        anisotropy: shape.anisotropy,
        eta: shape.eta,
        lobe: shape.lobe as u32,
        curve: shape.curve as u32,
        horizon: shape.horizon as u32,
        seed: request.seed,
        first,
        count,
    }
}
