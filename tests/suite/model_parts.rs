//! Several files as one model, what is told while they are read, and reading them again.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use glossmith::document::Document;
use glossmith::import::{ModelError, load_watched, load_with};
use glossmith::render::Assets;
use glossmith::scene::environment::{EnvironmentEncoding, EnvironmentSource};
use glossmith::scene::texture::TextureTarget;
use glossmith::scene::{Fate, Geometry, Loading, ModelOptions, ModelSource};
use glossmith::store::{load_document, save_document};
use serde_json::json;

use super::cli_support::{write_exr, write_hdr};
use super::gltf_builder::{Folder, glb, png, square};

fn with(beside: Vec<PathBuf>) -> ModelOptions {
    ModelOptions {
        beside,
        ..ModelOptions::default()
    }
}

/// A square with a texture, its buffer and picture in files of their own.
fn scattered(folder: &Folder) -> [PathBuf; 3] {
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
    let folder = Folder::new();
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
    let folder = Folder::new();
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
        model: ModelSource::File(folder.path("a/square.gltf")),
        import: options.clone(),
        ..Document::default()
    };
    save_document(&project, &document).unwrap();
    assert!(std::fs::read_to_string(&project).unwrap().contains("\"part.stl\""));
    assert_eq!(load_document(&project).unwrap().value.import, options);
}

#[test]
fn loading_tells_what_it_does_and_ends_when_it_is_called_off() {
    let folder = Folder::new();
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

/// Each step of loading a large model ends soon after it is called off: reading, parsing, normals, tangents, hierarchy, the proof
/// that it is convex. It is called off at ever later times, until it is done before.
#[test]
fn loading_ends_soon_wherever_it_is_called_off() {
    const SIDE: usize = 350;
    let folder = Folder::new();
    let place = |i: usize| (i as f32 / SIDE as f32, ((i * i) % 97) as f32 / 9700.0);
    let mut ply = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        (SIDE + 1) * (SIDE + 1),
        SIDE * SIDE
    )
    .into_bytes();
    for (i, j) in (0..=SIDE).flat_map(|i| (0..=SIDE).map(move |j| (i, j))) {
        let numbers = [place(i).0, place(j).0, place(i).1 + place(j).1];
        numbers.iter().for_each(|number| ply.extend(number.to_le_bytes()));
    }
    for (i, j) in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| (i, j))) {
        ply.push(4);
        let first = i * (SIDE + 1) + j;
        let corners = [first, first + SIDE + 1, first + SIDE + 2, first + 1];
        corners
            .iter()
            .for_each(|corner| ply.extend((*corner as u32).to_le_bytes()));
    }
    let path = folder.path("wavy.ply");
    std::fs::write(&path, ply).unwrap();
    let source = ModelSource::File(path);
    let load = |loading: &Loading| {
        let model = load_watched(&source, &ModelOptions::default(), loading);
        model.is_ok_and(|model| Geometry::of_model(&model, &[], loading).is_ok())
    };
    for wait_ms in (0..).map(|step| 30 * step) {
        let loading = Loading::default();
        let (is_done, late) = std::thread::scope(|scope| {
            let loads = scope.spawn(|| (load(&loading), Instant::now()));
            std::thread::sleep(Duration::from_millis(wait_ms));
            let called_off = Instant::now();
            loading.cancel();
            let (is_done, ended) = loads.join().unwrap();
            (is_done, ended.saturating_duration_since(called_off))
        });
        assert!(
            is_done || late < Duration::from_secs(2),
            "called off after {wait_ms} ms, at {}: {late:?} late",
            loading.doing()
        );
        if is_done {
            return;
        }
    }
}

#[test]
fn files_are_read_again_unless_they_are_broken() {
    let folder = Folder::new();
    let path = folder.path("square.glb");
    let (buffer, mut document) = square();
    std::fs::write(&path, glb(&document, &buffer.bytes)).unwrap();
    let assets = Assets::default();
    let source = ModelSource::File(path.clone());
    let options = ModelOptions::default();
    let reload = || {
        assets.reload(
            &source,
            &options,
            &EnvironmentSource::Furnace,
            EnvironmentEncoding::Display,
        )
    };
    let first = assets.model(&source, &options).unwrap();
    document["materials"] = json!([{"name": "New"}]);
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    std::fs::write(&path, glb(&document, &buffer.bytes)).unwrap();
    assert_eq!(assets.model(&source, &options).unwrap().slots[0].name, "Clay", "kept");
    let again = reload().expect("it is whole");
    assert_eq!(again.before.as_deref(), Some(&*first));
    assert_eq!(again.model.slots[0].name, "New");
    assert_eq!(assets.model(&source, &options).unwrap(), again.model);
    std::fs::write(&path, "half writt").unwrap();
    assert!(reload().is_err());
    assert_eq!(
        assets.model(&source, &options).unwrap(),
        again.model,
        "what was there stays"
    );
}
