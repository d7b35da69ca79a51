//! Files that are dropped on the window and pasted into it, opening that is called off, and files that other programs save.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable as _;
use glossmith::app::actions::Action;
use glossmith::render::worker::Activity;
use glossmith::scene::ModelSource;
use glossmith::scene::environment::EnvironmentSource;
use glossmith::scene::texture::TextureTarget;
use glossmith::store::{save_document, save_material};
use serde_json::json;

use super::cli_support::write_hdr;
use super::gltf_builder::{Folder, glb, png, square};
use super::ui::{Editor, editor, editor_with, picture, request, see, see_label, settle, undo, wait};
use super::worker::small_document;

#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }
    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

/// Drops files on the window as the system does: all in one frame.
pub(super) fn drop_on(harness: &mut Editor, paths: &[PathBuf]) {
    let files = paths
        .iter()
        .map(|path| Arc::new(Dropped(path.clone())) as egui::DroppedFileHandle);
    harness.input_mut().dropped_files = files.collect();
    harness.step();
    harness.step();
}

pub(super) fn says(harness: &Editor, part: &str) -> bool {
    harness.state().messages().iter().any(|text| text.contains(part))
}

pub(super) fn wait_for_words(harness: &mut Editor, part: &str) {
    wait(harness, part, |app| {
        app.messages().iter().any(|text| text.contains(part))
    });
}

fn write_square(path: &Path, material: &serde_json::Value) {
    let (buffer, mut document) = square();
    document["materials"] = json!([material]);
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    std::fs::write(path, glb(&document, &buffer.bytes)).unwrap();
}

fn write_png(path: &Path) {
    std::fs::write(path, png()).unwrap();
}

#[test]
fn every_kind_of_file_can_be_dropped() {
    let folder = Folder::new();
    let mut harness = editor();
    let model = folder.path("square.glb");
    write_square(&model, &json!({"name": "Wood"}));
    drop_on(&mut harness, std::slice::from_ref(&model));
    wait(&mut harness, "the model", |app| {
        app.document().model == ModelSource::File(model.clone())
    });

    let light = folder.path("light.hdr");
    write_hdr(&light, 8, 4, |_, _| [1.0, 2.0, 3.0]);
    drop_on(&mut harness, std::slice::from_ref(&light));
    let of_light = EnvironmentSource::File(light);
    wait(&mut harness, "the environment", |app| {
        app.document().lighting.environment == of_light
    });

    let mut material = harness.state().document().materials[0].clone();
    (material.name, material.roughness) = ("Dropped".to_owned(), 0.77);
    let file = folder.path("dropped.json");
    save_material(&file, &material).unwrap();
    drop_on(&mut harness, &[file]);
    wait(&mut harness, "the material", |app| {
        app.document().materials[0].name == "Dropped"
    });

    // Pictures are for the selected material.
    for name in ["wood.png", "wood.webp"] {
        let wood = folder.path(name);
        image::open({
            let png = folder.path("source.png");
            write_png(&png);
            png
        })
        .unwrap()
        .save(&wood)
        .unwrap();
        drop_on(&mut harness, std::slice::from_ref(&wood));
        wait(&mut harness, name, |app| {
            let own = app.document().materials[0].user_textures.get(TextureTarget::BaseColor);
            own.is_some_and(|own| own.file == wood)
        });
    }

    let mut document = small_document();
    document.render.samples = 2;
    let project = folder.path("project.json");
    save_document(&project, &document).unwrap();
    drop_on(&mut harness, &[project]);
    // The document has unsaved edits: it is asked for first.
    see_label(&mut harness, "Discard");
    harness.get_by_role_and_label(Role::Button, "Discard").click_accesskit();
    wait(&mut harness, "the project", |app| app.document().render.samples == 2);

    let other = folder.path("notes.txt");
    std::fs::write(&other, "nothing").unwrap();
    drop_on(&mut harness, &[other]);
    wait_for_words(&mut harness, "notes.txt: not a kind of file that can be opened");
    let part = folder.path("square.bin");
    std::fs::write(&part, "bytes").unwrap();
    drop_on(&mut harness, &[part]);
    wait_for_words(&mut harness, "square.bin: part of a model");
}

#[test]
fn a_model_its_parts_and_its_light_are_dropped_together() {
    let folder = Folder::new();
    let (buffer, mut document) = square();
    document["buffers"][0]["uri"] = json!("square.bin");
    document["images"] = json!([{"uri": "wood.png"}]);
    document["textures"] = json!([{"source": 0}]);
    document["materials"] =
        json!([{"name": "Wood", "doubleSided": true, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    let path = |name: &str| folder.path(name);
    for place in ["model", "data"] {
        std::fs::create_dir(path(place)).unwrap();
    }
    std::fs::write(path("model/square.gltf"), document.to_string()).unwrap();
    std::fs::write(path("data/square.bin"), &buffer.bytes).unwrap();
    write_png(&path("data/wood.png"));
    write_png(&path("data/left.png"));
    write_hdr(&path("light.hdr"), 8, 4, |_, _| [1.0, 2.0, 3.0]);
    let names = [
        "data/wood.png",
        "light.hdr",
        "data/left.png",
        "model/square.gltf",
        "data/square.bin",
    ];
    let mut harness = editor();
    drop_on(&mut harness, &names.map(path));
    let source = ModelSource::File(path("model/square.gltf"));
    wait(&mut harness, "the model", |app| app.document().model == source);
    let light = EnvironmentSource::File(path("light.hdr"));
    wait(&mut harness, "the light", |app| {
        app.document().lighting.environment == light
    });
    settle(&mut harness);
    let snapshot = harness.state().snapshot();
    let model = &snapshot.scene.as_ref().expect("a scene").model;
    assert_eq!((model.mesh.triangles.len(), model.textures.len()), (2, 1));
    assert!(model.report.is_clean(), "{:?}", model.report);
    assert!(says(&harness, "left.png: not used"), "{:?}", harness.state().messages());
    assert!(!says(&harness, "wood.png: not used"));
    let materials = &harness.state().document().materials;
    assert!(
        materials
            .iter()
            .all(|material| material.user_textures.iter().next().is_none())
    );
}

#[test]
fn a_base_color_dropped_with_a_plain_model_is_put_on_it() {
    let folder = Folder::new();
    let (model, color, normal) = (
        folder.path("square.glb"),
        folder.path("oak_BaseColor.png"),
        folder.path("oak_n.png"),
    );
    write_square(&model, &json!({"name": "Wood"}));
    write_png(&color);
    write_png(&normal);
    let mut harness = editor();
    drop_on(&mut harness, &[color.clone(), model, normal]);
    wait(&mut harness, "the picture", |app| {
        let own = app.document().materials[0].user_textures.get(TextureTarget::BaseColor);
        own.is_some_and(|own| own.file == color)
    });
    assert!(says(&harness, "oak_n.png: not used"));
}

#[test]
fn six_faces_dropped_together_are_one_environment() {
    let folder = Folder::new();
    let faces = ["px", "nx", "py", "ny", "pz", "nz"].map(|face| folder.path(&format!("sky_{face}.png")));
    faces.iter().for_each(|face| {
        image::RgbImage::from_pixel(4, 4, image::Rgb([9, 90, 200]))
            .save(face)
            .unwrap();
    });
    let mut harness = editor();
    drop_on(&mut harness, &faces);
    let expected = EnvironmentSource::File(folder.path(""));
    wait(&mut harness, "the environment", |app| {
        let EnvironmentSource::File(found) = &app.document().lighting.environment else {
            return false;
        };
        EnvironmentSource::File(found.join("")) == expected
    });
}

#[test]
fn addresses_get_a_message_and_pasted_names_are_opened() {
    let folder = Folder::new();
    let model = folder.path("my square.glb");
    write_square(&model, &json!({"name": "Wood"}));
    let mut harness = editor();
    let before = harness.state().document().clone();
    request(&mut harness, Action::Paste("https://example.org/duck.glb".to_owned()));
    assert!(says(
        &harness,
        "https://example.org/duck.glb: web addresses are not opened"
    ));
    drop_on(&mut harness, &[PathBuf::from("https://example.org/goose.glb")]);
    assert!(says(&harness, "goose.glb: web addresses are not opened"));
    request(&mut harness, Action::Paste("Dear reader".to_owned()));
    assert!(says(&harness, "the pasted text is not a file name: Dear reader"));
    assert_eq!(*harness.state().document(), before);
    // As file managers write names; the keys bring it in, as nothing else has them.
    let text = format!("file://{}", model.display().to_string().replace(' ', "%20"));
    harness.event(egui::Event::Paste(text));
    harness.step();
    wait(&mut harness, "the model", |app| {
        app.document().model == ModelSource::File(model.clone())
    });
}

#[test]
fn opening_can_be_called_off() {
    let folder = Folder::new();
    let model = folder.path("many.obj");
    // Enough that it is still being read when the button is pressed.
    let mut text = String::new();
    for i in 0..60_000 {
        text.push_str(&format!("o part{i}\nv {i} 0 0\nv {i} 1 0\nv {i} 0 1\nf -3 -2 -1\n"));
    }
    std::fs::write(&model, text).unwrap();
    let mut harness = editor();
    let before = harness.state().document().clone();
    let shown = picture(&harness);
    harness.state_mut().request(Action::Open(model));
    harness.step();
    let begun = Instant::now();
    while harness.query_by_role_and_label(Role::Button, "Stop loading").is_none() {
        assert!(
            begun.elapsed() < Duration::from_secs(120),
            "no button: {:?}",
            harness.state().messages()
        );
        harness.step();
    }
    let snapshot = harness.state().snapshot();
    assert!(matches!(&snapshot.activity, Activity::Loading(what) if what.contains("many.obj")));
    harness
        .get_by_role_and_label(Role::Button, "Stop loading")
        .click_accesskit();
    see(&mut harness, "the word", |harness| {
        says(harness, "opening was cancelled")
    });
    settle(&mut harness);
    assert_eq!(*harness.state().document(), before);
    assert_eq!(picture(&harness), shown);
    assert!(harness.query_by_role_and_label(Role::Button, "Stop loading").is_none());
}

#[test]
fn what_another_program_saves_is_read_again_and_edits_stay() {
    let folder = Folder::new();
    let path = folder.path("square.glb");
    let red = |roughness: f32| json!({"name": "Red", "pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.1, 0.1, 1.0], "roughnessFactor": roughness}});
    write_square(&path, &red(0.9));
    let mut document = small_document();
    (document.camera.yaw_deg, document.camera.pitch_deg) = (10.0, 5.0);
    let mut harness = editor_with(document, vec![path.clone()]);
    settle(&mut harness);
    let (before, camera) = (picture(&harness), harness.state().document().camera);

    // Another colour: nothing was edited, the material follows its file, the view stays.
    let mut green = red(0.9);
    green["pbrMetallicRoughness"]["baseColorFactor"] = json!([0.1, 0.8, 0.1, 1.0]);
    write_square(&path, &green);
    wait_for_words(&mut harness, "read square again");
    wait(&mut harness, "the file's colour", |app| {
        app.document().materials[0].base_color[1] > 0.5
    });
    settle(&mut harness);
    assert!(picture(&harness) != before);
    assert_eq!(harness.state().document().camera, camera);

    // What was edited here stays as it is.
    harness
        .get_by_role_and_label(Role::SpinButton, "Specular roughness")
        .set_value_accesskit(0.123);
    settle(&mut harness);
    let edited = harness.state().document().materials[0].clone();
    let model = |harness: &Editor| {
        let scene = harness.state().snapshot().scene.clone();
        scene.map(|scene| Arc::as_ptr(&scene.model).addr())
    };
    let before = model(&harness);
    write_square(&path, &red(0.2));
    see(&mut harness, "the second time", |harness| model(harness) != before);
    settle(&mut harness);
    assert_eq!(harness.state().document().materials[0], edited);

    // A file that is half written changes nothing but is told.
    let whole = std::fs::read(&path).unwrap();
    let document = harness.state().document().clone();
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    wait_for_words(&mut harness, "cut short");
    assert_eq!(*harness.state().document(), document);
    settle(&mut harness);
    undo(&mut harness);
    assert!(harness.state().document().materials[0] != edited);
}

#[test]
fn damaged_files_are_named_and_change_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("a temporary file");
        path
    };
    let files = [
        write("text.glb", b"this is no model"),
        write(
            "short.hdr",
            b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 128\n\x02\x02",
        ),
        write("half.json", b"{\"glossmith\": 1, \"material\": {"),
        write("notes.txt", b"hello"),
    ];
    let mut harness = editor();
    let (document, before) = (harness.state().document().clone(), picture(&harness));
    for path in files {
        request(&mut harness, Action::Open(path.clone()));
        let name = path.display().to_string();
        wait(&mut harness, "a message", |app| {
            app.messages().iter().any(|text| text.contains(&name))
        });
    }
    settle(&mut harness);
    assert_eq!(*harness.state().document(), document);
    assert_eq!(picture(&harness), before);
}
