//! Meshes moved by the transforms of nodes.

use glam::{DMat3, DMat4};

use super::mesh::Mesh;

/// A mesh moved by a node's transform. One that mirrors turns the triangles round, so that they still face outwards.
pub fn transformed(mut mesh: Mesh, world_from_node: DMat4) -> Mesh {
    let linear = DMat3::from_mat4(world_from_node);
    let mirrors = linear.determinant() < 0.0;
    let normals_from = normal_matrix(linear);
    for position in &mut mesh.positions {
        *position = world_from_node.transform_point3(*position);
    }
    for normal in &mut mesh.normals {
        *normal = (normals_from * normal.as_dvec3()).as_vec3();
    }
    for tangent in &mut mesh.tangents {
        let direction = (linear * tangent.truncate().as_dvec3()).normalize_or_zero().as_vec3();
        *tangent = direction.extend(if mirrors { -tangent.w } else { tangent.w });
    }
    if mirrors {
        mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    mesh.repair_normals();
    mesh
}

/// Transform of normals, up to a positive factor: the inverse transpose, as the cofactor matrix, which also works for
/// flattening transforms.
pub fn normal_matrix(linear: DMat3) -> DMat3 {
    let largest = linear
        .to_cols_array()
        .into_iter()
        .fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
    let scaled = if largest > 0.0 {
        linear * largest.recip()
    } else {
        linear
    };
    let (x, y, z) = (scaled.x_axis, scaled.y_axis, scaled.z_axis);
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    if scaled.determinant() < 0.0 {
        -cofactors
    } else {
        cofactors
    }
}
