//! Pipelines specialised for plans.

use std::collections::HashMap;

use super::compute;
use super::device::{GpuDevice, GpuError};
use super::kernel_cache::KernelCache;
use super::scene_group::{self, geometry_constant};
use super::{shader, sums};
use crate::job::plan::{Plan, Specialisation};

/// What a pipeline is made for: a plan's constants, and whether the geometry is in textures.
pub type Kernel = (Specialisation, bool);

/// The path tracer: its shader, its binding layouts, and a pipeline for each kind of scene met.
#[derive(Debug)]
pub struct Pipelines {
    module: wgpu::ShaderModule,
    layout: wgpu::PipelineLayout,
    /// Of group 0.
    pub scene_layout: wgpu::BindGroupLayout,
    /// Of group 1.
    pub sums_layout: wgpu::BindGroupLayout,
    made: HashMap<Kernel, wgpu::ComputePipeline>,
    cache: Option<KernelCache>,
}

/// The pass, and its entry point.
const PASS: &str = "path_trace";

impl Pipelines {
    /// Links and compiles the path tracer.
    ///
    /// # Errors
    /// [`GpuError::Shader`] with the module and line.
    pub fn new(gpu: &GpuDevice) -> Result<Self, GpuError> {
        let linked = shader::link(&format!("pass/{PASS}")).map_err(GpuError::Shader)?;
        let descriptor = wgpu::ShaderModuleDescriptor {
            label: Some(PASS),
            source: wgpu::ShaderSource::Wgsl(linked.source.as_str().into()),
        };
        // SAFETY: every index is made by our own code from sizes that it uploads itself: hierarchy and triangles from
        // the same geometry, slots below the number of materials, pixels inside the picture. The loops end: paths are
        // bounded by their bounces and the traversal by its stack.
        let module = compute::validated(gpu, |device| unsafe {
            device.create_shader_module_trusted(descriptor, wgpu::ShaderRuntimeChecks::unchecked())
        })?;
        let (scene_layout, sums_layout) = (scene_group::layout(gpu), sums::layout(gpu));
        Ok(Self {
            module,
            layout: compute::pipeline_layout(gpu, PASS, &[Some(&scene_layout), Some(&sums_layout)]),
            scene_layout,
            sums_layout,
            made: HashMap::new(),
            cache: KernelCache::open(gpu),
        })
    }

    /// Whether a pipeline of this kind has been compiled.
    pub fn has(&self, kernel: &Kernel) -> bool {
        self.made.contains_key(kernel)
    }

    /// The pipeline of a plan, compiled at its first use.
    ///
    /// # Errors
    /// [`GpuError::Shader`] where the driver refuses it.
    pub fn get(
        &mut self,
        gpu: &GpuDevice,
        plan: &Plan,
        is_in_textures: bool,
    ) -> Result<&wgpu::ComputePipeline, GpuError> {
        let kernel = (plan.specialisation(), is_in_textures);
        if !self.made.contains_key(&kernel) {
            let mut constants = plan.constants();
            constants.push(geometry_constant(is_in_textures));
            let cache = self.cache.as_ref().map(KernelCache::cache);
            let pipeline = compute::pipeline(gpu, &self.module, &self.layout, PASS, &constants, cache)?;
            self.made.insert(kernel.clone(), pipeline);
            if let Some(cache) = &self.cache {
                cache.save();
            }
        }
        Ok(&self.made[&kernel])
    }
}
