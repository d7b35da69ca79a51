//! STL files, of text or bytes, by the stl_io crate. They have triangles and nothing else.

use std::io::Cursor;
use std::path::Path;

use glam::{DVec3, Vec2, Vec3, Vec4};

use super::mesh::Mesh;
use super::model::{Model, ModelError, Slot};
use super::report::{Fate, ImportReport};

/// Loads the contents of an STL file. Its Z is upwards, as in most programs that write them: it is turned to our +Y.
pub(super) fn load(path: &Path, bytes: &[u8]) -> Result<Model, ModelError> {
    let invalid = |error: std::io::Error| ModelError::Invalid {
        path: path.to_owned(),
        reason: error.to_string(),
    };
    let read = stl_io::read_stl(&mut Cursor::new(bytes)).map_err(invalid)?;
    let triangles: Vec<[u32; 3]> = read
        .faces
        .iter()
        .map(|face| face.vertices.map(|vertex| vertex as u32))
        .collect();
    let count = read.vertices.len();
    let place = |vertex: &stl_io::Vertex| {
        let [x, y, z] = vertex.0.map(f64::from);
        DVec3::new(x, z, -y)
    };
    let mut mesh = Mesh {
        positions: read.vertices.iter().map(place).collect(),
        normals: vec![Vec3::Y; count],
        uvs: vec![Vec2::ZERO; count],
        tangents: vec![Vec4::W; count],
        slots: vec![0; triangles.len()],
        triangles,
        ..Mesh::default()
    };
    mesh.flatten();
    mesh.make_tangents([1.0, 0.0, 0.0, 0.0, 1.0, 0.0], false);
    let mut report = ImportReport::default();
    report.note(Fate::Used, "meshes", "");
    Ok(Model {
        mesh,
        slots: vec![Slot::neutral("default")],
        report,
        ..Model::default()
    })
}
