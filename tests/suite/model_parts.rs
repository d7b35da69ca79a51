//! Several files as one model, and what is told while they are read.

use std::path::PathBuf;

use glossmith::{
    document::Document,
    import::{ModelError, load_watched, load_with},
    scene::{
        Fate, Geometry, Loading, ModelOptions, ModelSource,
        environment::{EnvironmentEncoding, EnvironmentSource},
        texture::TextureTarget,
    },
    store::{load_document, save_document},
};
use serde_json::json;

use super::cli_support::{Workplace, write_exr, write_hdr};
use super::gltf_builder::{glb, png, square};

fn with(beside: Vec<PathBuf>) -> ModelOptions {
    ModelOptions {
        beside,
        ..ModelOptions::default()
    }
}

/// A square with a texture, its buffer and picture in files of their own.
fn scattered(folder: &Workplace) -> [PathBuf; 3] {
    let (buffer, mut document) = square();
    document["buffers"][0]["uri"] = json!("square.bin");
    document["images"] = json!([{"uri": "textures/Wood.png"}]);
    document["textures"] = json!([{"source": 0}]);
    document["materials"] =
        json!([{"name": "Wood", "doubleSided": true, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    let paths = ["a/square.gltf", "b/square.bin", "c/wood.PNG"].map(|name| folder.path(name));
    for path in &paths {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    }
    std::fs::write(&paths[0], document.to_string()).unwrap();
    std::fs::write(&paths[1], &buffer.bytes).unwrap();
    std::fs::write(&paths[2], png()).unwrap();
    paths
}

#[test]
fn what_a_model_names_is_found_among_the_files_given_with_it() {
    let folder = Workplace::new();
    let [model, buffer, picture] = scattered(&folder);
    let source = ModelSource::File(model.clone());
    let error = load_with(&source, &ModelOptions::default()).expect_err("its buffer is elsewhere");
    assert!(error.to_string().contains("square.bin"), "{error}");
    let found = load_with(&source, &with(vec![buffer.clone(), picture.clone()])).expect("loads");
    assert!(found.report.is_clean(), "{:?}", found.report);
    assert_eq!((found.mesh.triangles.len(), found.textures.len()), (2, 1));
    assert_eq!(found.files, [model.clone(), buffer, picture]);
    // What is missing is watched for, too.
    let [_, buffer, _] = scattered(&folder);
    let grey = load_with(&source, &with(vec![buffer])).expect("loads without its picture");
    assert!(
        grey.files.contains(&folder.path("a/textures/Wood.png")),
        "{:?}",
        grey.files
    );
}

#[test]
fn models_given_together_are_shown_together() {
    let folder = Workplace::new();
    let [model, buffer, picture] = scattered(&folder);
    let stl = "solid one\nfacet normal 0 0 1\nouter loop\nvertex 5 0 0\nvertex 6 0 0\nvertex 5 0 1\nendloop\nendfacet\nendsolid one\n";
    let part = folder.path("part.stl");
    std::fs::write(&part, stl).unwrap();
    let (of_glb, document) = square();
    let other = folder.path("other.glb");
    std::fs::write(&other, glb(&document, &of_glb.bytes)).unwrap();
    let options = with(vec![part.clone(), buffer, picture, other.clone()]);
    let whole = load_with(&ModelSource::File(model), &options).expect("loads");
    assert_eq!(
        (whole.name.as_str(), whole.mesh.triangles.len(), whole.slots.len()),
        ("square", 5, 3)
    );
    assert_eq!(whole.mesh.slots, [0, 0, 1, 2, 2]);
    assert_eq!(whole.slots[0].texture(TextureTarget::BaseColor).unwrap().texture, 0);
    let names: Vec<&String> = whole.report.of(Fate::Used).flat_map(|entry| &entry.names).collect();
    assert!(names.iter().any(|name| *name == "part.stl") && names.iter().any(|name| *name == "other.glb"));
    assert!(whole.files.contains(&part) && whole.files.contains(&other));
    // A project finds them again from its folder.
    let project = folder.path("project.json");
    let document = Document {
        model: folder.model("a/square.gltf"),
        import: options.clone(),
        ..Document::default()
    };
    save_document(&project, &document).unwrap();
    assert!(std::fs::read_to_string(&project).unwrap().contains("\"part.stl\""));
    assert_eq!(load_document(&project).unwrap().value.import, options);
}

#[test]
fn loading_tells_what_it_does_and_ends_when_it_is_called_off() {
    let folder = Workplace::new();
    let [model, buffer, picture] = scattered(&folder);
    let (source, options) = (ModelSource::File(model), with(vec![buffer, picture]));
    let loading = Loading::default();
    load_watched(&source, &options, &loading).expect("loads");
    assert_eq!(loading.doing(), "texture 1 of 1");
    loading.cancel();
    let error = load_watched(&source, &options, &loading).expect_err("called off");
    assert!(matches!(error, ModelError::Cancelled(_)), "{error}");
    let model = load_with(&source, &options).expect("loads");
    assert!(Geometry::of_model(&model, &[], &loading).is_err());
    loading.begin();
    assert!(Geometry::of_model(&model, &[], &loading).is_ok());
    let (hdr, exr) = (folder.path("light.hdr"), folder.path("light.exr"));
    write_hdr(&hdr, 8, 4, |_, _| [1.0; 3]);
    write_exr(&exr, 8, 4, |_, _| [1.0; 3]);
    for path in [hdr, exr] {
        let source = EnvironmentSource::File(path);
        let load =
            |loading| glossmith::import::environment::load_watched(&source, EnvironmentEncoding::Display, loading);
        loading.begin();
        assert!(load(&loading).is_ok());
        assert!(loading.doing().contains("distribution"), "{}", loading.doing());
        loading.cancel();
        let error = load(&loading).expect_err("called off").to_string();
        assert!(error.contains("cancelled"), "{error}");
    }
}
