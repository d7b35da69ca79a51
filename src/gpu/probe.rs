//! Single functions asked about inputs of one's own, answered by the shader (`shaders/pass/probe.wgsl`).

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use bytemuck::{Pod, Zeroable};
use wgpu::util::DeviceExt;

use super::device::{GpuDevice, GpuError};
use super::layout::{self, Globals};
use super::shader;
use crate::analysis::probe::ProbeScene;

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
        let linked = shader::link("pass/probe").map_err(GpuError::Shader)?;
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("probe"),
            source: wgpu::ShaderSource::Wgsl(linked.source.as_str().into()),
        });
        if let Some(error) = pollster::block_on(scope.pop()) {
            return Err(GpuError::Shader(error.to_string()));
        }
        let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
        let scene = SCENE_BINDINGS.map(|binding| match binding {
            0 => entry(binding, wgpu::BufferBindingType::Uniform),
            _ => entry(binding, storage(true)),
        });
        let group = |entries: &[wgpu::BindGroupLayoutEntry]| {
            gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("probe"),
                entries,
            })
        };
        let groups = [
            group(&scene),
            group(&[entry(0, storage(true)), entry(1, storage(false))]),
        ];
        let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("probe"),
            bind_group_layouts: &groups.each_ref().map(Some),
            immediate_size: 0,
        });
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
            let own = self.bind(1, &[(0, &asked), (1, &answered)]);
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            {
                let mut pass = encoder.begin_compute_pass(&Default::default());
                pass.set_pipeline(&pipeline);
                pass.set_bind_group(0, &scene, &[]);
                pass.set_bind_group(1, &own, &[]);
                pass.dispatch_workgroups((batch.len() as u32).div_ceil(64), 1, 1);
            }
            gpu.queue.submit([encoder.finish()]);
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
        let scope = self.gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let descriptor = wgpu::ComputePipelineDescriptor {
            label: Some(entry_point),
            layout: Some(&self.layout),
            module: &self.module,
            entry_point: Some(entry_point),
            compilation_options: Default::default(),
            cache: None,
        };
        let pipeline = self.gpu.device.create_compute_pipeline(&descriptor);
        match pollster::block_on(scope.pop()) {
            Some(error) => Err(GpuError::Shader(error.to_string())),
            None => {
                pipelines.insert(entry_point, pipeline.clone());
                Ok(pipeline)
            }
        }
    }

    fn scene(&self, scene: &ProbeScene<'_>) -> Result<wgpu::BindGroup, GpuError> {
        let gpu = &self.gpu;
        let (nodes, triangles) = match scene.geometry {
            Some(geometry) => (&geometry.bvh.nodes[..], layout::triangles(geometry)),
            None => (&[][..], Vec::new()),
        };
        let globals = Globals {
            node_count: nodes.len() as u32,
            ..Globals::zeroed()
        };
        let globals = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("globals"),
            contents: bytemuck::bytes_of(&globals),
            usage: wgpu::BufferUsages::UNIFORM,
        });
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
        Ok(self.bind(
            0,
            &[
                (0, &globals),
                (1, &nodes),
                (2, &triangles),
                (5, &materials),
                (6, &tables),
            ],
        ))
    }

    fn bind(&self, group: usize, buffers: &[(u32, &wgpu::Buffer)]) -> wgpu::BindGroup {
        let entries: Vec<_> = buffers
            .iter()
            .map(|(binding, buffer)| wgpu::BindGroupEntry {
                binding: *binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        self.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("probe"),
            layout: &self.groups[group],
            entries: &entries,
        })
    }
}

fn entry(binding: u32, ty: wgpu::BufferBindingType) -> wgpu::BindGroupLayoutEntry {
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
