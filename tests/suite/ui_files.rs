//! Files that are dropped on the window and pasted into it, opening that is called off, and files that other programs save.

use std::{path::Path, path::PathBuf, sync::Arc};

use glossmith::{
    app::actions::Action,
    scene::{ModelSource, environment::EnvironmentSource, texture::TextureTarget},
    store::{save_document, save_material},
};
use serde_json::json;

use super::{
    cli_support::{Workplace, write_hdr},
    gltf_builder::{glb, png, square},
    ui::{Editor, editor, editor_with, picture},
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

impl Editor {
    /// Drops files on the window as the system does: all in one frame.
    pub fn drop_on(&mut self, paths: &[PathBuf]) {
        let files = paths
            .iter()
            .map(|path| Arc::new(Dropped(path.clone())) as egui::DroppedFileHandle);
        self.input_mut().dropped_files = files.collect();
        self.step();
        self.step();
    }
}

pub fn says(harness: &Editor, part: &str) -> bool {
    harness.state().messages().iter().any(|text| text.contains(part))
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
    let folder = Workplace::new();
    let mut harness = editor();
    let model = folder.path("square.glb");
    write_square(&model, &json!({"name": "Wood"}));
    harness.drop_on(std::slice::from_ref(&model));
    harness.wait("the model", |app| {
        app.document().model == ModelSource::File(model.clone())
    });

    let light = folder.path("light.hdr");
    write_hdr(&light, 8, 4, |_, _| [1.0, 2.0, 3.0]);
    harness.drop_on(std::slice::from_ref(&light));
    let of_light = EnvironmentSource::File(light);
    harness.wait("the environment", |app| app.document().lighting.environment == of_light);

    let mut material = harness.material().clone();
    (material.name, material.roughness) = ("Dropped".to_owned(), 0.77);
    let file = folder.path("dropped.json");
    save_material(&file, &material).unwrap();
    harness.drop_on(&[file]);
    harness.wait("the material", |app| app.document().materials[0].name == "Dropped");

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
        harness.drop_on(std::slice::from_ref(&wood));
        harness.wait(name, |app| {
            let own = app.document().materials[0].user_textures.get(TextureTarget::BaseColor);
            own.is_some_and(|own| own.file == wood)
        });
    }

    let mut document = small_document();
    document.render.samples = 2;
    let project = folder.path("project.json");
    save_document(&project, &document).unwrap();
    harness.drop_on(&[project]);
    // The document has unsaved edits: it is asked for first.
    harness.see_label("Discard");
    harness.press("Discard");
    harness.wait("the project", |app| app.document().render.samples == 2);

    let other = folder.path("notes.txt");
    std::fs::write(&other, "nothing").unwrap();
    harness.drop_on(&[other]);
    harness.wait_for_words("notes.txt: not a kind of file that can be opened");
    let part = folder.path("square.bin");
    std::fs::write(&part, "bytes").unwrap();
    harness.drop_on(&[part]);
    harness.wait_for_words("square.bin: part of a model");
}

#[test]
fn what_another_program_saves_is_read_again_and_edits_stay() {
    let folder = Workplace::new();
    let path = folder.path("square.glb");
    let red = |roughness: f32| json!({"name": "Red", "pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.1, 0.1, 1.0], "roughnessFactor": roughness}});
    write_square(&path, &red(0.9));
    let mut document = small_document();
    (document.camera.yaw_deg, document.camera.pitch_deg) = (10.0, 5.0);
    let mut harness = editor_with(document, vec![path.clone()]);
    harness.settle();
    let (before, camera) = (picture(&harness), harness.document().camera);

    // Another colour: nothing was edited, the material follows its file, the view stays.
    let mut green = red(0.9);
    green["pbrMetallicRoughness"]["baseColorFactor"] = json!([0.1, 0.8, 0.1, 1.0]);
    write_square(&path, &green);
    harness.wait_for_words("read square again");
    harness.wait("the file's colour", |app| {
        app.document().materials[0].base_color[1] > 0.5
    });
    harness.settle();
    assert!(picture(&harness) != before);
    assert_eq!(harness.document().camera, camera);

    // What was edited here stays as it is.
    harness.set("Specular roughness", 0.123);
    harness.settle();
    let edited = harness.material().clone();
    let model = |harness: &Editor| {
        let scene = harness.state().snapshot().scene.clone();
        scene.map(|scene| Arc::as_ptr(&scene.model).addr())
    };
    let before = model(&harness);
    write_square(&path, &red(0.2));
    harness.see("the second time", |harness| model(harness) != before);
    harness.settle();
    assert_eq!(*harness.material(), edited);

    // A file that is half written changes nothing but is told.
    let whole = std::fs::read(&path).unwrap();
    let document = harness.document().clone();
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    harness.wait_for_words("cut short");
    assert_eq!(*harness.document(), document);
    harness.settle();
    harness.undo();
    assert_ne!(*harness.material(), edited);
}

#[test]
fn damaged_files_are_named_and_change_nothing() {
    let folder = Workplace::new();
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.path(name);
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
        harness.request(Action::Open(path.clone()));
        let name = path.display().to_string();
        harness.wait_for_words(&name);
    }
    harness.settle();
    assert_eq!(*harness.document(), document);
    assert_eq!(picture(&harness), before);
}
