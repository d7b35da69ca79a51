//! Proof that a scene is one convex body, so that rays that leave it outwards meet nothing.

use rayon::prelude::*;

/// How far a place may lie above a face's plane, in bounding radii: the rounding of f32 corners.
const TOLERANCE: f64 = 1e-6;
/// Products of faces and places beyond which the proof is not attempted: a fifth of a second on two cores.
const EFFORT_MAX: usize = 1 << 29;

/// True where no place lies above the plane of any face, seen from the side on which its corners run counter-clockwise.
/// A ray that leaves a face on that side then meets nothing. Most bodies that are not convex are found out by their
/// first faces.
pub(super) fn is_convex(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> bool {
    if positions.len().saturating_mul(triangles.len()) > EFFORT_MAX {
        return false;
    }
    triangles.par_iter().all(|triangle| {
        let [a, b, c] = triangle.map(|vertex| glam::DVec3::from_array(positions[vertex as usize].map(f64::from)));
        let normal = (b - a).cross(c - a).normalize_or_zero();
        positions.iter().all(|place| {
            let place = glam::DVec3::from_array(place.map(f64::from));
            (place - a).dot(normal) <= TOLERANCE
        })
    })
}
