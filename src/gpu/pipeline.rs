//! Pipelines specialised for plans.

use std::collections::HashMap;

use super::compute::{self, READ, UNIFORMS, WRITE, buffer_entry};
use super::device::{GpuDevice, GpuError};
use super::kernel_cache::KernelCache;
use super::shader;
use crate::job::plan::{Plan, Specialisation};

/// A pass over the picture: its shader, its binding layout, and a pipeline for each plan met.
#[derive(Debug)]
pub struct Pipelines {
    module: wgpu::ShaderModule,
    layout: wgpu::PipelineLayout,
    /// Bindings of `shaders/scene/layout.wgsl`.
    pub bindings: wgpu::BindGroupLayout,
    /// The pass, and its entry point.
    name: &'static str,
    of_plan: HashMap<Specialisation, wgpu::ComputePipeline>,
    cache: Option<KernelCache>,
}

impl Pipelines {
    /// Links and compiles the path tracer.
    ///
    /// # Errors
    /// [`GpuError::Shader`] with the module and line.
    pub fn new(gpu: &GpuDevice) -> Result<Self, GpuError> {
        let bindings = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("scene"),
            entries: &binding_entries(),
        });
        Self::of_pass(gpu, "path_trace", bindings)
    }

    fn of_pass(gpu: &GpuDevice, name: &'static str, bindings: wgpu::BindGroupLayout) -> Result<Self, GpuError> {
        let linked = shader::link(&format!("pass/{name}")).map_err(GpuError::Shader)?;
        let descriptor = wgpu::ShaderModuleDescriptor {
            label: Some(name),
            source: wgpu::ShaderSource::Wgsl(linked.source.as_str().into()),
        };
        // SAFETY: every index is made by our own code from sizes that it uploads itself: hierarchy and triangles from
        // the same geometry, slots below the number of materials, pixels inside the picture. The loops end: paths are
        // bounded by their bounces and the traversal by its stack.
        let module = compute::validated(gpu, |device| unsafe {
            device.create_shader_module_trusted(descriptor, wgpu::ShaderRuntimeChecks::unchecked())
        })?;
        let layout = compute::pipeline_layout(gpu, name, &[Some(&bindings)]);
        Ok(Self {
            module,
            layout,
            bindings,
            name,
            of_plan: HashMap::new(),
            cache: KernelCache::open(gpu),
        })
    }

    /// Whether a pipeline of this kind has been compiled.
    pub fn has(&self, specialisation: &Specialisation) -> bool {
        self.of_plan.contains_key(specialisation)
    }

    /// The pipeline of a plan, compiled at its first use.
    ///
    /// # Errors
    /// [`GpuError::Shader`] where the driver refuses it.
    pub fn get(&mut self, gpu: &GpuDevice, plan: &Plan) -> Result<&wgpu::ComputePipeline, GpuError> {
        let specialisation = plan.specialisation();
        if !self.of_plan.contains_key(&specialisation) {
            let pipeline = compute::pipeline(
                gpu,
                &self.module,
                &self.layout,
                self.name,
                &plan.constants(),
                self.cache.as_ref().map(KernelCache::cache),
            )?;
            self.of_plan.insert(specialisation.clone(), pipeline);
            if let Some(cache) = &self.cache {
                cache.save();
            }
        }
        Ok(&self.of_plan[&specialisation])
    }
}

/// Uniforms, eleven read-only buffers, the environment's map, three buffers of sums.
fn binding_entries() -> Vec<wgpu::BindGroupLayoutEntry> {
    let environment_map = wgpu::BindGroupLayoutEntry {
        ty: wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
        ..buffer_entry(7, READ)
    };
    let entry = |binding: u32| match binding {
        0 => buffer_entry(binding, UNIFORMS),
        7 => environment_map,
        9 | 10 | 15 => buffer_entry(binding, WRITE),
        _ => buffer_entry(binding, READ),
    };
    (0..=15).map(entry).collect()
}
