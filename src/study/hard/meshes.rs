//! Meshes that are hard to trace.

use glam::{DVec3, Vec4};

use crate::scene::{Model, mesh::Mesh, mesh::plane_normal, shapes};

pub fn model(mesh: Mesh) -> Model {
    Model {
        mesh,
        ..Model::default()
    }
}

/// A square of two triangles with flat normals, facing one way or the other.
pub fn add_square(mesh: &mut Mesh, mut corners: [DVec3; 4], is_turned: bool) {
    if is_turned {
        corners.reverse();
    }
    let normal = plane_normal([corners[0], corners[1], corners[2]]).as_vec3();
    let [a, b, c, d] = corners.map(|corner| mesh.push_vertex(corner, normal, Default::default(), Vec4::X));
    mesh.push_triangle([a, b, c], 0);
    mesh.push_triangle([a, c, d], 0);
}

/// A cube from −half to half, each face in `cells` × `cells` squares.
pub fn cube(half: DVec3, cells: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let [u, v] = [axes[(axis + 1) % 3], axes[(axis + 2) % 3]];
            let place = |i: u32| 2.0 * f64::from(i) / f64::from(cells) - 1.0;
            for (i, j) in (0..cells).flat_map(|i| (0..cells).map(move |j| (i, j))) {
                let corner = |i: u32, j: u32| (axes[axis] * side + u * place(i) + v * place(j)) * half;
                let corners = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
                add_square(&mut mesh, corners, side < 0.0);
            }
        }
    }
    mesh
}

pub fn needle() -> Mesh {
    let mut mesh = cube(DVec3::new(1.0, 1e-5, 1e-5), 1);
    let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 0.7, 0.5);
    mesh.positions.iter_mut().for_each(|place| *place = turn * *place);
    mesh
}

/// A ball of radius 1e-6.
pub fn small_ball() -> Mesh {
    let mut mesh = shapes::sphere(24, 12);
    for place in &mut mesh.positions {
        *place = *place * 1e-6 + DVec3::new(0.4, 0.3, 0.2);
    }
    mesh
}

/// Triangles along spirals, each smaller than the one before by a factor.
pub fn spirals() -> Mesh {
    let mut mesh = Mesh::default();
    for spiral in 0..40 {
        let turn = glam::DQuat::from_euler(
            glam::EulerRot::XYZ,
            f64::from(spiral) * 0.7,
            f64::from(spiral) * 1.3,
            0.2,
        );
        let mut size = 1.0;
        for step in 0..500 {
            let (sin, cos) = (f64::from(step) * 0.3).sin_cos();
            let place = turn * (DVec3::new(cos, sin, 0.3) * size);
            let (u, v) = (turn * DVec3::X * (size * 0.1), turn * DVec3::Y * (size * 0.1));
            let normal = (turn * DVec3::Z).as_vec3();
            let corners = [place, place + u, place + v]
                .map(|corner| mesh.push_vertex(corner, normal, Default::default(), Vec4::X));
            mesh.push_triangle(corners, 0);
            size *= 0.968;
        }
    }
    mesh
}
