//! A pass that reads a scene: group 0 is the scene, group 1 the pass's own. Its pipelines are specialised.

use std::{collections::HashMap, hash::Hash};

use super::{
    compute,
    device::{GpuDevice, GpuError},
    kernel_cache::KernelCache,
    scene_group,
    scene_group::SceneForm,
    traversal::Traversal,
};

/// The shader of a pass for each traversal that was linked, its binding layouts, and its pipelines by what they are made for.
#[derive(Debug)]
pub struct ScenePass<K> {
    name: &'static str,
    linked: HashMap<Traversal, Linked>,
    /// Layout of group 1.
    pub own_layout: wgpu::BindGroupLayout,
    made: HashMap<K, wgpu::ComputePipeline>,
    cache: Option<KernelCache>,
}

#[derive(Debug)]
struct Linked {
    module: wgpu::ShaderModule,
    layout: wgpu::PipelineLayout,
    /// Layout of group 0.
    scene_layout: wgpu::BindGroupLayout,
}

impl<K: Eq + Hash> ScenePass<K> {
    /// The pass of `shaders/pass/NAME.wgsl`.
    pub fn new(name: &'static str, own_layout: wgpu::BindGroupLayout, cache: Option<KernelCache>) -> Self {
        Self {
            name,
            linked: HashMap::new(),
            own_layout,
            made: HashMap::new(),
            cache,
        }
    }

    /// Links and compiles the pass for rays that go this way, unless that was done.
    ///
    /// # Errors
    /// [`GpuError::Shader`] with the module and line.
    pub fn link(&mut self, gpu: &GpuDevice, traversal: Traversal) -> Result<(), GpuError> {
        if self.linked.contains_key(&traversal) {
            return Ok(());
        }
        let module = compute::module(gpu, self.name, traversal)?;
        let scene_layout = scene_group::layout(gpu, traversal);
        let linked = Linked {
            module,
            layout: compute::pipeline_layout(gpu, self.name, [&scene_layout, &self.own_layout]),
            scene_layout,
        };
        self.linked.insert(traversal, linked);
        Ok(())
    }

    /// The layout of group 0 for a scene of this form, for which the pass must have been linked.
    pub fn scene_layout(&self, form: SceneForm) -> &wgpu::BindGroupLayout {
        &self.linked[&form.geometry.traversal()].scene_layout
    }

    /// Whether the pipeline for this has been compiled.
    pub fn has(&self, key: &K) -> bool {
        self.made.contains_key(key)
    }

    /// The pipeline of an entry point for a scene of this form, compiled on first use.
    pub fn get(
        &mut self,
        gpu: &GpuDevice,
        key: K,
        entry_point: &str,
        form: SceneForm,
        mut constants: Vec<(&'static str, f64)>,
    ) -> Result<wgpu::ComputePipeline, GpuError> {
        if let Some(made) = self.made.get(&key) {
            return Ok(made.clone());
        }
        constants.extend(form.constants());
        let Linked { module, layout, .. } = &self.linked[&form.geometry.traversal()];
        let cache = self.cache.as_ref().map(|kept| &kept.cache);
        let pipeline = compute::pipeline(gpu, (module, layout), entry_point, &constants, cache)?;
        self.made.insert(key, pipeline.clone());
        if let Some(cache) = &self.cache {
            cache.save();
        }
        Ok(pipeline)
    }
}
