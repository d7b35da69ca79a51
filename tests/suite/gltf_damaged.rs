//! What is said about files that cannot be loaded; that no file makes the loader panic.

use super::{
    cli_support::Workplace,
    gltf_builder::{glb, pictured, put, square},
};
use glossmith::import::{ModelError, load};
use glossmith::scene::{Fate, Model, ModelSource, texture::TextureTarget};
use serde_json::{Value, json};

/// Every refusal is one line that names the file and says what and what to do.
fn refused(result: Result<Model, ModelError>, words: &[&str]) {
    let message = result.expect_err("refused").to_string();
    for word in words {
        assert!(message.contains(word), "\"{message}\" does not say \"{word}\"");
    }
    assert!(!message.contains('\n') && message.contains(';'), "\"{message}\"");
}

#[test]
fn files_that_are_no_models_are_refused_with_a_reason() {
    let folder = Workplace::new();
    refused(load(&folder.model("nowhere.glb")), &["nowhere.glb", "cannot read"]);
    refused(
        load(&ModelSource::File(folder.root().to_owned())),
        &["no model in it", "glb"],
    );
    refused(
        folder.load("text.glb", b"Dear Sir,\n"),
        &["text.glb", "some other text", "export"],
    );
    refused(folder.load("empty.glb", b""), &["empty.glb", "empty"]);
    refused(
        folder.load("noise.glb", &[0x89, b'P', b'N', b'G', 0xff]),
        &["noise.glb", "not a glTF"],
    );
    refused(
        folder.load("cut.gltf", b"{\"asset\": {\"version\""),
        &["cut.gltf", "cut short"],
    );
    refused(
        folder.load("old.gltf", b"{\"asset\": {\"version\": \"1.0\"}}"),
        &["old.gltf", "1.0"],
    );
    refused(
        folder.load("bare.gltf", b"{\"asset\": {\"version\": \"2.0\"}}"),
        &["bare.gltf", "no triangles"],
    );
    let (buffer, document) = square();
    let whole = glb(&document, &buffer.bytes);
    refused(
        folder.load("cut.glb", &whole[..whole.len() / 2]),
        &["cut.glb", "cut short", &whole.len().to_string()],
    );
    for length in 0..whole.len() {
        assert!(
            folder.load("prefix.glb", &whole[..length]).is_err(),
            "{length} of {} bytes load",
            whole.len()
        );
    }
    let mut old = whole.clone();
    old[4] = 1;
    refused(folder.load("old.glb", &old), &["old.glb", "version 1"]);
}

#[test]
fn damaged_documents_are_refused_with_a_reason() {
    let folder = Workplace::new();
    for (place, value, words) in [
        (
            "/meshes/0/primitives/0/attributes/POSITION",
            json!(77),
            &["model.glb", "accessor 77", "does not exist"][..],
        ),
        (
            "/accessors/0/count",
            json!(4_000_000_000u64),
            &["POSITION", "beyond its data"],
        ),
        ("/accessors/0/type", json!("VEC2"), &["POSITION", "3 components"]),
        (
            "/accessors/0/byteOffset",
            json!(u64::MAX),
            &["POSITION", "beyond its data"],
        ),
        ("/bufferViews/0/byteOffset", json!(u64::MAX), &["POSITION"]),
        ("/bufferViews/0/byteLength", json!(u64::MAX), &["POSITION"]),
        ("/accessors/3/componentType", json!(5126), &["indices"]),
        ("/nodes", json!([{"mesh": 9}]), &["out of bounds"]),
        ("/meshes/0/primitives/0/mode", json!(1), &["no triangles"]),
        ("/scenes/0/nodes", json!([]), &["no triangles"]),
    ] {
        let (buffer, mut document) = square();
        put(&mut document, place, value);
        refused(folder.load_glb(&document, &buffer), words);
    }
    let (mut buffer, _) = square();
    let far = buffer.indices(&[0, 1, 4]);
    let document = buffer.document(json!([{"attributes": {"POSITION": 0}, "indices": far}]));
    refused(folder.load_glb(&document, &buffer), &["Part", "index 4", "4 vertices"]);
    let (buffer, mut document) = square();
    document["extensionsRequired"] = json!(["ACME_mesh", "KHR_texture_transform"]);
    document["scenes"][0]["nodes"] = json!([]);
    refused(folder.load_glb(&document, &buffer), &["ACME_mesh", "export without"]);
}

/// What a detail costs is told with its name, and the rest is shown.
#[test]
fn nothing_stops_for_a_detail() {
    let folder = Workplace::new();
    let mut broken = pictured(json!({"emissiveTexture": {"index": 0}}), b"no picture");
    put(&mut broken.1, "/images/0/name", json!("broken"));
    let whole = json!({"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3});
    let circle = json!([{"mesh": 0, "children": [0], "name": "Loop"}]);
    for ((buffer, mut document), place, value, fate, words) in [
        (
            square(),
            "/extensionsRequired",
            json!(["ACME_thing"]),
            Fate::Ignored,
            ["ACME_thing", "requires"],
        ),
        (
            square(),
            "/extensionsUsed",
            json!(["ACME_other"]),
            Fate::Ignored,
            ["optional", "ACME_other"],
        ),
        (
            square(),
            "/accessors/1/count",
            json!(3),
            Fate::Ignored,
            ["NORMAL", "3 values for 4"],
        ),
        (
            square(),
            "/buffers/0/byteLength",
            json!(1_000_000),
            Fate::Missing,
            ["1000000", "buffer 0"],
        ),
        (square(), "/nodes", circle, Fate::Ignored, ["ancestor", "Loop"]),
        (
            square(),
            "/scenes/0/nodes",
            json!([0, 9]),
            Fate::Missing,
            ["node 9", ""],
        ),
        (
            square(),
            "/meshes/0/primitives/0/material",
            json!(5),
            Fate::Missing,
            ["material 5", ""],
        ),
        (
            broken,
            "/asset/generator",
            json!("a test"),
            Fate::Missing,
            ["grey", "broken"],
        ),
        (
            square(),
            "/meshes/0/primitives",
            json!([whole, {"attributes": {}}]),
            Fate::Ignored,
            ["without triangles", "Part"],
        ),
    ] {
        put(&mut document, place, value);
        let model = folder.load_glb(&document, &buffer).expect("loads");
        assert_eq!(model.mesh.triangles.len(), 2, "{words:?}");
        assert_eq!(model.slots[0].texture(TextureTarget::Emission), None, "{words:?}");
        let mut lines = model.report.of(fate).map(|entry| entry.line());
        let found = lines.any(|line| words.iter().all(|word| line.contains(word)));
        assert!(found, "{words:?}: {:?}", model.report);
        assert!(model.report.summary().is_some());
    }
}

/// What no exporter writes is refused with its reason: nothing is guessed in its place.
#[test]
fn what_no_exporter_writes_is_refused() {
    let folder = Workplace::new();
    let (buffer, mut document) = square();
    folder.write("square.bin", &buffer.bytes);
    document["buffers"][0]["uri"] = json!("square.bin");
    document["materials"] = json!([{"pbrMetallicRoughness": {"roughnessFactor": 0.75}}]);
    document["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}}]);
    document["animations"] = json!([{"channels": [], "samplers": []}]);
    let text = document.to_string();
    folder.load("whole.gltf", text.as_bytes()).expect("loads");
    let words = ["damaged: its JSON", "export the model again"];
    for number in ["1e999", "-1e999", "NaN", "Infinity", "1.2.3", ".5", "wide"] {
        refused(
            folder.load("number.gltf", text.replace("0.75", number).as_bytes()),
            &words,
        );
    }
    for pointer in [
        "/scene",
        "/textures",
        "/extensionsUsed",
        "/accessors/1/count",
        "/animations/0/channels/0",
        "/bufferViews/2/byteLength",
        "/buffers/0/byteLength",
        "/cameras/0/perspective/yfov",
        "/meshes/0/primitives",
        "/nodes/0/children",
        "/scenes/0/nodes",
    ] {
        let mut broken = document.clone();
        let (part, key) = pointer.rsplit_once('/').expect("a key");
        match broken.pointer_mut(part).expect(part) {
            Value::Array(list) => list.push(json!(7)),
            part => part[key] = json!({"wide": 7}),
        }
        refused(folder.load("part.gltf", broken.to_string().as_bytes()), &words);
    }
}
