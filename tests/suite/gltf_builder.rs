//! Small glTF files for tests.

use glossmith::{
    import::{ModelError, load},
    scene::{Model, ModelSource, mesh::Mesh},
};
use serde_json::{Value, json};

use crate::cli_support::Workplace;

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

    /// The primitive of a mesh, with its normals and coordinates.
    pub fn mesh(&mut self, mesh: &Mesh) -> Value {
        let places: Vec<[f32; 3]> = mesh.positions.iter().map(|place| place.as_vec3().to_array()).collect();
        let normals: Vec<[f32; 3]> = mesh.normals.iter().map(|normal| normal.to_array()).collect();
        let uvs: Vec<[f32; 2]> = mesh.uvs.iter().map(|uv| uv.to_array()).collect();
        let corners: Vec<u16> = mesh.triangles.iter().flatten().map(|&vertex| vertex as u16).collect();
        let attributes = json!({
            "POSITION": self.floats(&places), "NORMAL": self.floats(&normals), "TEXCOORD_0": self.floats(&uvs),
        });
        json!({"attributes": attributes, "indices": self.indices(&corners)})
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

impl Workplace {
    pub fn load(&self, name: &str, bytes: &[u8]) -> Result<Model, ModelError> {
        self.write(name, bytes);
        load(&self.model(name))
    }
    pub fn model(&self, name: &str) -> ModelSource {
        ModelSource::File(self.path(name))
    }
    pub fn glb(&self, name: &str, document: &Value, buffer: &Buffer) -> ModelSource {
        self.write(name, glb(document, &buffer.bytes));
        self.model(name)
    }
    pub fn load_glb(&self, document: &Value, buffer: &Buffer) -> Result<Model, ModelError> {
        load(&self.glb("model.glb", document, buffer))
    }
}

/// A picture of two texels.
pub fn png() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let picture = image::RgbaImage::from_fn(2, 1, |x, _| image::Rgba([10, 20, 30, if x == 0 { 255 } else { 128 }]));
    picture.write_to(&mut bytes, image::ImageFormat::Png).expect("encodes");
    bytes.into_inner()
}

/// A square with this material, and a picture within the file as texture 0.
pub fn pictured(material: Value, png: &[u8]) -> (Buffer, Value) {
    let (mut buffer, document) = square();
    let view = buffer.view(png);
    let mut file = buffer.document(document["meshes"][0]["primitives"].clone());
    file["meshes"][0]["primitives"][0]["material"] = json!(0);
    file["materials"] = json!([material]);
    file["images"] = json!([{"bufferView": view, "mimeType": "image/png"}]);
    file["textures"] = json!([{"source": 0}]);
    (buffer, file)
}

/// Puts a value where a pointer says, making the objects on the way.
pub fn put(document: &mut Value, place: &str, value: Value) {
    let keys = place.trim_start_matches('/').split('/');
    *keys.fold(document, |at, key| match key.parse::<usize>() {
        Ok(index) if at.is_array() => &mut at[index],
        _ => &mut at[key],
    }) = value;
}
