//! Smooth normals on coarse triangles: what calls for the round surface, and that it neither loses nor makes light.

use glossmith::{
    document::{AreaLight, Background, Document, MaterialSettings, effect::Switch},
    job::effect::EffectId,
    render::EngineChoice,
    scene::{ModelSource, environment::EnvironmentSource, mesh::Mesh, shapes},
};
use serde_json::json;

use super::{
    cli_support::Workplace,
    gltf_builder::Buffer,
    plan::job,
    random_documents::of_material,
    renders::{document, render},
};

/// The file of a mesh with its normals.
fn file(folder: &Workplace, name: &str, mesh: &Mesh) -> ModelSource {
    let mut buffer = Buffer::default();
    let primitive = buffer.mesh(mesh);
    let json = buffer.document(json!([primitive]));
    folder.glb(name, &json, &buffer)
}

/// A coarse ball of matt 0.8 in a studio.
pub fn coarse(folder: &Workplace) -> Document {
    Document {
        materials: vec![MaterialSettings::diffuse("ball", [0.8; 3])],
        model: file(folder, "coarse.glb", &shapes::sphere(12, 6)),
        ..Document::default()
    }
}

/// A ball of matt 0.8 in a furnace.
fn ball(model: ModelSource) -> Document {
    Document {
        materials: vec![MaterialSettings::diffuse("ball", [0.8; 3])],
        ..document(model, EnvironmentSource::Furnace, &[])
    }
}

#[test]
fn only_coarse_smooth_triangles_call_for_the_round_surface() {
    let folder = Workplace::new();
    let calls = |model: ModelSource| {
        let document = of_material(model, MaterialSettings::default());
        job(&document).plan.has(EffectId::ShadowTerminator)
    };
    for source in [
        ModelSource::Teapot,
        ModelSource::Sphere,
        ModelSource::Plane,
        ModelSource::Shaderball,
    ] {
        assert!(!calls(source.clone()), "{source}");
    }
    let mut flat = shapes::sphere(12, 6);
    assert!(calls(file(&folder, "smooth.glb", &flat)));
    flat.normals.iter_mut().for_each(|normal| *normal = Default::default());
    assert!(!calls(file(&folder, "flat.glb", &flat)));
    assert!(!calls(file(&folder, "fine.glb", &shapes::sphere(128, 64))));
    let mut off = of_material(
        file(&folder, "off.glb", &shapes::sphere(12, 6)),
        MaterialSettings::default(),
    );
    off.render.effects.set(EffectId::ShadowTerminator, Switch::Off);
    assert!(!job(&off).settings.rounds_surfaces);
}

/// Of light that comes evenly from everywhere a ball returns its albedo, coarse or not, alone or beside something else.
#[test]
fn the_round_surface_keeps_the_furnace() {
    let folder = Workplace::new();
    let model = file(&folder, "ball.glb", &shapes::sphere(12, 6));
    let mut alone = ball(model);
    let mut beside = alone.clone();
    // With a light that hardly shines and is in nothing's way rays are traced.
    beside.lighting.area_lights = vec![AreaLight {
        strength: 1e-6,
        distance: 40.0,
        width: 0.01,
        height: 0.01,
        ..AreaLight::default()
    }];
    for engine in [EngineChoice::Cpu, EngineChoice::Gpu] {
        for document in [&mut alone, &mut beside] {
            document.ground = false;
            document.lighting.background = Background::Transparent;
            let film = render(engine, document);
            let pixels = film.colors().filter(|color| color[3] == 1.0).map(|color| color[1]);
            let worst = pixels.map(|value| (value - 0.8).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-5, "{engine:?}: {worst}");
            assert_eq!(film.dropped(), 0);
        }
    }
}
