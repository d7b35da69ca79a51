//! Samples of a lobe, drawn by the shader function that the path tracer runs (`shaders/pass/scatter.wgsl`).

use bytemuck::{Pod, Zeroable};
use wgpu::util::DeviceExt;

use super::device::{GpuDevice, GpuError};
use super::shader;
use crate::analysis::scatter::{ScatterCloud, ScatterRequest};
use crate::optics::vector::Vec3;

/// Samples a dispatch: within the limit of 65 535 workgroups of 64.
const BATCH: u32 = 1 << 20;

/// The uniforms, as in the shader.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Scatter {
    /// Towards the viewer.
    pub wo: Vec3<f32>,
    /// Roughness in [0, 1].
    pub roughness: f32,
    /// Stretch in [−1, 1].
    pub anisotropy: f32,
    /// 0 where the lobe reflects, else the relative index of refraction.
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
}

impl Scatterer {
    /// Compiles the shader.
    ///
    /// # Errors
    /// [`GpuError::Shader`] where the driver refuses it.
    pub fn new(gpu: GpuDevice) -> Result<Self, GpuError> {
        let pipeline = lobe_pipeline(&gpu, "scatter", "draw", &[])?;
        Ok(Self { gpu, pipeline })
    }

    /// Draws the samples.
    ///
    /// # Errors
    /// If the device fails.
    pub fn draw(&self, request: &ScatterRequest) -> Result<ScatterCloud, GpuError> {
        let gpu = &self.gpu;
        let table: &[f32] = if request.table.is_empty() {
            &[0.0]
        } else {
            &request.table
        };
        let tables = gpu.storage("the curve", bytemuck::cast_slice(table))?;
        let out = gpu.empty_storage("the samples", u64::from(request.count.min(BATCH)) * 16)?;
        let mut samples = Vec::with_capacity(request.count as usize);
        for first in (0..request.count).step_by(BATCH as usize) {
            let count = (request.count - first).min(BATCH);
            let uniforms = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("scatter"),
                contents: bytemuck::bytes_of(&uniforms(request, first, count)),
                usage: wgpu::BufferUsages::UNIFORM,
            });
            let groups = [
                bind_group(gpu, &self.pipeline, 0, &[(6, &tables)]),
                bind_group(gpu, &self.pipeline, 1, &[(0, &uniforms), (1, &out)]),
            ];
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            {
                let mut pass = encoder.begin_compute_pass(&Default::default());
                pass.set_pipeline(&self.pipeline);
                for (index, group) in (0..).zip(&groups) {
                    pass.set_bind_group(index, group, &[]);
                }
                pass.dispatch_workgroups(count.div_ceil(64), 1, 1);
            }
            gpu.queue.submit([encoder.finish()]);
            samples.extend(gpu.read::<[f32; 4]>(&out, count as usize)?);
        }
        Ok(ScatterCloud::from_raw(samples))
    }
}

fn uniforms(request: &ScatterRequest, first: u32, count: u32) -> Scatter {
    Scatter {
        wo: request.wo(),
        roughness: request.roughness,
        anisotropy: request.anisotropy,
        eta: request.eta,
        lobe: request.lobe as u32,
        curve: request.curve as u32,
        horizon: request.horizon as u32,
        seed: request.seed,
        first,
        count,
    }
}

/// A pass of `shaders/pass/` that needs nothing of a scene but the lobes: the tables in group 0, in group 1 uniforms and
/// what is written.
pub(super) fn lobe_pipeline(
    gpu: &GpuDevice,
    name: &str,
    entry_point: &str,
    constants: &[(&str, f64)],
) -> Result<wgpu::ComputePipeline, GpuError> {
    let linked = shader::link(&format!("pass/{name}")).map_err(GpuError::Shader)?;
    let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(name),
        source: wgpu::ShaderSource::Wgsl(linked.source.as_str().into()),
    });
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
    let layout = |entries: &[wgpu::BindGroupLayoutEntry]| {
        gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(name),
            entries,
        })
    };
    let tables = layout(&[entry(6, storage(true))]);
    let own = layout(&[entry(0, wgpu::BufferBindingType::Uniform), entry(1, storage(false))]);
    let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(name),
        bind_group_layouts: &[Some(&tables), Some(&own)],
        immediate_size: 0,
    });
    let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(name),
        layout: Some(&pipeline_layout),
        module: &module,
        entry_point: Some(entry_point),
        compilation_options: wgpu::PipelineCompilationOptions {
            constants,
            ..Default::default()
        },
        cache: None,
    });
    match pollster::block_on(scope.pop()) {
        Some(error) => Err(GpuError::Shader(error.to_string())),
        None => Ok(pipeline),
    }
}

pub(super) fn bind_group(
    gpu: &GpuDevice,
    pipeline: &wgpu::ComputePipeline,
    group: u32,
    buffers: &[(u32, &wgpu::Buffer)],
) -> wgpu::BindGroup {
    let entries: Vec<_> = buffers
        .iter()
        .map(|(binding, buffer)| wgpu::BindGroupEntry {
            binding: *binding,
            resource: buffer.as_entire_binding(),
        })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("scatter"),
        layout: &pipeline.get_bind_group_layout(group),
        entries: &entries,
    })
}
