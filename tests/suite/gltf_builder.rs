//! Small glTF files for tests.

use std::fs;
use std::path::PathBuf;

use glossmith::import::{ModelError, load};
use glossmith::scene::mesh::Mesh;
use glossmith::scene::{Model, ModelSource};
use serde_json::{Value, json};
use tempfile::TempDir;

/// A GLB of JSON and a binary chunk.
pub fn glb(json: &Value, binary: &[u8]) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut binary = binary.to_vec();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let mut bytes = b"glTF".to_vec();
    let length = 12 + 8 + text.len() + 8 + binary.len();
    for number in [2, length as u32, text.len() as u32] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend(b"JSON");
    bytes.extend(text);
    bytes.extend((binary.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(binary);
    bytes
}

/// Collects the binary chunk and the accessors into it.
#[derive(Default)]
pub struct Buffer {
    pub bytes: Vec<u8>,
    pub views: Vec<Value>,
    pub accessors: Vec<Value>,
}

impl Buffer {
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.views
            .push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()}));
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    pub fn floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
        let view = self.view(&bytes);
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        let mut accessor = json!({"bufferView": view, "componentType": 5126, "count": values.len(), "type": kind});
        if N == 3 {
            let edge = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
                (0..N)
                    .map(|i| values.iter().map(|value| value[i]).reduce(pick).unwrap_or_default())
                    .collect()
            };
            (accessor["min"], accessor["max"]) = (json!(edge(f32::min)), json!(edge(f32::max)));
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    pub fn indices(&mut self, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let view = self.view(&bytes);
        self.accessors
            .push(json!({"bufferView": view, "componentType": 5123, "count": values.len(), "type": "SCALAR"}));
        self.accessors.len() - 1
    }

    /// A document of these accessors with one node for the primitives.
    pub fn document(&self, primitives: Value) -> Value {
        json!({
            "asset": {"version": "2.0"},
            "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"name": "Part", "primitives": primitives}],
            "buffers": [{"byteLength": self.bytes.len()}],
            "bufferViews": self.views, "accessors": self.accessors,
        })
    }
}

pub const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

/// An indexed square with normals and texture coordinates.
pub fn square() -> (Buffer, Value) {
    let mut buffer = Buffer::default();
    let positions = buffer.floats(&SQUARE);
    let normals = buffer.floats(&[[0.0, 0.0, 1.0]; 4]);
    let uvs = buffer.floats(&[[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
    let indices = buffer.indices(&[0, 1, 2, 0, 2, 3]);
    let attributes = json!({"POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uvs});
    let document = buffer.document(json!([{"attributes": attributes, "indices": indices}]));
    (buffer, document)
}

pub struct Folder(pub TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(TempDir::new().expect("a temporary folder"))
    }
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    pub fn load(&self, name: &str, bytes: &[u8]) -> Result<Model, ModelError> {
        let path = self.path(name);
        fs::write(&path, bytes).expect("write a test file");
        load(&ModelSource::File(path))
    }
    pub fn load_glb(&self, document: &Value, buffer: &Buffer) -> Result<Model, ModelError> {
        self.load("model.glb", &glb(document, &buffer.bytes))
    }
}

/// A strip of two squares, the texture of the right one mirrored about their common edge: what it lies in, and the primitive.
pub fn mirrored_squares() -> (Buffer, Value) {
    let mut buffer = Buffer::default();
    let positions: Vec<[f32; 3]> = (0..6).map(|i| [(i % 3) as f32, (i / 3) as f32, 0.0]).collect();
    let uvs: Vec<[f32; 2]> = (0..6).map(|i| [[0.0, 1.0, 0.0][i % 3], 1.0 - (i / 3) as f32]).collect();
    let (positions, uvs) = (buffer.floats(&positions), buffer.floats(&uvs));
    let normals = buffer.floats(&[[0.0, 0.0, 1.0]; 6]);
    let indices = buffer.indices(&[0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4]);
    let attributes = json!({"POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uvs});
    (buffer, json!({"attributes": attributes, "indices": indices}))
}

/// Whether the tangents of those squares follow their textures, and the common edge is split for it.
pub fn assert_mirrored_tangents(mesh: &Mesh) {
    assert_eq!(
        mesh.positions.len(),
        8,
        "the two vertices of the common edge are there twice"
    );
    for triangle in 0..4 {
        let sign = if triangle < 2 { 1.0 } else { -1.0 };
        for vertex in mesh.triangles[triangle] {
            let tangent = mesh.tangents[vertex as usize];
            assert_eq!(tangent.to_array(), [sign, 0.0, 0.0, sign], "triangle {triangle}");
        }
    }
}

/// A picture of two texels.
pub fn png() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let picture = image::RgbaImage::from_fn(2, 1, |x, _| image::Rgba([10, 20, 30, if x == 0 { 255 } else { 128 }]));
    picture.write_to(&mut bytes, image::ImageFormat::Png).expect("encodes");
    bytes.into_inner()
}
