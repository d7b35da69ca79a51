//! Small glTF files of hard geometry, to test the whole way from file to image.

use glam::Vec4;
use serde_json::{Value, json};

use super::{Stage, StudyError};
use crate::scene::{ModelSource, mesh::Mesh};

/// A file in the making.
#[derive(Default)]
pub struct Glb {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
}

impl Glb {
    /// A file with one mesh at one node.
    pub fn of(mesh: &Mesh, node: Value) -> Self {
        let mut glb = Self::default();
        let index = glb.mesh(mesh);
        glb.node(index, node);
        glb
    }

    pub fn mesh(&mut self, mesh: &Mesh) -> usize {
        let positions: Vec<[f32; 3]> = mesh.positions.iter().map(|p| p.as_vec3().to_array()).collect();
        let end =
            |pick: fn(f32, f32) -> f32| [0, 1, 2].map(|i| positions.iter().map(|p| p[i]).fold(positions[0][i], pick));
        let [low, high] = [end(f32::min), end(f32::max)];
        let vectors = json!({"componentType": 5126, "type": "VEC3", "min": low, "max": high});
        let position = self.accessor(&positions, vectors);
        let normals = json!({"componentType": 5126, "type": "VEC3"});
        let normal = self.accessor(&mesh.normals, normals);
        let indices = self.accessor(
            mesh.triangles.as_flattened(),
            json!({"componentType": 5125, "type": "SCALAR"}),
        );
        let attributes = json!({"POSITION": position, "NORMAL": normal});
        self.meshes
            .push(json!({"primitives": [{"attributes": attributes, "indices": indices}]}));
        self.meshes.len() - 1
    }

    pub fn tangents(&mut self, mesh: usize, tangents: &[Vec4]) {
        let accessor = self.accessor(tangents, json!({"componentType": 5126, "type": "VEC4"}));
        self.meshes[mesh]["primitives"][0]["attributes"]["TANGENT"] = json!(accessor);
    }

    /// Adds a node of a mesh; `transform` has glTF's own `scale`, `translation` and so on.
    pub fn node(&mut self, mesh: usize, mut transform: Value) {
        transform["mesh"] = json!(mesh);
        self.nodes.push(transform);
    }

    pub fn write(self, stage: &Stage, name: &str) -> Result<ModelSource, StudyError> {
        let roots: Vec<usize> = (0..self.nodes.len()).collect();
        let document = json!({
            "asset": {"version": "2.0"},
            "scene": 0, "scenes": [{"nodes": roots}], "nodes": self.nodes, "meshes": self.meshes,
            "buffers": [{"byteLength": self.bytes.len()}],
            "bufferViews": self.views, "accessors": self.accessors,
        });
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut bytes = b"glTF".to_vec();
        let length = 12 + 8 + text.len() + 8 + self.bytes.len();
        for number in [2, length as u32, text.len() as u32] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(b"JSON");
        bytes.extend(text);
        bytes.extend((self.bytes.len() as u32).to_le_bytes());
        bytes.extend(b"BIN\0");
        bytes.extend(self.bytes);
        Ok(ModelSource::File(stage.write(name, &bytes)?))
    }

    /// Appends numbers, which are little-endian on every machine that this runs on.
    fn accessor<T: bytemuck::Pod>(&mut self, items: &[T], mut accessor: Value) -> usize {
        let bytes: &[u8] = bytemuck::cast_slice(items);
        accessor["bufferView"] = json!(self.views.len());
        accessor["count"] = json!(items.len());
        self.accessors.push(accessor);
        self.views
            .push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()}));
        self.bytes.extend(bytes);
        self.accessors.len() - 1
    }
}
