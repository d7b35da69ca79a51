//! Single functions asked about inputs of one's own, answered by the shader (`shaders/pass/probe.wgsl`).

use std::collections::HashMap;
use std::sync::Mutex;

use bytemuck::{Pod, Zeroable};

use super::compute::{self, READ, WRITE};
use super::device::{GpuDevice, GpuError};
use super::geometry_arrays::GeometryArrays;
use super::layout::{self, Globals};
use super::material_array::MaterialArray;
use super::scene_group::{self, SceneForm, SceneGroup};
use super::scene_pass::ScenePass;
use super::traversal::Traversal;
use crate::job::probe::ProbeScene;
use crate::panics::lock;

/// Questions a dispatch: within the limit of 65 535 workgroups of 64.
const BATCH: usize = 1 << 20;

/// The shader that answers, compiled a kind of question at a time.
#[derive(Debug)]
pub struct Probe {
    gpu: GpuDevice,
    /// Passes by traversal: the device's own, and the fallback.
    passes: HashMap<Traversal, ScenePass>,
    own_layout: wgpu::BindGroupLayout,
    pipelines: Mutex<HashMap<(&'static str, SceneForm), wgpu::ComputePipeline>>,
}

impl Probe {
    /// Links the shader.
    pub fn new(gpu: GpuDevice) -> Result<Self, GpuError> {
        let own_layout = compute::group_layout(&gpu, "probe", &[(0, READ), (1, WRITE)]);
        let mut passes = HashMap::new();
        for &traversal in Traversal::ALL {
            if traversal == Traversal::Own || traversal == gpu.traversal {
                let module = compute::module(&gpu, "probe", traversal)?;
                passes.insert(
                    traversal,
                    ScenePass::new(&gpu, "probe", (module, traversal), &own_layout),
                );
            }
        }
        Ok(Self {
            gpu,
            passes,
            own_layout,
            pipelines: Mutex::default(),
        })
    }

    /// The answers of an entry point, one per question.
    pub fn ask<Q: Pod, A: Pod>(
        &self,
        entry_point: &'static str,
        scene: &ProbeScene<'_>,
        questions: &[Q],
    ) -> Result<Vec<A>, GpuError> {
        let gpu = &self.gpu;
        let (scene, form) = self.scene(scene)?;
        let pipeline = self.pipeline(entry_point, form)?;
        let mut answers = Vec::with_capacity(questions.len());
        for batch in questions.chunks(BATCH) {
            // A buffer of exact size, because the shader takes the number of questions from it.
            let asked = gpu.filled("questions", wgpu::BufferUsages::STORAGE, bytemuck::cast_slice(batch));
            let answered = gpu.empty_storage("the answers", (batch.len() * size_of::<A>()) as u64)?;
            let own = compute::bind_group(gpu, &self.own_layout, &[(0, &asked), (1, &answered)], &[]);
            let workgroups = [(batch.len() as u32).div_ceil(64), 1];
            compute::dispatch(gpu, &pipeline, &[&scene, &own], workgroups, None);
            answers.extend(gpu.read::<A>(&answered, batch.len())?);
        }
        Ok(answers)
    }

    /// The pipeline of an entry point, compiled at its first use.
    fn pipeline(&self, entry_point: &'static str, form: SceneForm) -> Result<wgpu::ComputePipeline, GpuError> {
        let mut pipelines = lock(&self.pipelines);
        if let Some(pipeline) = pipelines.get(&(entry_point, form)) {
            return Ok(pipeline.clone());
        }
        let pass = &self.passes[&form.geometry.traversal()];
        let pipeline = pass.pipeline(&self.gpu, entry_point, &form.constants(), None)?;
        pipelines.insert((entry_point, form), pipeline.clone());
        Ok(pipeline)
    }

    /// The scene bound, and how it is found.
    fn scene(&self, scene: &ProbeScene<'_>) -> Result<(wgpu::BindGroup, SceneForm), GpuError> {
        let gpu = &self.gpu;
        let mut group = SceneGroup {
            materials: MaterialArray::new(gpu, scene.materials)?,
            tables: scene_group::tables(gpu, scene.tables)?,
            ..SceneGroup::empty(gpu)?
        };
        if let Some(geometry) = scene.geometry {
            group.geometry = GeometryArrays::new(gpu, geometry)?;
        }
        let [node_count, around_root, around_triangle] = scene.geometry.map_or([0; 3], layout::hierarchies);
        let globals = gpu.uniforms(&Globals {
            node_count,
            around_root,
            around_triangle,
            ..Globals::zeroed()
        });
        let form = group.form();
        let layout = &self.passes[&form.geometry.traversal()].scene_layout;
        Ok((group.bind(gpu, layout, &globals), form))
    }
}
