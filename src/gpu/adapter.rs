//! Adapters: selection, requirements, requested limits.

use pollster::block_on;

use super::{
    array::TEXEL_ROW,
    device::{GpuDevice, GpuError, driver, is_software},
    traversal::Traversal,
};

/// Kinds of adapters to consider.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AdapterKind {
    /// The fastest: hardware before software.
    Any,
    /// Only real GPUs.
    Hardware,
    /// Only software Vulkan, on the CPU.
    Software,
}

impl AdapterKind {
    /// The kind of an adapter.
    pub fn of(is_software: bool) -> Self {
        if is_software { Self::Software } else { Self::Hardware }
    }
}

/// Limits that every pass needs, each within WebGPU's guaranteed ones: the path tracer's six storage buffers, three uniforms
/// and eleven textures, textures of 4096 texels per row, workgroups of 64.
fn limits_needed() -> wgpu::Limits {
    wgpu::Limits {
        max_texture_dimension_2d: TEXEL_ROW as u32,
        max_sampled_textures_per_shader_stage: 11,
        max_storage_buffers_per_shader_stage: 6,
        max_uniform_buffers_per_shader_stage: 3,
        max_uniform_buffer_binding_size: 64 << 10,
        max_storage_buffer_binding_size: 128 << 20,
        max_buffer_size: 128 << 20,
        max_compute_invocations_per_workgroup: 64,
        max_compute_workgroup_size_x: 64,
        max_compute_workgroup_size_y: 8,
        max_compute_workgroup_size_z: 1,
        max_compute_workgroups_per_dimension: 65_535,
        // Nothing else is used: the lowest limits.
        ..wgpu::Limits::downlevel_webgl2_defaults()
    }
}

/// Names of an adapter's insufficient limits; `None` if it has none.
fn lacking(adapter: &wgpu::Limits) -> Option<String> {
    let mut lacking = Vec::new();
    limits_needed().check_limits_with_fail_fn(adapter, false, |name, needed, allowed| {
        lacking.push(format!("its {name} is {allowed}, {needed} is needed"));
    });
    (!lacking.is_empty()).then(|| lacking.join("; "))
}

/// Limits to request: those needed, and for large models and texture maps as much as the adapter has.
fn limits_asked(adapter: &wgpu::Limits) -> wgpu::Limits {
    wgpu::Limits {
        max_texture_dimension_2d: adapter.max_texture_dimension_2d,
        max_texture_array_layers: adapter.max_texture_array_layers,
        max_buffer_size: adapter.max_buffer_size,
        max_storage_buffer_binding_size: adapter.max_storage_buffer_binding_size,
        ..limits_needed()
    }
}

/// An adapter that has not been opened.
#[derive(Debug)]
pub struct GpuAdapter {
    adapter: wgpu::Adapter,
    /// Name, driver, kind.
    pub info: wgpu::AdapterInfo,
}

impl GpuAdapter {
    /// The best adapter of a kind.
    pub fn find(kind: AdapterKind) -> Result<Self, GpuError> {
        Self::of_kind(kind)
            .into_iter()
            .next()
            .ok_or(GpuError::NoAdapter(match kind {
                AdapterKind::Any => "",
                AdapterKind::Hardware => "hardware ",
                AdapterKind::Software => "software ",
            }))
    }

    /// All adapters of a kind, real GPUs first.
    pub fn of_kind(kind: AdapterKind) -> Vec<Self> {
        let wanted = |backends| {
            let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
            descriptor.backends &= backends;
            let instance = wgpu::Instance::new(descriptor);
            let found = block_on(instance.enumerate_adapters(backends))
                .into_iter()
                .map(|adapter| Self {
                    info: adapter.get_info(),
                    adapter,
                });
            let mut found: Vec<_> = found
                .filter(|adapter| [AdapterKind::Any, AdapterKind::of(adapter.is_software())].contains(&kind))
                .collect();
            found.sort_by_key(|adapter| rank(&adapter.info));
            found
        };
        // OpenGL only as a last resort: its driver takes memory and time, and prints errors if it is missing.
        let adapters = wanted(wgpu::Backends::PRIMARY);
        if adapters.is_empty() && kind != AdapterKind::Software {
            wanted(wgpu::Backends::GL)
        } else {
            adapters
        }
    }

    /// True for a software adapter, which runs on the CPU.
    pub fn is_software(&self) -> bool {
        is_software(&self.info)
    }

    /// Driver with its version.
    pub fn driver(&self) -> String {
        driver(&self.info)
    }

    /// Whether the adapter supports ray queries.
    pub fn has_ray_queries(&self) -> bool {
        self.adapter.features().contains(wgpu::Features::EXPERIMENTAL_RAY_QUERY)
    }

    /// Opens the adapter for a kind of traversal.
    pub fn open(&self, traversal: Traversal) -> Result<GpuDevice, GpuError> {
        let unfit = |reason: String| GpuError::Unfit {
            adapter: self.info.name.clone(),
            reason,
        };
        let limits = self.adapter.limits();
        if let Some(lacking) = lacking(&limits) {
            return Err(unfit(lacking));
        }
        let optional = wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::PIPELINE_CACHE;
        let mut descriptor = wgpu::DeviceDescriptor {
            label: Some("glossmith"),
            required_features: self.adapter.features() & optional,
            required_limits: limits_asked(&limits),
            ..Default::default()
        };
        if traversal == Traversal::RayQueries {
            descriptor.required_features |= wgpu::Features::EXPERIMENTAL_RAY_QUERY;
            descriptor.required_limits = descriptor.required_limits.using_acceleration_structure_values(limits);
            // SAFETY: wgpu warns that experimental features may have bugs. Ray queries can be switched off, and our own
            // traversal is the fallback.
            descriptor.experimental_features = unsafe { wgpu::ExperimentalFeatures::enabled() };
        }
        let opened = block_on(self.adapter.request_device(&descriptor)).map_err(|error| unfit(error.to_string()))?;
        Ok(GpuDevice::new(opened, self.info.clone(), traversal))
    }
}

impl GpuDevice {
    /// Opens the best adapter of a kind without experimental features: rays use our own hierarchy.
    pub fn open(kind: AdapterKind) -> Result<Self, GpuError> {
        GpuAdapter::find(kind)?.open(Traversal::Own)
    }
}

/// Sorts adapters: real GPUs first.
fn rank(info: &wgpu::AdapterInfo) -> u8 {
    match info.device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}
