//! Lights and ground apart from the model: moving one builds and uploads nothing of the model.

use std::sync::Arc;

use glossmith::document::{AreaLight, AreaLightShape, Document};
use glossmith::render::{EngineChoice, Session};

use super::{refused::is_alike, refused::render, worker::small_document};

fn submitted(session: &mut Session, document: &Document) {
    session.submit(document).expect("it is sound");
}

/// The same scene under other lights: one, the same elsewhere, as many as there may be, none, and none without the ground.
fn lit() -> Vec<Document> {
    let mut plain = small_document();
    plain.render.samples = 8;
    plain.ground = true;
    let with = |lights: &[AreaLight]| {
        let mut document = plain.clone();
        document.lighting.area_lights = lights.to_vec();
        document
    };
    let disc = |yaw_deg: f64| AreaLight {
        yaw_deg,
        shape: AreaLightShape::Disc,
        ..AreaLight::default()
    };
    let many: Vec<AreaLight> = (0..8).map(|i| disc(45.0 * f64::from(i))).collect();
    let mut floating = plain.clone();
    floating.ground = false;
    vec![
        with(&[disc(0.0)]),
        with(&[disc(90.0)]),
        with(&many),
        plain.clone(),
        floating,
        with(&[disc(0.0)]),
    ]
}

#[test]
fn all_light_falls_on_the_same_triangles() {
    let mut session = Session::open(EngineChoice::Cpu).expect("the processor");
    let geometries: Vec<_> = lit()
        .iter()
        .map(|document| {
            submitted(&mut session, document);
            session.job().expect("it was submitted").geometry.clone()
        })
        .collect();
    let model = &geometries[0].model;
    assert!(geometries.iter().all(|other| Arc::ptr_eq(&other.model, model)));
    let around: Vec<usize> = geometries.iter().map(|one| one.around.triangles.len()).collect();
    assert_eq!(around[0], around[1]);
    assert!(around[2] > around[0] && around[0] > around[3] && around[3] > 0);
    assert_eq!(around[4], 0);
    assert!(geometries[4].is_convex() && !geometries[3].is_convex());
}

/// Both where the model is in buffers, and where it is in textures; only scenes that have the same kernel.
#[test]
fn lights_move_on_the_gpu_as_if_they_had_been_there() {
    for binding_bytes in [u64::MAX, 100 << 10] {
        let open = || {
            let session = Session::open(EngineChoice::Gpu).expect("a Vulkan driver: apt install mesa-vulkan-drivers");
            session.device().expect("it is open").limit_buffers(binding_bytes);
            session
        };
        let (mut moved, mut fresh) = (open(), open());
        let lit = lit()
            .into_iter()
            .filter(|document| !document.lighting.area_lights.is_empty());
        for (index, document) in lit.enumerate() {
            fresh.reset();
            let [moved, fresh] = [&mut moved, &mut fresh].map(|session| {
                submitted(session, &document);
                render(session);
                session.image().expect("it is done")
            });
            assert!(
                is_alike(&moved, &fresh),
                "scene {index}, bindings of {binding_bytes} bytes"
            );
        }
    }
}
