//! Parts of every compute pass: module, layouts, pipeline, bindings, dispatch.

use super::{
    device::{GpuDevice, GpuError, Moment},
    shader,
    timer::Timer,
    traversal::Traversal,
};

/// The path tracer's pass, and its entry point.
pub const PATH_TRACE: &str = "path_trace";

pub const UNIFORMS: wgpu::BindingType = buffer(wgpu::BufferBindingType::Uniform);
pub const READ: wgpu::BindingType = buffer(wgpu::BufferBindingType::Storage { read_only: true });
pub const WRITE: wgpu::BindingType = buffer(wgpu::BufferBindingType::Storage { read_only: false });

const fn buffer(ty: wgpu::BufferBindingType) -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

/// The module of `shaders/pass/NAME.wgsl` for rays that go this way.
///
/// # Errors
/// [`GpuError::Shader`] with the module and line.
pub fn module(gpu: &GpuDevice, name: &str, traversal: Traversal) -> Result<wgpu::ShaderModule, GpuError> {
    let linked = shader::link_for(&format!("pass/{name}"), traversal).map_err(GpuError::Shader)?;
    let descriptor = wgpu::ShaderModuleDescriptor {
        label: Some(name),
        source: wgpu::ShaderSource::Wgsl(linked.source.as_str().into()),
    };
    gpu.checked(GpuError::Shader, |device| match name {
        // SAFETY: our own code computes every index from sizes that it uploads itself: hierarchy and triangles from the same
        // geometry, slots below the number of materials, pixels inside the image. The loops end: paths are bounded by their
        // bounces and the traversal by its stack. Ray queries start with finite numbers, run until they are done, and are
        // then read.
        PATH_TRACE => unsafe {
            device.create_shader_module_trusted(descriptor, wgpu::ShaderRuntimeChecks::unchecked())
        },
        _ => device.create_shader_module(descriptor),
    })
}

pub const fn texture(
    sample_type: wgpu::TextureSampleType,
    view_dimension: wgpu::TextureViewDimension,
) -> wgpu::BindingType {
    wgpu::BindingType::Texture {
        sample_type,
        view_dimension,
        multisampled: false,
    }
}

/// A group of bindings of these kinds.
pub fn layout(
    gpu: &GpuDevice,
    name: &str,
    bindings: impl IntoIterator<Item = (u32, wgpu::BindingType)>,
) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = bindings
        .into_iter()
        .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty,
            count: None,
        })
        .collect();
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(name),
        entries: &entries,
    })
}

pub fn pipeline_layout(gpu: &GpuDevice, name: &str, groups: [&wgpu::BindGroupLayout; 2]) -> wgpu::PipelineLayout {
    gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(name),
        bind_group_layouts: &groups.map(Some),
        immediate_size: 0,
    })
}

/// A compute pipeline of an entry point with constants, or the driver's objection to its shader.
pub fn pipeline(
    gpu: &GpuDevice,
    (module, layout): (&wgpu::ShaderModule, &wgpu::PipelineLayout),
    entry_point: &str,
    constants: &[(&str, f64)],
    cache: Option<&wgpu::PipelineCache>,
) -> Result<wgpu::ComputePipeline, GpuError> {
    gpu.reach(Moment::Compiling);
    gpu.checked(GpuError::Shader, |device| {
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

/// Resources bound to their places.
pub fn bind<'a>(
    gpu: &GpuDevice,
    layout: &wgpu::BindGroupLayout,
    resources: impl IntoIterator<Item = (u32, wgpu::BindingResource<'a>)>,
) -> wgpu::BindGroup {
    let entries: Vec<_> = resources
        .into_iter()
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout,
        entries: &entries,
    })
}

/// Submits one dispatch, timed if there is a timer.
pub fn dispatch(
    gpu: &GpuDevice,
    pipeline: &wgpu::ComputePipeline,
    groups: [&wgpu::BindGroup; 2],
    workgroups: u32,
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
            pass.set_bind_group(index, group, &[]);
        }
        pass.dispatch_workgroups(workgroups, 1, 1);
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
