//! What glTF's extensions add: compressed meshes, instances, poses, variants, lights and cameras.

use glam::DVec3;
use glossmith::import::load_with;
use glossmith::scene::{Fate, Model, ModelOptions, ModelSource};
use serde_json::{Value, json};

use super::{
    cli_support::Workplace,
    gltf_builder::{Buffer, glb, square},
};

pub fn load(document: &Value, buffer: &Buffer, options: &ModelOptions) -> Model {
    let folder = Workplace::new();
    let path = folder.path("model.glb");
    std::fs::write(&path, glb(document, &buffer.bytes)).unwrap();
    load_with(&ModelSource::File(path), options).expect("loads")
}

pub fn load_plain(document: &Value, buffer: &Buffer) -> Model {
    load(document, buffer, &ModelOptions::default())
}

pub fn says(model: &Model, fate: Fate, words: &str) {
    let found = model.report.of(fate).any(|entry| entry.what.contains(words));
    assert!(found, "nothing {} says {words}: {:?}", fate.label(), model.report);
}

/// The sheet, compressed by Draco's encoder with its usual options: positions of 11 bits.
const DRACO_SHEET: &[u8] = include_bytes!("sheet.drc");

/// A wavy sheet of 16 × 16 vertices.
fn sheet() -> (Vec<[f32; 3]>, Vec<u16>) {
    let place = |i: usize| {
        let (x, y) = ((i % 16) as f32, (i / 16) as f32);
        [x, y, (0.7 * x).sin() + (0.4 * y).cos()]
    };
    let corners = |i: u16| {
        let first = 16 * (i / 15) + i % 15;
        [first, first + 1, first + 17, first, first + 17, first + 16]
    };
    ((0..256).map(place).collect(), (0..225).flat_map(corners).collect())
}

/// The sheet as a file without compression has it.
fn plain_sheet() -> Model {
    let (positions, indices) = sheet();
    let mut buffer = Buffer::default();
    let (positions, indices) = (buffer.floats(&positions), buffer.indices(&indices));
    let primitive = json!({"attributes": {"POSITION": positions}, "indices": indices});
    load_plain(&buffer.document(json!([primitive])), &buffer)
}

/// The corners of all triangles in an order that does not depend on that of vertices and triangles.
fn corners(model: &Model) -> Vec<[i64; 3]> {
    let mut corners: Vec<[i64; 3]> = (0..model.mesh.triangles.len())
        .map(|triangle| {
            let sum: DVec3 = model.mesh.corners(triangle).into_iter().sum();
            (sum * 100.0).round().to_array().map(|x| x as i64)
        })
        .collect();
    corners.sort_unstable();
    corners
}

#[test]
fn draco_meshes_are_those_that_were_compressed() {
    let plain = plain_sheet();
    let mut buffer = Buffer::default();
    let view = buffer.view(DRACO_SHEET);
    buffer.accessors.push(json!({
        "componentType": 5126, "count": 256, "type": "VEC3", "min": [0, 0, -2], "max": [15, 15, 2],
    }));
    buffer
        .accessors
        .push(json!({"componentType": 5125, "count": 1350, "type": "SCALAR"}));
    let extension = json!({"bufferView": view, "attributes": {"POSITION": 0}});
    let mut document = buffer.document(json!([{
        "attributes": {"POSITION": 0}, "indices": 1, "extensions": {"KHR_draco_mesh_compression": extension},
    }]));
    document["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    let draco = load_plain(&document, &buffer);
    assert_eq!(draco.mesh.triangles.len(), 450);
    // 11 bits for a width of 15: each coordinate of a sum of three is off by at most 3 · 15 / 2^12.
    for (found, expected) in corners(&draco).iter().zip(corners(&plain)) {
        let distance = (0..3).map(|i| (found[i] - expected[i]).abs()).max().unwrap();
        assert!(distance <= 3, "{found:?} instead of {expected:?}");
    }
    assert!(draco.report.is_clean(), "{:?}", draco.report);

    // A stream cut short is left out, and blamed.
    document["bufferViews"][view]["byteLength"] = json!(DRACO_SHEET.len() / 2);
    let error = Workplace::new()
        .load_glb(&document, &buffer)
        .expect_err("no triangles left")
        .to_string();
    assert!(error.contains("Draco"), "{error}");
}

/// Vertices in meshoptimizer's format, version 0, nothing of them predicted away: `vertexcodec.cpp`.
fn meshopt_vertices(bytes: &[u8], stride: usize) -> Vec<u8> {
    let mut encoded = vec![0xa0];
    let mut last = bytes[..stride].to_vec();
    let block = (8192 / stride / 16 * 16).min(256);
    for block in bytes.chunks(block * stride) {
        for k in 0..stride {
            let mut deltas: Vec<u8> = Vec::new();
            for vertex in block.chunks(stride) {
                let delta = vertex[k].wrapping_sub(last[k]);
                deltas.push((delta << 1) ^ ((delta as i8) >> 7) as u8);
                last[k] = vertex[k];
            }
            deltas.resize(deltas.len().next_multiple_of(16), 0);
            // Two bits a group: 3 for eight bits a byte.
            encoded.extend(vec![0xff; (deltas.len() / 16).div_ceil(4)]);
            encoded.extend(deltas);
        }
    }
    encoded.extend(vec![0; 32_usize.saturating_sub(stride)]);
    encoded.extend(&bytes[..stride]);
    encoded
}

/// Indices in meshoptimizer's sequence format, version 1, against one baseline: `indexcodec.cpp`.
fn meshopt_sequence(indices: &[u16]) -> Vec<u8> {
    let mut encoded = vec![0xd1];
    let mut last = 0_u32;
    for index in indices.iter().map(|index| u32::from(*index)) {
        let delta = index.wrapping_sub(last);
        let mut value = ((delta << 1) ^ ((delta as i32) >> 31) as u32) << 1;
        while value > 127 {
            encoded.push((value & 127) as u8 | 128);
            value >>= 7;
        }
        encoded.push(value as u8);
        last = index;
    }
    encoded.extend([0; 4]);
    encoded
}

#[test]
fn meshopt_meshes_are_those_that_were_compressed() {
    let (positions, indices) = sheet();
    let plain = plain_sheet();
    let bytes: Vec<u8> = positions.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    for extension in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
        let mut buffer = Buffer::default();
        let streams = [meshopt_vertices(&bytes, 12), meshopt_sequence(&indices)];
        let views = streams.each_ref().map(|stream| buffer.view(stream));
        let source = |view: usize, count: usize, stride: usize, mode: &str| {
            json!({extension: {
                "buffer": 0, "byteOffset": buffer.views[view]["byteOffset"], "byteLength": streams[view].len(),
                "byteStride": stride, "count": count, "mode": mode,
            }})
        };
        let mut document = buffer.document(json!([{"attributes": {"POSITION": 0}, "indices": 1}]));
        document["buffers"] = json!([
            {"byteLength": buffer.bytes.len()},
            {"byteLength": 6000, "extensions": {extension: {"fallback": true}}},
        ]);
        document["bufferViews"] = json!([
            {"buffer": 1, "byteLength": 3072, "byteStride": 12, "extensions": source(views[0], 256, 12, "ATTRIBUTES")},
            {"buffer": 1, "byteOffset": 3072, "byteLength": 2700, "extensions": source(views[1], 1350, 2, "INDICES")},
        ]);
        document["accessors"] = json!([
            {"bufferView": 0, "componentType": 5126, "count": 256, "type": "VEC3", "min": [0, 0, -2], "max": [15, 15, 2]},
            {"bufferView": 1, "componentType": 5123, "count": 1350, "type": "SCALAR"},
        ]);
        document["extensionsRequired"] = json!([extension]);
        document["extensionsUsed"] = json!([extension]);
        let model = load_plain(&document, &buffer);
        assert_eq!(model.mesh, plain.mesh, "{extension}");
        assert!(model.report.is_clean(), "{:?}", model.report);
        // No memory is asked for that so few bytes cannot fill.
        document["bufferViews"][0]["extensions"][extension]["count"] = json!(1u64 << 40);
        let refused = Workplace::new().load_glb(&document, &buffer).expect_err("it can't be");
        assert!(refused.to_string().contains("cannot hold"), "{refused}");
    }
}

/// A square with a morph target that lifts it, on two joints of which an animation turns the second.
fn puppet() -> (Buffer, Value) {
    let (mut buffer, _) = square();
    let lift = buffer.floats(&[[0.0, 0.0, 2.0]; 4]);
    let joints = buffer.view(&[0u8, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]);
    buffer
        .accessors
        .push(json!({"bufferView": joints, "componentType": 5121, "count": 4, "type": "VEC4"}));
    let joints = buffer.accessors.len() - 1;
    let weights = buffer.floats(&[[1.0f32, 0.0, 0.0, 0.0]; 4]);
    let times = buffer.floats(&[[1.0], [3.0]]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turns = buffer.floats(&[[0.0, 0.0, 0.0, 1.0], [0.0, half, 0.0, half]]);
    let moves = buffer.floats(&[[0.0, 0.0, 0.0], [0.0, 10.0, 0.0]]);
    let mixes = buffer.floats(&[[0.0], [1.0]]);
    // Each key between its tangents, per second.
    let curve = buffer.floats(&[0.0, 0.0, 2.0, 4.0, 8.0, 0.0].map(|y| [0.0, y, 0.0]));
    let mut document = buffer.document(json!([{
        "attributes": {"POSITION": 0, "NORMAL": 1, "JOINTS_0": joints, "WEIGHTS_0": weights}, "indices": 3,
        "targets": [{"POSITION": lift}],
    }]));
    document["meshes"][0]["weights"] = json!([0.5]);
    document["nodes"] = json!([
        {"mesh": 0, "skin": 0, "translation": [99, 99, 99]}, {"children": [2]}, {"name": "Arm"},
    ]);
    document["scenes"] = json!([{"nodes": [0, 1]}]);
    document["skins"] = json!([{"joints": [1, 2]}]);
    document["animations"] = json!([{
        "samplers": [
            {"input": times, "output": turns}, {"input": times, "output": moves, "interpolation": "STEP"},
            {"input": times, "output": mixes}, {"input": times, "output": curve, "interpolation": "CUBICSPLINE"},
        ],
        "channels": [
            {"sampler": 0, "target": {"node": 2, "path": "rotation"}},
            {"sampler": 1, "target": {"node": 2, "path": "translation"}},
            {"sampler": 2, "target": {"node": 0, "path": "weights"}},
            {"sampler": 3, "target": {"node": 1, "path": "translation"}},
        ],
    }]);
    (buffer, document)
}

#[test]
fn skins_and_morph_targets_follow_the_pose() {
    let (buffer, document) = puppet();
    let at = |time_s: Option<f32>| {
        let options = ModelOptions {
            time_s,
            ..ModelOptions::default()
        };
        load(&document, &buffer, &options)
    };
    let near = |found: DVec3, expected: [f64; 3]| {
        assert!(
            found.distance(DVec3::from_array(expected)) < 1e-6,
            "{found} is not {expected:?}"
        );
    };
    let rest = at(None);
    // Skinned meshes stand where their joints are, not where their node is.
    near(rest.mesh.positions[1], [1.0, 0.0, 1.0]);
    near(rest.mesh.positions[2], [1.0, 1.0, 1.0]);
    assert_eq!(rest.duration_s, 3.0);
    // Before the first key, between both, after the last.
    near(at(Some(0.0)).mesh.positions[2], [1.0, 1.0, 0.0]);
    let middle = at(Some(2.0)).mesh;
    let diagonal = std::f64::consts::FRAC_1_SQRT_2;
    near(middle.positions[1], [1.0, 3.5, 1.0]);
    near(middle.positions[2], [2.0 * diagonal, 4.5, 0.0]);
    near(middle.normals[2].as_dvec3(), [diagonal, 0.0, diagonal]);
    near(at(Some(9.0)).mesh.positions[2], [2.0, 19.0, -1.0]);
    assert!(rest.report.is_clean(), "{:?}", rest.report);
}

#[test]
fn scenes_and_variants_can_be_chosen() {
    let (buffer, mut document) = square();
    document["materials"] = json!([{"name": "Red"}, {"name": "Blue"}]);
    let primitive = &mut document["meshes"][0]["primitives"][0];
    primitive["material"] = json!(0);
    let mapping = json!([{"material": 1, "variants": [1]}, {"material": 0, "variants": [0]}]);
    primitive["extensions"] = json!({"KHR_materials_variants": {"mappings": mapping}});
    document["extensions"] = json!({"KHR_materials_variants": {"variants": [{"name": "day"}, {"name": "night"}]}});
    document["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "translation": [50, 0, 0]}]);
    document["scenes"] = json!([{"nodes": [0], "name": "here"}, {"nodes": [0, 1]}]);
    let of = |variant: Option<&str>, scene| {
        let options = ModelOptions {
            scene,
            variant: variant.map(str::to_owned),
            ..ModelOptions::default()
        };
        load(&document, &buffer, &options)
    };
    let plain = of(None, None);
    assert_eq!((plain.slots[0].name.as_str(), plain.mesh.triangles.len()), ("Red", 2));
    assert_eq!(
        (plain.variants.join(" "), plain.scenes.join(" ")),
        ("day night".into(), "here scene 1".into())
    );
    assert_eq!(of(Some("night"), None).slots[0].name, "Blue");
    assert_eq!(of(None, Some(1)).mesh.triangles.len(), 4);
    let unknown = of(Some("dusk"), None);
    assert_eq!(unknown.slots[0].name, "Red");
    assert!(
        unknown
            .report
            .of(Fate::Missing)
            .any(|entry| entry.what.contains("dusk")),
        "{:?}",
        unknown.report
    );
}
