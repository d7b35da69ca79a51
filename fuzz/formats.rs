//! What becomes of a file's bytes, whatever they are: something that can be rendered, or an error. Both the fuzz targets
//! and the test suite call it.

use std::path::{Path, PathBuf};

use glossmith::{document::Document, import::load, scene::{environment::EnvironmentSource, Geometry, ModelSource}, store::{exchange::ReadOptions, exchange, load_document, load_material, opened},};

/// Kinds of files.
#[allow(dead_code)]
pub const FORMATS: [&str; 16] = [
    "glb", "fbx", "obj", "ply", "stl", "zip", "hdr", "exr", "png", "jpg", "tif", "ktx2", "dds", "material", "project", "mtlx",
];

/// Formats of pictures, which are textures as well as environments.
const PICTURES: [&str; 6] = ["exr", "png", "jpg", "tif", "ktx2", "dds"];

/// Reads a file of a kind. Panics where what comes out can't be rendered; that is the point of it.
pub fn try_file(format: &str, bytes: &[u8]) {
    let path = path(format);
    std::fs::write(&path, bytes).expect("a temporary folder that can be written to");
    try_path(format, &path);
    if PICTURES.contains(&format) {
        std::fs::write(&path, textured(bytes)).expect("a temporary folder that can be written to");
        try_path("glb", &path);
    }
    // Left where it panicked: that is the file to look at.
    std::fs::remove_file(&path).expect("a file that was just written");
}

/// A triangle in a GLB whose normals and roughness are in a picture.
fn textured(picture: &[u8]) -> Vec<u8> {
    let places = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mut binary: Vec<u8> = places.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let start = binary.len();
    binary.extend(picture);
    binary.resize(binary.len().next_multiple_of(4), 0);
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
        "materials":[{{"normalTexture":{{"index":0}},"pbrMetallicRoughness":{{"metallicRoughnessTexture":{{"index":0}}}}}}],
        "textures":[{{"source":0}}],"images":[{{"bufferView":1,"mimeType":"image/png"}}],
        "buffers":[{{"byteLength":{length}}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",
        "min":[0,0,0],"max":[1,1,0]}}],
        "bufferViews":[{{"buffer":0,"byteLength":{start}}},{{"buffer":0,"byteOffset":{start},"byteLength":{size}}}]}}"#,
        length = binary.len(),
        size = picture.len(),
    );
    let text = format!("{text:width$}", width = text.len().next_multiple_of(4));
    let mut bytes = b"glTF".to_vec();
    let number = |number: usize| (number as u32).to_le_bytes();
    bytes.extend([number(2), number(28 + text.len() + binary.len()), number(text.len())].concat());
    bytes.extend(b"JSON");
    bytes.extend(text.as_bytes());
    bytes.extend(number(binary.len()));
    bytes.extend(b"BIN\0");
    bytes.extend(binary);
    bytes
}

fn path(format: &str) -> PathBuf {
    let ending = match format {
        "material" | "project" => "json",
        other => other,
    };
    let thread = format!("{:?}", std::thread::current().id()).replace(['(', ')'], "");
    std::env::temp_dir().join(format!("glossmith-fuzz-{}-{thread}.{ending}", std::process::id()))
}

fn try_path(format: &str, path: &Path) {
    match format {
        "glb" | "fbx" | "obj" | "ply" | "stl" | "zip" => {
            if let Ok(model) = load(&ModelSource::File(path.to_owned())) {
                let geometry = Geometry::build(&model, true);
                let hit = geometry.intersect([0.3, 0.2, -2.0], [0.01, 0.02, 1.0], f32::INFINITY);
                assert!(hit.is_none_or(|hit| hit.t > 0.0));
            }
        }
        "hdr" | "exr" | "png" | "jpg" | "tif" | "ktx2" | "dds" => {
            if let Ok(map) = glossmith::import::environment::load(&EnvironmentSource::File(path.to_owned())) {
                assert!(map.texels.iter().flatten().all(|x| x.is_finite() && *x >= 0.0));
                let cells = &map.distribution(true).cells;
                assert!(cells.iter().all(|cell| cell.density.is_finite() && cell.density >= 0.0));
            }
        }
        "mtlx" => {
            let Ok(subject) = exchange::read(path, ReadOptions::default()) else {
                return;
            };
            for material in subject.materials {
                let document = Document {
                    materials: vec![material],
                    ..Document::default()
                };
                assert!(document.check().is_ok());
            }
        }
        _ => {
            let _ = opened::open(path);
            let _ = load_material(path);
            if let Ok(document) = load_document(path) {
                assert!(document.value.check().is_ok());
            }
        }
    }
}
