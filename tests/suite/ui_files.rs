//! Files that are dropped on the window and pasted into it, opening that is called off, and files that other programs save.

use std::{path::Path, path::PathBuf, sync::Arc};

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable as _;
use glossmith::{
    app::actions::Action,
    scene::{ModelSource, environment::EnvironmentSource, texture::TextureTarget},
    store::{save_document, save_material},
};
use serde_json::json;

use super::{
    cli_support::write_hdr,
    gltf_builder::{Folder, glb, png, square},
    ui::{Editor, editor, editor_with, picture, request, see, see_label, settle, undo, wait},
    ui_hands::Hands as _,
    worker::small_document,
};

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

    let mut material = harness.document().materials[0].clone();
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
fn what_another_program_saves_is_read_again_and_edits_stay() {
    let folder = Folder::new();
    let path = folder.path("square.glb");
    let red = |roughness: f32| json!({"name": "Red", "pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.1, 0.1, 1.0], "roughnessFactor": roughness}});
    write_square(&path, &red(0.9));
    let mut document = small_document();
    (document.camera.yaw_deg, document.camera.pitch_deg) = (10.0, 5.0);
    let mut harness = editor_with(document, vec![path.clone()]);
    settle(&mut harness);
    let (before, camera) = (picture(&harness), harness.document().camera);

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
    assert_eq!(harness.document().camera, camera);

    // What was edited here stays as it is.
    harness.set("Specular roughness", 0.123);
    settle(&mut harness);
    let edited = harness.document().materials[0].clone();
    let model = |harness: &Editor| {
        let scene = harness.state().snapshot().scene.clone();
        scene.map(|scene| Arc::as_ptr(&scene.model).addr())
    };
    let before = model(&harness);
    write_square(&path, &red(0.2));
    see(&mut harness, "the second time", |harness| model(harness) != before);
    settle(&mut harness);
    assert_eq!(harness.document().materials[0], edited);

    // A file that is half written changes nothing but is told.
    let whole = std::fs::read(&path).unwrap();
    let document = harness.document().clone();
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    wait_for_words(&mut harness, "cut short");
    assert_eq!(*harness.document(), document);
    settle(&mut harness);
    undo(&mut harness);
    assert!(harness.document().materials[0] != edited);
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
    let (document, before) = (harness.document().clone(), picture(&harness));
    for path in files {
        request(&mut harness, Action::Open(path.clone()));
        let name = path.display().to_string();
        wait_for_words(&mut harness, &name);
    }
    settle(&mut harness);
    assert_eq!(*harness.document(), document);
    assert_eq!(picture(&harness), before);
}
