//! What is read from glTF files.

use std::fs;

use glam::{DVec3, Vec2, Vec3};
use glossmith::scene::{AlphaMode, Fate, Wrap, texture::TextureTarget};
use serde_json::{Value, json};

use super::gltf_extensions::load_plain;
use super::{
    cli_support::Workplace,
    gltf_builder::{Buffer, SQUARE, glb, png, square},
};

#[test]
fn a_square_is_read_as_it_is() {
    let (buffer, document) = square();
    let model = load_plain(&document, &buffer);
    assert_eq!((model.name.as_str(), model.mesh.triangles.len()), ("model", 2));
    assert_eq!(model.mesh.positions[2], DVec3::new(1.0, 1.0, 0.0));
    assert_eq!(model.mesh.uvs[2], Vec2::new(1.0, 0.0));
    // u grows along +X, v against +Y: nothing is mirrored.
    assert!(model.mesh.normals.iter().all(|normal| *normal == Vec3::Z));
    assert!(
        model
            .mesh
            .tangents
            .iter()
            .all(|tangent| *tangent == Vec3::X.extend(1.0)),
        "{:?}",
        model.mesh.tangents
    );
    assert_eq!(
        (
            model.slots.len(),
            model.slots[0].number("base.metalness"),
            model.slots[0].number("specular.roughness")
        ),
        (1, 0.0, 0.5)
    );
    assert!(model.report.is_clean(), "{:?}", model.report);
}

#[test]
fn nodes_move_turn_mirror_and_nest() {
    let (buffer, mut document) = square();
    // A quarter turn about +Y takes +Z to +X; below it a mirror in x and a shear-like scale in z.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    document["nodes"] = json!([
        {"children": [1, 2], "rotation": [0.0, half, 0.0, half], "translation": [10.0, 0.0, 0.0]},
        {"mesh": 0},
        {"mesh": 0, "matrix": [-2.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 5.0, 0.0, 1.0]},
    ]);
    let mesh = load_plain(&document, &buffer).mesh;
    assert_eq!(mesh.triangles.len(), 4);
    let near = |a: DVec3, b: DVec3| assert!(a.distance(b) < 1e-6, "{a} is not {b}");
    near(mesh.positions[1], DVec3::new(10.0, 0.0, -1.0));
    near(mesh.positions[5], DVec3::new(10.0, 5.0, 2.0));
    for (triangle, vertices) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = mesh.corners(triangle);
        let normal = (b - a).cross(c - a).normalize();
        near(normal, DVec3::X);
        for vertex in vertices {
            near(mesh.normals[*vertex as usize].as_dvec3(), DVec3::X);
        }
    }
    assert_eq!(
        (mesh.tangents[0].w, mesh.tangents[4].w),
        (1.0, -1.0),
        "a mirror turns the bitangent"
    );
}

#[test]
fn flattening_and_shearing_nodes_keep_normals() {
    let (buffer, mut document) = square();
    for (scale, expected) in [
        ([1.0, 1.0, 0.0], Vec3::Z),
        ([1e-20, 1e-20, 1e-20], Vec3::Z),
        // What is a point has no normal.
        ([0.0, 0.0, 0.0], Vec3::ZERO),
    ] {
        document["nodes"] = json!([{"mesh": 0, "scale": scale}]);
        let mesh = load_plain(&document, &buffer).mesh;
        assert!(
            mesh.normals.iter().all(|normal| normal.distance(expected) < 1e-6),
            "{scale:?}: {:?}",
            mesh.normals
        );
    }
    // x += y: the square's plane stays, a slanted plane's normal follows the inverse transpose.
    let mut slanted = Buffer::default();
    let positions = slanted.floats(&[[0.0, 0.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 1.0, 0.0]]);
    let normals = slanted.floats(&[[0.5_f32.sqrt(), 0.5_f32.sqrt(), 0.0]; 3]);
    let mut document = slanted.document(json!([{"attributes": {"POSITION": positions, "NORMAL": normals}}]));
    document["nodes"] = json!([{"mesh": 0, "matrix": [1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}]);
    let mesh = load_plain(&document, &slanted).mesh;
    let [a, b, c] = mesh.corners(0);
    let expected = (b - a).cross(c - a).normalize().as_vec3();
    assert!(
        mesh.normals.iter().all(|normal| normal.distance(expected) < 1e-6),
        "{:?} {expected}",
        mesh.normals
    );
}

#[test]
fn lists_strips_and_fans_without_normals_are_flat() {
    for (mode, order, expected) in [
        (4, vec![0u16, 1, 2, 0, 2, 3, 0], 2),
        (5, vec![0, 1, 3, 2], 2),
        (6, vec![0, 1, 2, 3], 2),
    ] {
        let mut buffer = Buffer::default();
        let positions = buffer.floats(&SQUARE);
        let indices = buffer.indices(&order);
        let primitive = json!({"attributes": {"POSITION": positions}, "indices": indices, "mode": mode});
        let mesh = load_plain(&buffer.document(json!([primitive])), &buffer).mesh;
        assert_eq!(
            (mesh.triangles.len(), mesh.positions.len()),
            (expected, 4),
            "mode {mode}"
        );
        assert!(
            mesh.normals.iter().all(|normal| *normal == Vec3::ZERO),
            "mode {mode}: {:?}",
            mesh.normals
        );
        let area: f64 = (0..expected)
            .map(|t| mesh.corners(t))
            .map(|[a, b, c]| (b - a).cross(c - a).z / 2.0)
            .sum();
        near!(area, 1.0, 1e-12, "mode {mode}");
    }
}

#[test]
fn sparse_interleaved_and_quantised_accessors_are_read() {
    let mut buffer = Buffer::default();
    // Signed bytes with a stride of 4, normalised: 127 is 1.
    let view = buffer.view(&[0u8, 0, 0, 99, 127, 0, 0, 99, 127, 127, 0, 99, 0, 127, 0, 99]);
    buffer.views[view]["byteStride"] = json!(4);
    let places = buffer.view(&[2]);
    let values = buffer.view(&[127u8, 129, 127]);
    buffer.accessors.push(json!({
        "bufferView": view, "componentType": 5120, "normalized": true, "count": 4, "type": "VEC3",
        "min": [0, -1, 0], "max": [1, 1, 1],
        "sparse": {"count": 1, "indices": {"bufferView": places, "componentType": 5121}, "values": {"bufferView": values}},
    }));
    let mut document = buffer.document(json!([{"attributes": {"POSITION": 0}, "mode": 6}]));
    document["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    document["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    let mesh = load_plain(&document, &buffer).mesh;
    let [a, b, c] = mesh.corners(0);
    assert_eq!([a, b, c], [DVec3::X, DVec3::new(1.0, -1.0, 1.0), DVec3::ZERO]);
}

#[test]
fn materials_and_textures_become_slots() {
    let (mut buffer, _) = square();
    let picture = buffer.view(&png());
    let primitive = |material: Value| {
        let mut primitive = json!({"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3});
        if material != Value::Null {
            primitive["material"] = material;
        }
        primitive
    };
    let mut document = buffer.document(json!([
        primitive(json!(1)),
        primitive(Value::Null),
        primitive(json!(1))
    ]));
    document["images"] = json!([{"bufferView": picture, "mimeType": "image/png", "name": "two texels"}]);
    document["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648}]);
    document["textures"] = json!([{"source": 0, "sampler": 0}, {"source": 0}]);
    let turn = json!({"KHR_texture_transform": {"rotation": 0.5, "scale": [2.0, 3.0], "offset": [0.25, 0.5]}});
    document["materials"] = json!([{"name": "unused"}, {
        "name": "Lamp", "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": true,
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 0.25, 1.0, 0.75], "metallicFactor": 0.125, "roughnessFactor": 0.375,
            "baseColorTexture": {"index": 0},
        },
        "normalTexture": {"index": 1, "scale": 0.5, "extensions": turn},
        "emissiveFactor": [1.0, 0.5, 0.0],
        "extensions": {
            "KHR_materials_emissive_strength": {"emissiveStrength": 20.0},
            "KHR_materials_ior": {"ior": 1.75}, "KHR_materials_transmission": {"transmissionFactor": 0.875},
            "KHR_materials_volume": {
                "thicknessFactor": 1.0, "attenuationDistance": 3.0, "attenuationColor": [0.25, 0.5, 0.75],
            },
        },
    }]);
    let model = load_plain(&document, &buffer);
    assert_eq!(model.mesh.slots, [0, 0, 1, 1, 0, 0]);
    let [lamp, default] = &model.slots[..] else {
        panic!("two slots, not {}", model.slots.len())
    };
    assert_eq!((lamp.name.as_str(), default.name.as_str()), ("Lamp", "Clay"));
    assert_eq!(
        (
            lamp.color("base.color"),
            lamp.number("base.metalness"),
            lamp.number("specular.roughness")
        ),
        ([0.5, 0.25, 1.0], 0.125, 0.375)
    );
    assert_eq!(
        (lamp.number("geometry.opacity"), lamp.alpha_mode, lamp.alpha_cutoff),
        (0.75, AlphaMode::Mask, 0.25)
    );
    assert_eq!(
        (
            lamp.color("emission.color")
                .map(|x| x * lamp.number("emission.strength")),
            lamp.number("specular.ior"),
            lamp.number("transmission.weight")
        ),
        ([20.0, 10.0, 0.0], 1.75, 0.875)
    );
    // In bounding radii: the square of side 1 has one of half its diagonal.
    let distance = 3.0 / std::f32::consts::FRAC_1_SQRT_2;
    near!(lamp.number("transmission.depth"), distance, 1e-5);
    assert_eq!(lamp.color("transmission.color"), [0.25, 0.5, 0.75]);
    assert_eq!(default.number("transmission.depth"), 0.0);
    assert_eq!(model.report.lines().len(), 1, "{:?}", model.report);
    assert!(lamp.double_sided && !default.double_sided);
    let color = lamp.texture(TextureTarget::BaseColor).expect("a colour texture");
    assert_eq!(
        (color.wrap, color.texture_from_mesh_uv),
        (
            [Wrap::ClampToEdge, Wrap::MirroredRepeat],
            [1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
        )
    );
    let normal = lamp.texture(TextureTarget::Normal).expect("a normal texture");
    let (sin, cos) = 0.5f32.sin_cos();
    let expected = [2.0 * cos, 3.0 * sin, 0.25, -2.0 * sin, 3.0 * cos, 0.5];
    assert_eq!(
        (
            normal.wrap,
            normal.texture_from_mesh_uv,
            lamp.number("geometry.normal_strength")
        ),
        ([Wrap::Repeat; 2], expected, 0.5)
    );
    assert_eq!(
        (color.texture, normal.texture, model.textures.len()),
        (0, 0, 1),
        "one picture, used twice"
    );
    let texture = &model.textures[0];
    assert_eq!(
        (texture.name.as_str(), texture.width, texture.height),
        ("two texels", 2, 1)
    );
    assert_eq!(texture.rgba8, [10, 20, 30, 255, 10, 20, 30, 128]);
}

/// A byte order mark, NULs after the JSON, chunks of other kinds, bytes after the buffer.
#[test]
fn containers_are_read_as_programs_fill_them() {
    let folder = Workplace::new();
    let (buffer, document) = square();
    let whole = glb(&document, &buffer.bytes);
    let json = 20 + u32::from_le_bytes(whole[12..16].try_into().unwrap()) as usize;
    let mut chunk = 4_u32.to_le_bytes().to_vec();
    chunk.extend(b"XTRA1234");
    // The text with NULs for its blanks at the end, and the other chunk before or after the bytes.
    let filled = |bytes: &[u8]| {
        let mut text = document.to_string().into_bytes();
        text.extend(bytes);
        text
    };
    let packed = |text: &[u8], rest: &[&[u8]]| {
        let rest = rest.concat();
        let numbers = [2, (20 + text.len() + rest.len()) as u32, text.len() as u32].map(u32::to_le_bytes);
        [&b"glTF"[..], &numbers.concat()[..], b"JSON", text, &rest].concat()
    };
    let bytes = &whole[json..];
    for (name, contents) in [
        ("nul", packed(&filled(&[0; 3]), &[bytes])),
        ("before", packed(&filled(b""), &[&chunk, bytes])),
        ("after", packed(&filled(b" "), &[bytes, &chunk])),
        ("long", glb(&document, &[&buffer.bytes[..], &[0; 64]].concat())),
        (
            "mark",
            packed(&[&b"\xef\xbb\xbf"[..], &filled(b"")[..]].concat(), &[bytes]),
        ),
    ] {
        let model = folder.load(&format!("{name}.glb"), &contents).expect(name);
        assert!(
            model.mesh.triangles.len() == 2 && model.report.of(Fate::Missing).next().is_none(),
            "{name}"
        );
    }
}

/// Data URIs in both forms, with escapes; names whose case differs, of folders too.
#[test]
fn names_and_data_of_uris_are_read() {
    let folder = Workplace::new();
    fs::create_dir(folder.path("Textures")).unwrap();
    folder.write("Textures/A b.PNG", png());
    let escaped: String = png().iter().map(|byte| format!("%{byte:02x}")).collect();
    let base_64 =
        "iVBORw0KGgoAAAANSUhEUgAAAAkAAAAJCAIAAABv85FHAAAAFElEQVR4nGNsaGhgwAGYcEkMEzkAgOcBkj3eIxkAAAAASUVORK5CYII%3D";
    for uri in [
        format!("data:image/png,{escaped}"),
        format!("data:image/png;base64,{base_64}"),
        "textures/a%20B.png".to_owned(),
        "./TEXTURES\\A b.PNG".to_owned(),
    ] {
        let (buffer, mut document) = square();
        document["images"] = json!([{"uri": uri}]);
        document["textures"] = json!([{"source": 0}]);
        document["materials"] = json!([{"emissiveTexture": {"index": 0}}]);
        document["meshes"][0]["primitives"][0]["material"] = json!(0);
        let model = folder.load_glb(&document, &buffer).expect("loads");
        assert_eq!(model.textures.len(), 1, "{uri}: {:?}", model.report);
    }
}

#[test]
fn buffers_and_pictures_may_be_beside_the_file_or_in_its_text() {
    let folder = Workplace::new();
    let (buffer, mut document) = square();
    folder.write("my data.bin", &buffer.bytes);
    folder.write("picture.png", png());
    document["buffers"][0]["uri"] = json!("my%20data.bin");
    document["images"] = json!([{"uri": "picture.png"}]);
    document["textures"] = json!([{"source": 0}]);
    document["materials"] = json!([{"emissiveTexture": {"index": 0}}]);
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    let model = folder
        .load("beside.gltf", document.to_string().as_bytes())
        .expect("loads");
    assert_eq!(
        (model.mesh.triangles.len(), model.textures[0].name.as_str()),
        (2, "picture.png")
    );

    fs::remove_file(folder.path("picture.png")).expect("remove");
    let grey = folder
        .load("beside.gltf", document.to_string().as_bytes())
        .expect("a missing picture stops nothing");
    let missing: Vec<_> = grey.report.of(Fate::Missing).collect();
    assert_eq!(
        (missing.len(), missing[0].names[0].as_str()),
        (1, "picture.png"),
        "{missing:?}"
    );
}
