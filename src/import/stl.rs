//! STL files, text or binary, by the stl_io crate. They contain only triangles.

use std::io::Cursor;
use std::path::Path;

use glam::{DVec3, Vec2, Vec3, Vec4};

use crate::model_error::ModelError;
use crate::scene::mesh::Mesh;
use crate::scene::report::{Fate, ImportReport};
use crate::scene::{Loading, Model, Slot};

/// Loads the contents of an STL file. Its Z is upwards, as in most programs that write them: it is turned to our +Y.
pub(super) fn load(path: &Path, bytes: &[u8], loading: &Loading) -> Result<Model, ModelError> {
    let invalid = |error: std::io::Error| ModelError::invalid(path, error);
    let mut source = Cursor::new(bytes);
    let mut report = ImportReport::default();
    let mut read: Vec<stl_io::Triangle> = Vec::new();
    for triangle in stl_io::create_stl_reader(&mut source).map_err(invalid)? {
        loading.check()?;
        match triangle {
            Ok(triangle) => read.push(triangle),
            // The data before the damage is shown.
            Err(error) if read.is_empty() => return Err(invalid(error)),
            Err(error) => {
                report.note(
                    Fate::Missing,
                    format!("what follows a breach of the format ({error})"),
                    "",
                );
                break;
            }
        }
    }
    loading.step("tangents")?;
    let corners = read.iter().flat_map(|triangle| triangle.vertices);
    let place = |vertex: stl_io::Vertex| {
        let [x, y, z] = vertex.0.map(f64::from);
        DVec3::new(x, z, -y)
    };
    let positions: Vec<DVec3> = corners.map(place).collect();
    let count = positions.len();
    let mut mesh = Mesh {
        positions,
        normals: vec![Vec3::ZERO; count],
        uvs: vec![Vec2::ZERO; count],
        tangents: vec![Vec4::W; count],
        slots: vec![0; read.len()],
        triangles: (0..read.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        ..Mesh::default()
    };
    mesh.make_tangents([1.0, 0.0, 0.0, 0.0, 1.0, 0.0], false, loading);
    report.note(Fate::Used, "meshes", "");
    Ok(Model {
        mesh,
        slots: vec![Slot::clay()],
        report,
        ..Model::default()
    })
}
