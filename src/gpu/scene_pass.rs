//! A pass that reads a scene: group 0 is the scene, group 1 is the pass's own.

use super::compute;
use super::device::{GpuDevice, GpuError};
use super::scene_group;
use super::traversal::Traversal;

/// A pass linked for rays that go one way, of which pipelines are made.
#[derive(Debug)]
pub struct ScenePass {
    module: wgpu::ShaderModule,
    layout: wgpu::PipelineLayout,
    /// Layout of group 0.
    pub scene_layout: wgpu::BindGroupLayout,
}

impl ScenePass {
    /// Around a pass's module.
    pub fn new(
        gpu: &GpuDevice,
        name: &str,
        (module, traversal): (wgpu::ShaderModule, Traversal),
        own_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let scene_layout = scene_group::layout(gpu, traversal);
        Self {
            module,
            layout: compute::pipeline_layout(gpu, name, &[Some(&scene_layout), Some(own_layout)]),
            scene_layout,
        }
    }

    /// A pipeline of an entry point with constants.
    pub fn pipeline(
        &self,
        gpu: &GpuDevice,
        entry_point: &str,
        constants: &[(&str, f64)],
        cache: Option<&wgpu::PipelineCache>,
    ) -> Result<wgpu::ComputePipeline, GpuError> {
        compute::pipeline(gpu, &self.module, &self.layout, entry_point, constants, cache)
    }
}
