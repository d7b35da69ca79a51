//! Parts of every compute pass: module, layouts, pipeline, bindings, dispatch.

use super::device::{GpuDevice, GpuError, Moment};
use super::shader;
use super::timer::Timer;
use super::traversal::Traversal;

pub(super) const UNIFORMS: wgpu::BufferBindingType = wgpu::BufferBindingType::Uniform;
pub(super) const READ: wgpu::BufferBindingType = wgpu::BufferBindingType::Storage { read_only: true };
pub(super) const WRITE: wgpu::BufferBindingType = wgpu::BufferBindingType::Storage { read_only: false };

/// A part of a pipeline, or the driver's objection to its shader.
pub(super) fn validated<T>(gpu: &GpuDevice, make: impl FnOnce(&wgpu::Device) -> T) -> Result<T, GpuError> {
    gpu.checked(GpuError::Shader, make)
}

/// The module of `shaders/pass/NAME.wgsl` for rays that go this way, every access checked.
///
/// # Errors
/// [`GpuError::Shader`] with the module and line.
pub(super) fn module(gpu: &GpuDevice, name: &str, traversal: Traversal) -> Result<wgpu::ShaderModule, GpuError> {
    let linked = shader::link_for(&format!("pass/{name}"), traversal).map_err(GpuError::Shader)?;
    validated(gpu, |device| {
        device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(name),
            source: wgpu::ShaderSource::Wgsl(linked.source.as_str().into()),
        })
    })
}

/// A buffer's place in a group.
pub(super) fn buffer_entry(binding: u32, ty: wgpu::BufferBindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    }
}

/// A texture's place in a group.
pub(super) fn texture_entry(
    binding: u32,
    sample_type: wgpu::TextureSampleType,
    view_dimension: wgpu::TextureViewDimension,
) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Texture {
            sample_type,
            view_dimension,
            multisampled: false,
        },
        count: None,
    }
}

/// A group of buffers.
pub(super) fn group_layout(
    gpu: &GpuDevice,
    name: &str,
    buffers: &[(u32, wgpu::BufferBindingType)],
) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = buffers
        .iter()
        .map(|(binding, ty)| buffer_entry(*binding, *ty))
        .collect();
    layout(gpu, name, &entries)
}

/// A group of these entries.
pub(super) fn layout(gpu: &GpuDevice, name: &str, entries: &[wgpu::BindGroupLayoutEntry]) -> wgpu::BindGroupLayout {
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(name),
        entries,
    })
}

pub(super) fn pipeline_layout(
    gpu: &GpuDevice,
    name: &str,
    groups: &[Option<&wgpu::BindGroupLayout>],
) -> wgpu::PipelineLayout {
    gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(name),
        bind_group_layouts: groups,
        immediate_size: 0,
    })
}

/// A compute pipeline of an entry point with constants.
pub(super) fn pipeline(
    gpu: &GpuDevice,
    module: &wgpu::ShaderModule,
    layout: &wgpu::PipelineLayout,
    entry_point: &str,
    constants: &[(&str, f64)],
    cache: Option<&wgpu::PipelineCache>,
) -> Result<wgpu::ComputePipeline, GpuError> {
    gpu.reach(Moment::Compiling);
    validated(gpu, |device| {
        device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry_point),
            layout: Some(layout),
            module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants,
                // No pass has any.
                zero_initialize_workgroup_memory: false,
            },
            cache,
        })
    })
}

/// Buffers and textures bound to their places.
pub(super) fn bind_group(
    gpu: &GpuDevice,
    layout: &wgpu::BindGroupLayout,
    buffers: &[(u32, &wgpu::Buffer)],
    textures: &[(u32, &wgpu::TextureView)],
) -> wgpu::BindGroup {
    let buffers = buffers
        .iter()
        .map(|(binding, buffer)| (*binding, buffer.as_entire_binding()));
    let textures = textures
        .iter()
        .map(|(binding, view)| (*binding, wgpu::BindingResource::TextureView(view)));
    bind(gpu, layout, buffers.chain(textures))
}

/// Resources bound to their places.
pub(super) fn bind<'a>(
    gpu: &GpuDevice,
    layout: &wgpu::BindGroupLayout,
    resources: impl Iterator<Item = (u32, wgpu::BindingResource<'a>)>,
) -> wgpu::BindGroup {
    let entries: Vec<_> = resources
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout,
        entries: &entries,
    })
}

/// Submits one dispatch, timed if there is a timer.
pub(super) fn dispatch(
    gpu: &GpuDevice,
    pipeline: &wgpu::ComputePipeline,
    groups: &[&wgpu::BindGroup],
    workgroups: [u32; 2],
    timer: Option<&Timer>,
) {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: None,
            timestamp_writes: timer.map(Timer::writes),
        });
        pass.set_pipeline(pipeline);
        for (index, group) in (0..).zip(groups) {
            pass.set_bind_group(index, *group, &[]);
        }
        pass.dispatch_workgroups(workgroups[0], workgroups[1], 1);
    }
    if let Some(timer) = timer {
        timer.resolve(&mut encoder);
    }
    gpu.queue.submit([encoder.finish()]);
    gpu.reach(Moment::Rendering);
    if let Some(timer) = timer {
        timer.request();
    }
}
