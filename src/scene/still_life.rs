//! The still life that the editor begins with: the teapot with a bowl, a ball and a bead, each of a material of its own.

use std::ops::Range;

use glam::DVec3;

use super::{mesh::Mesh, shapes, teapot};

/// The slots, which are the objects as well, from the largest on.
pub const PARTS: [&str; 4] = ["teapot", "bowl", "ball", "bead"];

/// Where the smaller parts stand, and how large they are: the teapot's body has a radius of 2 and its spout points to +X.
const BOWL: DVec3 = DVec3::new(2.05, 0.0, 2.4);
const BALL: (DVec3, f64) = (DVec3::new(-1.25, 0.68, 2.45), 0.68);
const BEAD: (DVec3, f64) = (DVec3::new(0.2, 0.36, 2.95), 0.36);

/// The mesh: part after part.
pub fn mesh() -> Mesh {
    let parts = [
        teapot::mesh(teapot::DEFAULT_SEGMENTS),
        moved(shapes::bowl(1), BOWL, 1.0),
        of_slot(moved(shapes::sphere(96, 48), BALL.0, BALL.1), 2),
        of_slot(moved(shapes::sphere(64, 32), BEAD.0, BEAD.1), 3),
    ];
    let mut whole = Mesh::default();
    parts.into_iter().for_each(|part| whole.append(part));
    whole
}

/// The triangles of each part.
pub fn triangles(mesh: &Mesh) -> impl Iterator<Item = Range<usize>> {
    let begin = |slot: usize| mesh.slots.partition_point(|of| (*of as usize) < slot);
    (0..PARTS.len()).map(move |slot| begin(slot)..begin(slot + 1))
}

fn moved(mut mesh: Mesh, to: DVec3, scale: f64) -> Mesh {
    mesh.positions.iter_mut().for_each(|place| *place = to + scale * *place);
    mesh
}

fn of_slot(mut mesh: Mesh, slot: u32) -> Mesh {
    mesh.slots.fill(slot);
    mesh
}
