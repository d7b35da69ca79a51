//! Single functions asked about inputs of one's own, answered by the shader (`shaders/pass/probe.wgsl`).

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use bytemuck::{Pod, Zeroable};
use wgpu::util::DeviceExt;

use super::compute::{self, READ, UNIFORMS, WRITE};
use super::device::{GpuDevice, GpuError};
use super::layout::{self, Globals};
use crate::job::probe::ProbeScene;

/// Questions a dispatch: within the limit of 65 535 workgroups of 64.
const BATCH: usize = 1 << 20;

/// The bindings of `shaders/scene/layout.wgsl` that answers are read from.
const SCENE_BINDINGS: [u32; 5] = [0, 1, 2, 5, 6];

/// The shader that answers, compiled a kind of question at a time.
#[derive(Debug)]
pub struct Probe {
    gpu: GpuDevice,
    module: wgpu::ShaderModule,
    groups: [wgpu::BindGroupLayout; 2],
    layout: wgpu::PipelineLayout,
    pipelines: Mutex<HashMap<&'static str, wgpu::ComputePipeline>>,
}

impl Probe {
    /// Links the shader.
    ///
    /// # Errors
    /// [`GpuError::Shader`] where the driver refuses it.
    pub fn new(gpu: GpuDevice) -> Result<Self, GpuError> {
        let module = compute::module(&gpu, "probe")?;
        let scene = SCENE_BINDINGS.map(|binding| (binding, if binding == 0 { UNIFORMS } else { READ }));
        let groups = [
            compute::group_layout(&gpu, "probe", &scene),
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
        let pipeline = self.pipeline(entry_point)?;
        let scene = self.scene(scene)?;
        let mut answers = Vec::with_capacity(questions.len());
        for batch in questions.chunks(BATCH) {
            // Nothing past the questions may be taken for one: a buffer of their very size.
            let asked = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("questions"),
                contents: bytemuck::cast_slice(batch),
                usage: wgpu::BufferUsages::STORAGE,
            });
            let answered = gpu.empty_storage("the answers", (batch.len() * size_of::<A>()) as u64)?;
            let own = compute::bind_group(gpu, &self.groups[1], &[(0, &asked), (1, &answered)]);
            let workgroups = [(batch.len() as u32).div_ceil(64), 1];
            compute::dispatch(gpu, &pipeline, &[&scene, &own], workgroups, None);
            answers.extend(gpu.read::<A>(&answered, batch.len())?);
        }
        Ok(answers)
    }

    /// The pipeline of an entry point, compiled at its first use.
    fn pipeline(&self, entry_point: &'static str) -> Result<wgpu::ComputePipeline, GpuError> {
        let mut pipelines = self.pipelines.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(pipeline) = pipelines.get(entry_point) {
            return Ok(pipeline.clone());
        }
        let pipeline = compute::pipeline(&self.gpu, &self.module, &self.layout, entry_point, &[], None)?;
        pipelines.insert(entry_point, pipeline.clone());
        Ok(pipeline)
    }

    fn scene(&self, scene: &ProbeScene<'_>) -> Result<wgpu::BindGroup, GpuError> {
        let gpu = &self.gpu;
        let (nodes, triangles) = match scene.geometry {
            Some(geometry) => (&geometry.compressed().nodes[..], layout::triangles(geometry)),
            None => (&[][..], Vec::new()),
        };
        let globals = Globals {
            node_count: nodes.len() as u32,
            ..Globals::zeroed()
        };
        let globals = gpu.uniforms(&globals);
        // A buffer is at least as large as one element of what the shader takes it for.
        let filler = [0u8; 256];
        let nodes = gpu.storage("the hierarchy of boxes", bytemuck::cast_slice(nodes))?;
        let triangles = gpu.storage("the triangles", bytemuck::cast_slice(&triangles))?;
        let materials: &[u8] = match scene.materials {
            [] => &filler,
            materials => bytemuck::cast_slice(materials),
        };
        let materials = gpu.storage("the materials", materials)?;
        let tables = gpu.storage("the materials' tables", bytemuck::cast_slice(scene.tables))?;
        Ok(compute::bind_group(
            gpu,
            &self.groups[0],
            &[
                (0, &globals),
                (1, &nodes),
                (2, &triangles),
                (5, &materials),
                (6, &tables),
            ],
        ))
    }
}
