//! Pipelines specialised for plans.

use std::collections::HashMap;

use super::compute;
use super::device::{GpuDevice, GpuError};
use super::geometry_arrays::Form;
use super::kernel_cache::KernelCache;
use super::scene_group::SceneForm;
use super::scene_pass::ScenePass;
use super::traversal::Traversal;
use super::{shader, sums};
use crate::job::plan::{Plan, Specialisation};

/// Key of a pipeline: the plan's constants and the scene's storage.
pub type Kernel = (Specialisation, SceneForm);

/// The path tracer: its shader for each traversal, its binding layouts, and its pipelines.
#[derive(Debug)]
pub struct Pipelines {
    passes: HashMap<Traversal, ScenePass>,
    /// Layout of group 1.
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
        let mut pipelines = Self {
            passes: HashMap::new(),
            sums_layout: sums::layout(gpu),
            made: HashMap::new(),
            cache: KernelCache::open(gpu),
        };
        pipelines.link(gpu, gpu.traversal)?;
        Ok(pipelines)
    }

    /// Links and compiles the path tracer for rays that go this way, unless that was done.
    ///
    /// # Errors
    /// [`GpuError::Shader`] with the module and line.
    pub fn link(&mut self, gpu: &GpuDevice, traversal: Traversal) -> Result<(), GpuError> {
        if self.passes.contains_key(&traversal) {
            return Ok(());
        }
        let linked = shader::link_for(&format!("pass/{PASS}"), traversal).map_err(GpuError::Shader)?;
        let descriptor = wgpu::ShaderModuleDescriptor {
            label: Some(PASS),
            source: wgpu::ShaderSource::Wgsl(linked.source.as_str().into()),
        };
        // SAFETY: our own code computes every index from sizes that it uploads itself: hierarchy and triangles from the same
        // geometry, slots below the number of materials, pixels inside the image. The loops end: paths are bounded by their
        // bounces and the traversal by its stack. Ray queries start with finite numbers, run until they are done, and are
        // then read.
        let module = compute::validated(gpu, |device| unsafe {
            device.create_shader_module_trusted(descriptor, wgpu::ShaderRuntimeChecks::unchecked())
        })?;
        let pass = ScenePass::new(gpu, PASS, (module, traversal), &self.sums_layout);
        self.passes.insert(traversal, pass);
        Ok(())
    }

    /// The layout of group 0 for a geometry of this form, for which the path tracer must have been linked.
    pub fn scene_layout(&self, form: Form) -> &wgpu::BindGroupLayout {
        &self.passes[&form.traversal()].scene_layout
    }

    /// Whether a pipeline of this kind has been compiled.
    pub fn has(&self, kernel: &Kernel) -> bool {
        self.made.contains_key(kernel)
    }

    /// The pipeline of a plan, compiled on first use.
    pub fn get(&mut self, gpu: &GpuDevice, plan: &Plan, form: SceneForm) -> Result<&wgpu::ComputePipeline, GpuError> {
        let kernel = (plan.specialisation(), form);
        if !self.made.contains_key(&kernel) {
            let mut constants = plan.constants();
            constants.extend(form.constants());
            let cache = self.cache.as_ref().map(KernelCache::cache);
            let pipeline = self.passes[&form.geometry.traversal()].pipeline(gpu, PASS, &constants, cache)?;
            self.made.insert(kernel.clone(), pipeline);
            if let Some(cache) = &self.cache {
                cache.save();
            }
        }
        Ok(&self.made[&kernel])
    }
}
