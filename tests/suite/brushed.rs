//! Brushed surfaces: the way of an anisotropy's rotation, as a file means it, from either side.

use glossmith::{
    document::{AreaLight, Document, ImportLobe, of_model::materials_of},
    render::EngineChoice,
    scene::ModelSource,
};
use serde_json::json;

use super::renders::{adjust, document, render};
use super::{
    cli_support::Workplace,
    gltf_builder::{Buffer, SQUARE},
};

/// The file of a square in the xy plane of metal brushed at 45 degrees to the tangent, +X, with bitangents on one side of it.
fn brushed(folder: &Workplace, side: f32) -> ModelSource {
    let mut buffer = Buffer::default();
    let positions = buffer.floats(&SQUARE);
    let normals = buffer.floats(&[[0.0, 0.0, 1.0]; 4]);
    let tangents = buffer.floats(&[[1.0, 0.0, 0.0, side]; 4]);
    let indices = buffer.indices(&[0, 1, 2, 0, 2, 3]);
    let attributes = json!({"POSITION": positions, "NORMAL": normals, "TANGENT": tangents});
    let mut json = buffer.document(json!([{"attributes": attributes, "indices": indices, "material": 0}]));
    json["materials"] = json!([{
        "doubleSided": true,
        "pbrMetallicRoughness": {"metallicFactor": 1, "roughnessFactor": 0.4},
        "extensions": {"KHR_materials_anisotropy":
            {"anisotropyStrength": 0.8, "anisotropyRotation": std::f64::consts::FRAC_PI_4}},
    }]);
    folder.glb(&format!("brushed{side}.glb"), &json, &buffer)
}

/// The mean radiance of the square, seen along the z axis from in front of it (1) or behind it (−1), under a light 40 degrees
/// from that axis, above and to the side `x` of it.
fn shine(engine: EngineChoice, model: &ModelSource, front: f64, x: f64) -> f64 {
    let opened = glossmith::import::load(model).unwrap();
    let mut lit = Document {
        materials: materials_of(&opened, ImportLobe::Ggx),
        ..document(model.clone(), Default::default(), &[])
    };
    lit.ground = false;
    lit.lighting.strength = 0.0;
    let across = f64::to_radians(40.0).sin() * 0.5_f64.sqrt();
    lit.lighting.area_lights = vec![AreaLight {
        yaw_deg: (x * across).atan2(front * f64::to_radians(40.0).cos()).to_degrees(),
        pitch_deg: across.asin().to_degrees(),
        distance: 10.0,
        ..AreaLight::default()
    }];
    (lit.camera.yaw_deg, lit.camera.pitch_deg) = (if front > 0.0 { 0.0 } else { 180.0 }, 0.0);
    (lit.camera.distance, lit.camera.fov_deg) = (Some(20.0), 3.0);
    adjust(&mut lit, "render.width=16 render.height=16 render.samples=64");
    let film = render(engine, &lit);
    assert_eq!(film.dropped(), 0);
    film.luminance().iter().sum::<f64>() / 256.0
}

/// glTF measures the rotation from the tangent to the bitangent, which the tangent's w puts on one side or the other: the two
/// are mirror images. And a brushed sheet is brushed the same way on its back.
#[test]
fn the_rotation_is_towards_the_bitangent_on_both_faces() {
    let folder = Workplace::new();
    let [right, left] = [1.0, -1.0].map(|side| brushed(&folder, side));
    for engine in [EngineChoice::Cpu, EngineChoice::Gpu] {
        let along = shine(engine, &right, 1.0, 1.0);
        let across = shine(engine, &right, 1.0, -1.0);
        assert!(
            across.max(along) > 5.0 * across.min(along),
            "{engine:?}: {along} {across}"
        );
        for (name, model, front, x, expected) in [
            ("mirrored", &left, 1.0, -1.0, along),
            ("mirrored", &left, 1.0, 1.0, across),
            ("back", &right, -1.0, 1.0, along),
            ("back", &right, -1.0, -1.0, across),
            ("mirrored back", &left, -1.0, -1.0, along),
        ] {
            let found = shine(engine, model, front, x);
            println!("{engine:?} {name} at {x}: {found}, expected {expected}");
            near!(found / expected, 1.0, 0.05, "{engine:?} {name} at {x}");
        }
    }
}
