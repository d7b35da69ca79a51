//! Single functions asked about inputs of one's own, answered by the shader (`shaders/pass/probe.wgsl`).

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use bytemuck::{Pod, Zeroable};

use super::compute::{self, READ, WRITE};
use super::device::{GpuDevice, GpuError};
use super::geometry_arrays::GeometryArrays;
use super::layout::{self, Globals};
use super::scene_group::{self, SceneGroup, geometry_constant};
use crate::job::probe::ProbeScene;

/// Questions a dispatch: within the limit of 65 535 workgroups of 64.
const BATCH: usize = 1 << 20;

/// The shader that answers, compiled a kind of question at a time.
#[derive(Debug)]
pub struct Probe {
    gpu: GpuDevice,
    module: wgpu::ShaderModule,
    groups: [wgpu::BindGroupLayout; 2],
    layout: wgpu::PipelineLayout,
    pipelines: Mutex<HashMap<(&'static str, bool), wgpu::ComputePipeline>>,
}

impl Probe {
    /// Links the shader.
    ///
    /// # Errors
    /// [`GpuError::Shader`] where the driver refuses it.
    pub fn new(gpu: GpuDevice) -> Result<Self, GpuError> {
        let module = compute::module(&gpu, "probe")?;
        let groups = [
            scene_group::layout(&gpu),
            compute::group_layout(&gpu, "probe", &[(0, READ), (1, WRITE)]),
        ];
        let layout = compute::pipeline_layout(&gpu, "probe", &groups.each_ref().map(Some));
        Ok(Self {
            gpu,
            module,
            groups,
            layout,
            pipelines: Mutex::default(),
        })
    }

    /// The answers of an entry point, one for each question.
    ///
    /// # Errors
    /// If the device fails, or can't hold what is asked about.
    pub fn ask<Q: Pod, A: Pod>(
        &self,
        entry_point: &'static str,
        scene: &ProbeScene<'_>,
        questions: &[Q],
    ) -> Result<Vec<A>, GpuError> {
        let gpu = &self.gpu;
        let (scene, is_in_textures) = self.scene(scene)?;
        let pipeline = self.pipeline(entry_point, is_in_textures)?;
        let mut answers = Vec::with_capacity(questions.len());
        for batch in questions.chunks(BATCH) {
            // Nothing past the questions may be taken for one: a buffer of their very size.
            let asked = gpu.filled("questions", wgpu::BufferUsages::STORAGE, bytemuck::cast_slice(batch));
            let answered = gpu.empty_storage("the answers", (batch.len() * size_of::<A>()) as u64)?;
            let own = compute::bind_group(gpu, &self.groups[1], &[(0, &asked), (1, &answered)], &[]);
            let workgroups = [(batch.len() as u32).div_ceil(64), 1];
            compute::dispatch(gpu, &pipeline, &[&scene, &own], workgroups, None);
            answers.extend(gpu.read::<A>(&answered, batch.len())?);
        }
        Ok(answers)
    }

    /// The pipeline of an entry point, compiled at its first use.
    fn pipeline(&self, entry_point: &'static str, is_in_textures: bool) -> Result<wgpu::ComputePipeline, GpuError> {
        let mut pipelines = self.pipelines.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(pipeline) = pipelines.get(&(entry_point, is_in_textures)) {
            return Ok(pipeline.clone());
        }
        let constants = [geometry_constant(is_in_textures)];
        let pipeline = compute::pipeline(&self.gpu, &self.module, &self.layout, entry_point, &constants, None)?;
        pipelines.insert((entry_point, is_in_textures), pipeline.clone());
        Ok(pipeline)
    }

    /// The scene bound, and whether its geometry is in textures.
    fn scene(&self, scene: &ProbeScene<'_>) -> Result<(wgpu::BindGroup, bool), GpuError> {
        let gpu = &self.gpu;
        let mut group = SceneGroup {
            materials: scene_group::materials(gpu, scene.materials)?,
            tables: scene_group::tables(gpu, scene.tables)?,
            ..SceneGroup::empty(gpu)?
        };
        if let Some(geometry) = scene.geometry {
            group.geometry = GeometryArrays::new(gpu, geometry)?;
        }
        let [node_count, around_root] = scene.geometry.map_or([0; 2], layout::hierarchies);
        let globals = gpu.uniforms(&Globals {
            node_count,
            around_root,
            ..Globals::zeroed()
        });
        let bound = group.bind(gpu, &self.groups[0], &globals);
        Ok((bound, group.geometry.is_in_textures()))
    }
}
