//! The still life that the editor begins with: the teapot with a bowl, a ball and a bead, each of a material of its own.

use std::ops::Range;

use glam::DVec3;

use super::mesh::Mesh;
use super::{shapes, teapot};

/// The slots, which are the objects as well, from the largest on.
pub(super) const PARTS: [&str; 4] = ["teapot", "bowl", "ball", "bead"];

/// Where the smaller parts stand, and how large they are: the teapot's body has a radius of 2 and its spout points to +X.
const BOWL: DVec3 = DVec3::new(2.05, 0.0, 2.4);
const BALL: (DVec3, f64) = (DVec3::new(-1.25, 0.68, 2.45), 0.68);
const BEAD: (DVec3, f64) = (DVec3::new(0.2, 0.36, 2.95), 0.36);

/// The mesh: part after part.
pub(super) fn mesh() -> Mesh {
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
pub(super) fn triangles(mesh: &Mesh) -> impl Iterator<Item = Range<usize>> {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Every part stands on the ground, is closed, has a slot of its own, and touches no other.
    #[test]
    fn the_parts_stand_beside_each_other() {
        let mesh = mesh();
        let ranges: Vec<Range<usize>> = triangles(&mesh).collect();
        let places = |range: &Range<usize>| {
            range
                .clone()
                .flat_map(|triangle| mesh.corners(triangle))
                .collect::<Vec<_>>()
        };
        for (slot, range) in ranges.iter().enumerate() {
            assert!(
                mesh.slots[range.clone()].iter().all(|of| *of == slot as u32),
                "{}",
                PARTS[slot]
            );
            let lowest = places(range).iter().map(|place| place.y).fold(f64::MAX, f64::min);
            assert!(lowest.abs() < 0.01, "{} begins at {lowest}", PARTS[slot]);
        }
        assert_eq!(ranges[3].end, mesh.triangles.len());
        for (small, range) in ranges.iter().enumerate().skip(1) {
            let around = places(range);
            let center = around.iter().sum::<DVec3>() / around.len() as f64;
            let radius = around.iter().map(|place| place.distance(center)).fold(0.0, f64::max);
            for (other, range) in ranges.iter().enumerate().take(small) {
                let nearest = places(range)
                    .iter()
                    .map(|place| place.distance(center))
                    .fold(f64::MAX, f64::min);
                assert!(
                    nearest > radius,
                    "{} in {}: {nearest} of {radius}",
                    PARTS[small],
                    PARTS[other]
                );
            }
        }
    }
}
