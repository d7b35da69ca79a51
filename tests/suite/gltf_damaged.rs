//! What is said about files that cannot be loaded; that no file makes the loader panic.

use glossmith::import::{ModelError, load};
use glossmith::scene::{Fate, Geometry, Model, ModelSource};
use serde_json::{Value, json};

use super::gltf_builder::{Folder, glb, png, square};
use super::support::Random;

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
    let folder = Folder::new();
    refused(
        load(&ModelSource::File(folder.path("nowhere.glb"))),
        &["nowhere.glb", "cannot read"],
    );
    refused(
        load(&ModelSource::File(folder.0.path().to_owned())),
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
    let folder = Folder::new();
    let check = |change: &dyn Fn(&mut Value), words: &[&str]| {
        let (buffer, mut document) = square();
        change(&mut document);
        refused(folder.load_glb(&document, &buffer), words);
    };
    check(
        &|d| d["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(77),
        &["model.glb", "beyond the 4"],
    );
    check(
        &|d| d["accessors"][0]["count"] = json!(4_000_000_000u64),
        &["POSITION", "beyond its data"],
    );
    check(
        &|d| d["accessors"][0]["type"] = json!("VEC2"),
        &["POSITION", "3 components"],
    );
    check(
        &|d| d["accessors"][0]["byteOffset"] = json!(u64::MAX),
        &["POSITION", "beyond its data"],
    );
    check(&|d| d["bufferViews"][0]["byteOffset"] = json!(u64::MAX), &["POSITION"]);
    check(&|d| d["bufferViews"][0]["byteLength"] = json!(u64::MAX), &["POSITION"]);
    check(&|d| d["accessors"][3]["componentType"] = json!(5126), &["indices"]);
    check(&|d| d["nodes"] = json!([{"mesh": 9}]), &["out of bounds"]);
    check(
        &|d| d["meshes"][0]["primitives"][0]["mode"] = json!(1),
        &["no triangles"],
    );
    check(&|d| d["scenes"][0]["nodes"] = json!([]), &["no triangles"]);
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
    let folder = Folder::new();
    let shown = |change: &dyn Fn(&mut Value), triangles: usize, fate: Fate, words: &[&str]| {
        let (buffer, mut document) = square();
        change(&mut document);
        let model = folder.load_glb(&document, &buffer).expect("loads");
        assert_eq!(model.mesh.triangles.len(), triangles, "{words:?}");
        let lines: Vec<String> = model.report.of(fate).map(|entry| entry.line()).collect();
        let found = lines.iter().any(|line| words.iter().all(|word| line.contains(word)));
        assert!(found, "no line of {lines:?} says {words:?}");
        assert!(model.report.summary().is_some());
    };
    let shown_whole = |change: &dyn Fn(&mut Value), fate, words: &[&str]| shown(change, 2, fate, words);
    shown_whole(
        &|d| d["extensionsRequired"] = json!(["ACME_thing"]),
        Fate::Ignored,
        &["ACME_thing", "requires"],
    );
    shown_whole(
        &|d| d["extensionsUsed"] = json!(["ACME_other"]),
        Fate::Ignored,
        &["optional", "ACME_other"],
    );
    shown(
        &|d| d["accessors"][0]["count"] = json!(3),
        1,
        Fate::Ignored,
        &["NORMAL", "4 values for 3", "Part"],
    );
    shown_whole(
        &|d| d["buffers"][0]["byteLength"] = json!(1_000_000),
        Fate::Missing,
        &["1000000", "buffer 0"],
    );
    shown_whole(
        &|d| d["nodes"] = json!([{"mesh": 0, "children": [0], "name": "Loop"}]),
        Fate::Ignored,
        &["ancestor", "Loop"],
    );
    shown_whole(&|d| d["scenes"][0]["nodes"] = json!([0, 9]), Fate::Missing, &["node 9"]);
    shown_whole(
        &|d| d["meshes"][0]["primitives"][0]["material"] = json!(5),
        Fate::Missing,
        &["material 5"],
    );
    shown_whole(
        &|d| {
            d["images"] = json!([{"bufferView": 0, "mimeType": "image/png", "name": "broken"}]);
            d["textures"] = json!([{"source": 0}]);
            d["materials"] = json!([{"emissiveTexture": {"index": 0}}]);
            d["meshes"][0]["primitives"][0]["material"] = json!(0);
        },
        Fate::Missing,
        &["texture", "grey", "broken"],
    );
    shown_whole(
        &|d| {
            d["meshes"][0]["primitives"]
                .as_array_mut()
                .unwrap()
                .push(json!({"attributes": {}}))
        },
        Fate::Ignored,
        &["without triangles", "Part"],
    );
}

#[test]
fn random_damage_never_panics() {
    let folder = Folder::new();
    let (mut buffer, _) = square();
    let picture = buffer.view(&png());
    let primitive = json!({"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3, "material": 0});
    let mut document = buffer.document(json!([primitive]));
    document["images"] = json!([{"bufferView": picture, "mimeType": "image/png"}]);
    document["textures"] = json!([{"source": 0}]);
    document["materials"] = json!([{"emissiveTexture": {"index": 0}}]);
    let whole = glb(&document, &buffer.bytes);
    folder.load("whole.glb", &whole).expect("loads undamaged");
    let mut random = Random::new(1);
    let (mut loaded, mut refused) = (0, 0);
    for _ in 0..4000 {
        let mut bytes = whole.clone();
        for _ in 0..1 + random.below(3) {
            let at = random.below(bytes.len());
            // Mostly digits, which stay valid JSON and change what it means.
            bytes[at] = if bytes[at].is_ascii_digit() {
                b'0' + random.below(10) as u8
            } else {
                random.bits() as u8
            };
        }
        match folder.load("damaged.glb", &bytes) {
            Ok(model) => {
                let geometry = Geometry::build(&model, random.below(2) == 0);
                geometry.occluded([0.3, 0.2, -2.0], [0.01, 0.02, 1.0], f32::INFINITY);
                loaded += 1;
            }
            Err(_) => refused += 1,
        }
    }
    assert!(loaded > 100 && refused > 100, "{loaded} loaded, {refused} refused");
}

/// What the format leaves to the writer, in ways that few writers take.
#[test]
fn unusual_files_are_read() {
    let folder = Folder::new();
    let shown = |change: &dyn Fn(&mut Value)| {
        let (buffer, mut document) = square();
        change(&mut document);
        let model = folder.load_glb(&document, &buffer).expect("loads");
        assert_eq!(model.mesh.triangles.len(), 2, "{document}");
        model
    };
    let usual = shown(&|_| {}).mesh.positions;
    // Whole numbers with a point.
    shown(&|d| {
        d["scene"] = json!(0.0);
        d["accessors"][0]["count"] = json!(4.0);
        d["nodes"][0]["mesh"] = json!(0.0);
    });
    // A mesh that no node holds.
    let alone = shown(&|d| {
        for part in ["scene", "scenes", "nodes"] {
            d.as_object_mut().unwrap().remove(part);
        }
    });
    assert_eq!(alone.mesh.positions, usual);
    // What moves is no node.
    shown(&|d| {
        let sampler = json!({"input": 0, "output": 0});
        let channel = json!({"sampler": 0, "target": {"path": "pointer"}});
        d["animations"] = json!([{"samplers": [sampler], "channels": [channel]}]);
    });
}

/// What is as the format says is not called damaged, whatever else there is to tell of it.
#[test]
fn what_is_legal_is_not_called_damaged() {
    let folder = Folder::new();
    let (buffer, mut document) = square();
    document["extensionsUsed"] = json!(["ACME_unheard_of"]);
    document["meshes"][0]["primitives"][0]["mode"] = json!(1);
    let message = folder.load_glb(&document, &buffer).expect_err("lines").to_string();
    assert!(
        message.contains("no triangles") && !message.contains("damaged"),
        "{message}"
    );

    let (_, document) = square();
    let text = document.to_string();
    let message = folder
        .load("alone.gltf", text.as_bytes())
        .expect_err("no data")
        .to_string();
    assert!(
        message.contains("a buffer that has no data") && !message.contains("damaged"),
        "{message}"
    );
    let old = br#"{"asset": {"version": "1.0"}, "meshes": {"a": {}}}"#;
    let message = folder.load("old.gltf", old).expect_err("the first version").to_string();
    assert!(
        message.contains("of glTF version 1.0") && !message.contains("damaged"),
        "{message}"
    );

    let (buffer, mut document) = square();
    document["textures"] = json!([{"name": "for an extension"}]);
    document["materials"] = json!([{"emissiveTexture": {"index": 0}}]);
    let model = folder.load_glb(&document, &buffer).expect("loads");
    let breach = model.report.entries.iter().find(|entry| entry.what.contains("breach"));
    assert_eq!(breach, None);
}

/// Chunks that do not begin at multiples of four bytes are found.
#[test]
fn chunks_without_padding_are_read() {
    let folder = Folder::new();
    let (buffer, mut document) = square();
    document["asset"]["generator"] = json!("odd");
    while document.to_string().len() % 4 == 0 {
        document["asset"]["generator"] = json!("oddly");
    }
    let text = document.to_string();
    let length = (12 + 8 + text.len() + 8 + buffer.bytes.len()) as u32;
    let mut bytes = [b"glTF".as_slice(), &2_u32.to_le_bytes(), &length.to_le_bytes()].concat();
    for (kind, data) in [(b"JSON", text.as_bytes()), (b"BIN\0", &buffer.bytes)] {
        bytes.extend((data.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(data);
    }
    assert_eq!(folder.load("odd.glb", &bytes).expect("loads").mesh.triangles.len(), 2);
}

/// A detail that the format asks for and that is not there costs the detail alone.
#[test]
fn broken_details_cost_themselves_alone() {
    let folder = Folder::new();
    let (buffer, mut document) = square();
    document["cameras"] = json!([{"perspective": {"yfov": 0.5, "znear": 0.1}}, {"perspective": {"yfov": "wide"}}]);
    document["animations"] = json!([{"name": "still"}, {"channels": [7], "samplers": []}]);
    document["extensions"] = json!({"KHR_materials_variants": {"variants": [{}]}});
    document["nodes"] = json!([{"mesh": 0}, {"camera": 0}, {"camera": 1}]);
    document["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let model = folder.load_glb(&document, &buffer).expect("loads");
    assert_eq!((model.mesh.triangles.len(), model.cameras.len()), (2, 1));
    assert_eq!(model.variants, ["variant 0"]);
    for words in [
        "a camera that cannot be read",
        "an animation that cannot be read",
        "a camera without a lens",
    ] {
        assert!(
            model.report.of(Fate::Ignored).any(|entry| entry.what.contains(words)),
            "{words}: {:?}",
            model.report
        );
    }
}

/// A number that JSON or single precision cannot hold, or that is none, costs its own value, and the report says where.
#[test]
fn unreadable_numbers_of_a_gltf_file_cost_themselves_alone() {
    let folder = Folder::new();
    let (buffer, mut document) = square();
    std::fs::write(folder.path("square.bin"), &buffer.bytes).unwrap();
    document["buffers"][0]["uri"] = json!("square.bin");
    document["materials"] = json!([{"name": "1e999", "pbrMetallicRoughness": {
        "roughnessFactor": 777, "metallicFactor": 0.25, "baseColorFactor": [0.5, 777, 0.5, 1],
    }}]);
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    document["nodes"] = json!([{"mesh": 0, "translation": [777, 0, 0], "scale": [2, 2, 2]}]);
    for number in ["1e999", "-1e999", "1e39", "NaN", "Infinity", "1.2.3", "wide"] {
        let text = document.to_string().replace("777", number);
        let model = folder.load("numbers.gltf", text.as_bytes()).expect(number);
        let slot = &model.slots[0];
        assert_eq!((slot.name.as_str(), slot.metalness), ("1e999", 0.25), "{number}");
        assert_eq!(model.mesh.positions[2].to_array(), [2.0, 2.0, 0.0], "{number}");
        assert_eq!((slot.roughness, slot.base_color), (1.0, [1.0; 3]), "{number}");
        let told = model.report.of(Fate::Ignored);
        let places: Vec<&String> = told.flat_map(|entry| &entry.names).collect();
        for place in [
            "/materials/0/pbrMetallicRoughness/roughnessFactor",
            "/materials/0/pbrMetallicRoughness/baseColorFactor",
            "/nodes/0/translation",
        ] {
            assert!(places.iter().any(|told| *told == place), "{number}: {:?}", model.report);
        }
    }
    // One of several nodes, and the only mesh of a file.
    let text = document.to_string().replace("777", "0.5");
    let two = text.replacen(r#""nodes":[0]"#, r#""nodes":[0,NaN]"#, 1);
    let model = folder.load("two.gltf", two.as_bytes()).expect("loads");
    assert_eq!(model.mesh.triangles.len(), 2, "{:?}", model.report);
    let none = text.replacen(r#""POSITION":0"#, r#""POSITION":x"#, 1);
    assert_ne!(text, none);
    let refusal = folder.load("none.gltf", none.as_bytes());
    refused(
        refusal,
        &[
            "a number that cannot be read",
            "/meshes/0/primitives/0/attributes/POSITION",
        ],
    );
    // Members of the whole file of another type.
    for (member, value) in [
        ("scene", json!("hello")),
        ("asset", json!({"version": "2.0", "generator": 42})),
        ("textures", json!({"0": {}})),
        ("extensionsUsed", json!(7)),
    ] {
        let mut broken = document.clone();
        broken[member] = value;
        let text = broken.to_string().replace("777", "0.5");
        let model = folder.load("members.gltf", text.as_bytes()).expect(member);
        assert_eq!(model.mesh.triangles.len(), 2, "{member}");
        let mut told = model.report.of(Fate::Ignored);
        assert!(
            told.any(|entry| entry.names == [member]),
            "{member}: {:?}",
            model.report
        );
    }
    // What the format asks for: the part that cannot do without it goes.
    for (pointer, lost) in [
        ("/accessors/1/count", "an accessor"),
        ("/bufferViews/2/byteLength", "a buffer view"),
        ("/buffers/1/byteLength", "a buffer"),
        ("/meshes/1/primitives", "a mesh"),
        ("/nodes/1/children", "a node"),
        ("/scenes/1/nodes", "a scene"),
    ] {
        let mut broken = document.clone();
        for (list, more) in [
            ("buffers", json!({"byteLength": 4})),
            ("meshes", json!({"primitives": []})),
            ("nodes", json!({"children": [0]})),
            ("scenes", json!({"nodes": [0]})),
        ] {
            broken[list].as_array_mut().expect("a list").push(more);
        }
        *broken.pointer_mut(pointer).expect(pointer) = json!("wide");
        let text = broken.to_string().replace("777", "0.5");
        let model = folder.load("parts.gltf", text.as_bytes()).expect(pointer);
        assert_eq!(model.mesh.triangles.len(), 2, "{pointer}");
        let is_told = model.report.of(Fate::Ignored).any(|entry| entry.what.starts_with(lost));
        assert!(is_told, "{pointer}: {:?}", model.report);
    }
}
