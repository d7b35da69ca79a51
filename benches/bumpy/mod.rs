//! A model of any number of triangles.

use glam::DVec3;
use glossmith::scene::{mesh::Mesh, shapes::sphere};

/// Bumps per unit of length, as an angle, and their height.
const BUMPS: f64 = 9.0;
const BUMP_HEIGHT: f64 = 0.08;

/// A bumpy sphere of about `triangles` triangles: curved everywhere, concave in places, of the same size for any number.
/// Slot 0.
pub fn bumpy_sphere(triangles: u64) -> Mesh {
    // 2 · down cells around, two triangles each.
    let down = ((triangles as f64 / 4.0).sqrt().round() as u32).max(4);
    let mut mesh = sphere(2 * down, down);
    for (place, normal) in mesh.positions.iter_mut().zip(&mut mesh.normals) {
        let phases = *place * BUMPS;
        let height = BUMP_HEIGHT * phases.x.sin() * phases.y.sin() * phases.z.sin();
        let slope = DVec3::new(
            phases.x.cos() * phases.y.sin() * phases.z.sin(),
            phases.x.sin() * phases.y.cos() * phases.z.sin(),
            phases.x.sin() * phases.y.sin() * phases.z.cos(),
        ) * (BUMP_HEIGHT * BUMPS);
        // The normal of the radius 1 + h: the sphere's, tilted by the slope along the surface.
        let along = slope - *place * place.dot(slope);
        *normal = (*place * (1.0 + height) - along).normalize().as_vec3();
        *place *= 1.0 + height;
    }
    mesh
}
