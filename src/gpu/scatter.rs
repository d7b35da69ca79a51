//! Samples of a lobe, drawn by the shader function that the path tracer runs (`shaders/pass/scatter.wgsl`).

use super::{
    compute::{self, UNIFORMS, WRITE},
    device::{GpuDevice, GpuError},
    scene_group::{self, TABLES_BINDING, TEXELS},
    traversal::Traversal,
};
use crate::{
    job::plain,
    job::scatter::{ScatterCloud, ScatterRequest},
    optics::vector::Vec3,
};

/// Samples a dispatch: within the limit of 65 535 workgroups of 64.
const BATCH: u32 = 1 << 20;

plain! {
    /// The uniforms, as in the shader.
    struct Scatter {
        /// Unit direction to the viewer.
        wo: Vec3<f32>,
        /// Roughness in [0, 1].
        roughness: f32,
        /// Stretch in [−1, 1].
        anisotropy: f32,
        /// Relative index of refraction; 0 for reflection.
        eta: f32,
        /// The lobe as a number.
        lobe: u32,
        /// The curve as a number.
        curve: u32,
        /// The horizon policy as a number.
        horizon: u32,
        /// Changes all random numbers.
        seed: u32,
        /// Index of the first sample.
        first: u32,
        /// Samples of the dispatch.
        count: u32,
    }
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
            compute::layout(&gpu, "tables", [(TABLES_BINDING, TEXELS)]),
            compute::layout(&gpu, name, [(0, UNIFORMS), (1, WRITE)]),
        ];
        let layout = compute::pipeline_layout(&gpu, name, groups.each_ref());
        let pipeline = compute::pipeline(&gpu, (&module, &layout), "draw", &[], None)?;
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
            let uniforms = gpu.uniforms(&uniforms(request, first, count));
            let texels = wgpu::BindingResource::TextureView(&tables);
            let buffers = [&uniforms, &out].map(wgpu::Buffer::as_entire_binding);
            let groups = [
                compute::bind(gpu, &self.groups[0], [(TABLES_BINDING, texels)]),
                compute::bind(gpu, &self.groups[1], (0..).zip(buffers)),
            ];
            compute::dispatch(gpu, &self.pipeline, groups.each_ref(), count.div_ceil(64), None);
            samples.extend(gpu.read::<[f32; 4]>(&out, 0..count as usize)?);
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
