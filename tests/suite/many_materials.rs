//! Scenes with more materials than an adapter's uniforms hold.

use std::{sync::Arc, time::Duration};

use glossmith::{
    document::Document,
    gpu::{AdapterKind, GpuDevice, GpuEngine, scene_group::FEW_MATERIALS},
    job::Job,
    optics::{material::Material, vector::Vec3},
    render::{EngineChoice, Session},
};

use super::{plan::job_in, random_documents::apart, renders::adjust};

/// The job with its one material in the last of so many slots; all others shine.
fn in_the_last_of(slots: usize, job: &Job) -> Job {
    let shining = Material {
        emission: Vec3::splat(9.0),
        ..job.materials[0]
    };
    let mut materials = vec![shining; slots];
    materials[slots - 1] = job.materials[0];
    let mut geometry = (*job.geometry).clone();
    let mut model = (*geometry.model).clone();
    model.slots.fill(slots as u32 - 1);
    geometry.model = Arc::new(model);
    Job {
        geometry: Arc::new(geometry),
        materials: Arc::new(materials),
        ..job.clone()
    }
}

/// One engine, whose kernels are for few materials and for many in turn.
#[test]
fn many_materials_look_as_few_do() {
    let mut document = Document::default();
    adjust(&mut document, "render.width=64 render.height=48");
    let mut session = Session::open(EngineChoice::Cpu).expect("the processor");
    let job = job_in(&mut session, &document);
    let device = GpuDevice::open(AdapterKind::Any).expect("an adapter: install mesa-vulkan-drivers");
    let mut engine = GpuEngine::new(device).expect("the shader compiles");
    let mut luminance = |job: Job| {
        engine.submit(Arc::new(job)).expect("the adapter holds it");
        engine.step(Duration::from_secs(1000), 4).expect("nothing fails");
        engine.film().expect("nothing fails").luminance()
    };
    let one = luminance(job.clone());
    assert!(one.iter().any(|&y| y > 0.0), "the teapot is lit");
    for slots in [2, FEW_MATERIALS, FEW_MATERIALS + 1, 5 * FEW_MATERIALS, 3] {
        let [off, whole] = apart(&luminance(in_the_last_of(slots, &job)), &one);
        assert!(
            off < 0.001 && whole < 0.0001,
            "{slots} slots: {off} of the pixels, the whole by {whole}"
        );
    }
}
