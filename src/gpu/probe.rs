//! Single functions asked about inputs of one's own, answered by the shader (`shaders/pass/probe.wgsl`).

use std::{hash::Hash, sync::Mutex};

use bytemuck::{Pod, Zeroable};

use super::{
    compute::{self, READ, WRITE},
    device::{GpuDevice, GpuError},
    geometry_arrays::GeometryArrays,
    layout,
    layout::Globals,
    pipeline::ScenePass,
    scene_group::{self, SceneForm, SceneGroup},
    traversal::Traversal,
};
use crate::{job::probe::ProbeScene, panics::lock};

/// Questions a dispatch: within the limit of 65 535 workgroups of 64.
const BATCH: usize = 1 << 20;

/// The shader that answers, compiled a kind of question at a time.
#[derive(Debug)]
pub struct Probe {
    gpu: GpuDevice,
    pass: Mutex<ScenePass<(&'static str, SceneForm)>>,
}

impl Probe {
    /// Links the shader.
    pub fn new(gpu: GpuDevice) -> Result<Self, GpuError> {
        let own_layout = compute::layout(&gpu, "probe", [(0, READ), (1, WRITE)]);
        let mut pass = ScenePass::new("probe", own_layout, None);
        // The device's own, and the fallback.
        pass.link(&gpu, gpu.traversal)?;
        pass.link(&gpu, Traversal::Own)?;
        Ok(Self {
            gpu,
            pass: Mutex::new(pass),
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
        let mut pass = lock(&self.pass);
        let (scene, form) = bound(gpu, &pass, scene)?;
        let pipeline = pass.get(gpu, (entry_point, form), entry_point, form, Vec::new())?;
        let mut answers = Vec::with_capacity(questions.len());
        for batch in questions.chunks(BATCH) {
            // A buffer of exact size, because the shader takes the number of questions from it.
            let asked = gpu.filled("questions", wgpu::BufferUsages::STORAGE, bytemuck::cast_slice(batch));
            let answered = gpu.empty_storage("the answers", (batch.len() * size_of::<A>()) as u64)?;
            let buffers = [&asked, &answered].map(wgpu::Buffer::as_entire_binding);
            let own = compute::bind(gpu, &pass.own_layout, (0..).zip(buffers));
            compute::dispatch(gpu, &pipeline, [&scene, &own], (batch.len() as u32).div_ceil(64), None);
            answers.extend(gpu.read::<A>(&answered, 0..batch.len())?);
        }
        Ok(answers)
    }
}

/// The scene bound, and how it is found.
fn bound<K: Eq + Hash>(
    gpu: &GpuDevice,
    pass: &ScenePass<K>,
    scene: &ProbeScene<'_>,
) -> Result<(wgpu::BindGroup, SceneForm), GpuError> {
    let mut group = SceneGroup {
        materials: scene_group::materials(gpu, scene.materials)?,
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
    let form = SceneForm {
        geometry: group.geometry.form,
        has_many_materials: scene_group::are_many(scene.materials),
    };
    Ok((group.bind(gpu, pass.scene_layout(form), &globals), form))
}
