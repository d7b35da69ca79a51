//! A person's session, from the files given at the start to what a crash left.

use glossmith::{
    document::{CameraSettings, MaterialSettings},
    optics::curve::Curve,
    scene::{ModelSource, environment::EnvironmentSource},
    store::{load_document, load_material, picture::load_picture_document},
};
use serde_json::json;

use super::{cli_support::write_hdr, desktop::Desktop, gltf_builder::glb, gltf_builder::square};

#[test]
fn a_session_is_played_killed_and_recovered() {
    let desktop = Desktop::new();
    let [model, light] = ["tile.glb", "light.hdr"].map(|name| desktop.path(name));
    let (buffer, mut document) = square();
    // Above 0.7 the import takes GGX, which has no curve.
    document["materials"] = json!([{"pbrMetallicRoughness": {"roughnessFactor": 0.5}}]);
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    std::fs::write(&model, glb(&document, &buffer.bytes)).expect("a temporary file");
    write_hdr(&light, 16, 8, |x, y| [0.2 + x as f32, 0.5, 0.1 + y as f32]);

    let mut window = desktop.start(&[&model, &light], "first.log");
    for file in [&model, &light] {
        let words = format!("opened {}", file.display());
        window.wait("the files", |window| window.said().contains(&words));
    }
    assert!(!window.title().contains('*'), "opening is no edit: {}", window.title());

    // Orbit with the mouse, the rest by the keyboard alone.
    window.drag_until_changed();
    window.choose("specular roughness", "the keys go to Specular roughness");
    window.write("0.62");
    window.keys("Return");
    window.choose("specular curve", "the keys go to Specular curve");
    window.keys("Down");
    let place = Curve::ALL
        .iter()
        .position(|curve| *curve == MaterialSettings::default().curve);
    let next = Curve::ALL[place.expect("one of them") + 1];

    let preset = desktop.path("preset.json");
    window.choose("save material", "a path is asked for");
    window.name_file(&preset);
    let material = load_material(&preset).expect("a material").value;
    assert_eq!((material.roughness, material.curve), (0.62, next));

    let picture = desktop.path("picture.png");
    window.until_said("a path is asked for", |window| window.keys("ctrl+e"));
    window.name_file(&picture);
    let seen = load_picture_document(&picture).expect("the document inside").value;
    assert_eq!(seen.materials, [material]);
    assert_eq!(seen.model, ModelSource::File(model));
    assert_eq!(seen.lighting.environment, EnvironmentSource::File(light));
    let before = CameraSettings::default();
    assert!(seen.camera.yaw_deg != before.yaw_deg && seen.camera.pitch_deg != before.pitch_deg);
    assert_eq!(image::open(&picture).expect("a picture").width(), seen.render.width);

    // An edit that was never saved, and the power goes.
    window.choose("specular roughness", "the keys go to Specular roughness");
    window.write("0.35");
    window.keys("Return");
    window.wait("the copy of what is unsaved", |_| {
        let documents = desktop.save_for_recovery();
        documents.iter().any(|document| document.materials[0].roughness == 0.35)
    });
    window.kill();
    let mut kept = desktop.save_for_recovery();
    let lost = kept.pop().expect("the kill left a copy");
    assert!(kept.is_empty(), "one window, one copy");
    assert_eq!(lost.camera, seen.camera);

    let mut window = desktop.start(&[], "second.log");
    window.wait("the offer", |window| {
        window.said().contains("unsaved documents found: 1")
    });
    // The first button has the focus as soon as the sheet is laid out.
    window.wait("the document to come back", |window| {
        window.keys("Return");
        window.said().contains("restored untitled")
    });
    let project = desktop.path("project.json");
    window.until_said("a path is asked for", |window| window.keys("ctrl+s"));
    window.name_file(&project);
    assert_eq!(load_document(&project).expect("a project").value, lost);
    window.wait("the project in the title", |window| {
        window.title().contains("project – Glossmith")
    });
    window.keys("ctrl+q");
    let (status, said) = window.ended();
    assert!(status.success(), "{status}\n{said}");
    assert!(!said.contains("ERROR"), "{said}");
    assert_eq!(
        desktop.save_for_recovery(),
        [],
        "closed as it should be, it leaves nothing"
    );
}
