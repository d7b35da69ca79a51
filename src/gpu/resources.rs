//! A job's resources on the GPU.

use std::sync::Arc;

use super::{
    device::{GpuDevice, GpuError, Moment},
    engine::PathTracer,
    geometry_arrays::GeometryArrays,
    layout::Globals,
    scene_group::{self, SceneForm, SceneGroup},
    sums::Sums,
};
use crate::{job::Job, scene::Geometry};

/// Buffers and textures of a job. Parts that a new job shares with the old one are kept.
#[derive(Debug)]
pub struct Resources {
    /// What these are of.
    pub job: Arc<Job>,
    scene: SceneGroup,
    /// Storage of the scene.
    pub form: SceneForm,
    /// Bind group of the scene.
    pub scene_group: wgpu::BindGroup,
    /// Sums since the last flush.
    pub sums: Sums,
}

impl Resources {
    /// Uploads a job, sharing unchanged parts with `old`. The sums may be the old ones, not cleared.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`], [`GpuError::Unfit`] and [`GpuError::Refused`] if the adapter cannot hold a part of it; `old`
    /// is unchanged then.
    pub fn new(gpu: &GpuDevice, pass: &PathTracer, job: Arc<Job>, old: Option<&Self>) -> Result<Self, GpuError> {
        gpu.reach(Moment::Uploading);
        gpu.checked(GpuError::Refused, |_| Self::made(gpu, pass, job, old))
            .flatten()
            .inspect_err(|_| {
                // It may have been overwritten by the new job's. The next work reports a device lost by now.
                if let Some(old) = old {
                    let _ = old.scene.geometry.write_around(gpu, &old.job.geometry);
                }
            })
    }

    fn made(gpu: &GpuDevice, pass: &PathTracer, job: Arc<Job>, old: Option<&Self>) -> Result<Self, GpuError> {
        let sums = match old.filter(|old| old.sums.fit(&job)) {
            Some(old) => old.sums.clone(),
            None => Sums::new(gpu, &pass.own_layout, &job)?,
        };
        let scene = scene(gpu, &job, old)?;
        let form = SceneForm {
            geometry: scene.geometry.form,
            ..SceneForm::of(gpu, &job)
        };
        let cells = [job.distribution().width, job.distribution().height];
        let globals = gpu.uniforms(&Globals::new(&job.settings, &job.geometry, cells));
        Ok(Self {
            scene_group: scene.bind(gpu, pass.scene_layout(form), &globals),
            form,
            job,
            scene,
            sums,
        })
    }
}

/// The job's scene, with unchanged parts of the old job's.
fn scene(gpu: &GpuDevice, job: &Job, old: Option<&Resources>) -> Result<SceneGroup, GpuError> {
    let kept = |is_kept: fn(&Job, &Job) -> bool| old.filter(|old| is_kept(&old.job, job)).map(|old| &old.scene);
    Ok(SceneGroup {
        materials: match kept(|a, b| Arc::ptr_eq(&a.materials, &b.materials)) {
            Some(old) => old.materials.clone(),
            None => scene_group::materials(gpu, &job.materials)?,
        },
        tables: match kept(|a, b| Arc::ptr_eq(&a.tables, &b.tables)) {
            Some(old) => old.tables.clone(),
            None => scene_group::tables(gpu, &job.tables)?,
        },
        environment: match kept(Job::has_distribution_of) {
            Some(old) => old.environment.clone(),
            None => scene_group::environment(gpu, &job.environment, job.distribution())?,
        },
        light_cells: match kept(|a, b| Arc::ptr_eq(&a.lights, &b.lights) && Arc::ptr_eq(&a.geometry, &b.geometry)) {
            Some(old) => old.light_cells.clone(),
            None => scene_group::light_cells(gpu, &job.geometry, &job.lights)?,
        },
        textures: match kept(|a, b| Arc::ptr_eq(&a.textures, &b.textures)) {
            Some(old) => old.textures.clone(),
            None => {
                // Another mapping of the same texture maps changes only their records.
                let old = kept(|a, b| Arc::ptr_eq(&a.textures.words, &b.textures.words));
                scene_group::textures(gpu, &job.textures, old.map(|old| old.textures[1].clone()))?
            }
        },
        // Last, because it may overwrite a part of `old`.
        geometry: match kept(|a, b| Arc::ptr_eq(&a.geometry, &b.geometry)) {
            Some(old) => old.geometry.clone(),
            None => geometry(
                gpu,
                &job.geometry,
                kept(|a, b| Arc::ptr_eq(&a.geometry.model, &b.geometry.model)),
            )?,
        },
    })
}

/// A geometry that is not there yet, though its model may be.
fn geometry(gpu: &GpuDevice, geometry: &Geometry, of_model: Option<&SceneGroup>) -> Result<GeometryArrays, GpuError> {
    let arrays = of_model.map(|old| &old.geometry);
    match arrays.filter(|arrays| arrays.has_room_for(gpu, geometry)) {
        Some(arrays) => arrays.with_around(gpu, geometry),
        None => GeometryArrays::new(gpu, geometry),
    }
}
