//! Small glTF files of hard geometry, to test the whole way from file to image.

use glam::{Vec3, Vec4};
use serde_json::{Value, json};

use super::stage::{HardError, Stage};
use crate::scene::ModelSource;
use crate::scene::mesh::Mesh;

/// A file in the making.
#[derive(Default)]
pub(super) struct Glb {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
}

impl Glb {
    /// A file with one mesh at one node.
    pub(super) fn of(mesh: &Mesh, node: Value) -> Self {
        let mut glb = Self::default();
        let index = glb.mesh(mesh, true);
        glb.node(index, node);
        glb
    }

    /// Adds a mesh, with or without its normals; no tangents and texture coordinates.
    pub(super) fn mesh(&mut self, mesh: &Mesh, with_normals: bool) -> usize {
        let positions: Vec<Vec3> = mesh.positions.iter().map(|p| p.as_vec3()).collect();
        let mut attributes = json!({"POSITION": self.vectors(&positions)});
        if with_normals {
            attributes["NORMAL"] = json!(self.vectors(&mesh.normals));
        }
        let indices: Vec<u8> = mesh
            .triangles
            .as_flattened()
            .iter()
            .flat_map(|vertex| vertex.to_le_bytes())
            .collect();
        let view = self.view(&indices);
        self.accessors.push(
            json!({"bufferView": view, "componentType": 5125, "count": 3 * mesh.triangles.len(), "type": "SCALAR"}),
        );
        let indices = self.accessors.len() - 1;
        self.meshes
            .push(json!({"primitives": [{"attributes": attributes, "indices": indices}]}));
        self.meshes.len() - 1
    }

    /// Adds tangents to a mesh, valid or not.
    pub(super) fn tangents(&mut self, mesh: usize, tangents: &[Vec4]) {
        let bytes: Vec<u8> = tangents
            .iter()
            .flat_map(|t| t.to_array())
            .flat_map(f32::to_le_bytes)
            .collect();
        let view = self.view(&bytes);
        self.accessors
            .push(json!({"bufferView": view, "componentType": 5126, "count": tangents.len(), "type": "VEC4"}));
        let accessor = self.accessors.len() - 1;
        self.meshes[mesh]["primitives"][0]["attributes"]["TANGENT"] = json!(accessor);
    }

    /// Adds a node of a mesh; `transform` has glTF's own `scale`, `translation` and so on.
    pub(super) fn node(&mut self, mesh: usize, mut transform: Value) {
        transform["mesh"] = json!(mesh);
        self.nodes.push(transform);
    }

    pub(super) fn write(self, stage: &Stage, name: &str) -> Result<ModelSource, HardError> {
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

    fn view(&mut self, bytes: &[u8]) -> usize {
        self.views
            .push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()}));
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    fn vectors(&mut self, vectors: &[Vec3]) -> usize {
        let bytes: Vec<u8> = vectors
            .iter()
            .flat_map(|v| v.to_array())
            .flat_map(f32::to_le_bytes)
            .collect();
        let view = self.view(&bytes);
        let [low, high] = [Vec3::min, Vec3::max].map(|pick| vectors.iter().copied().reduce(pick).unwrap_or_default());
        self.accessors.push(json!({
            "bufferView": view, "componentType": 5126, "count": vectors.len(), "type": "VEC3",
            "min": low.to_array(), "max": high.to_array(),
        }));
        self.accessors.len() - 1
    }
}
