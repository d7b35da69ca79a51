//! Bounds of the view angles of a scene's faces.

use glam::DVec3;

use std::ops::Range;

use super::{geometry::Geometry, part::exact};
use crate::parallel;

/// Deviation of a corner's normal from its face's, as 1 − cosine: the rounding of f32 normals.
const TOLERANCE: f64 = 1e-6;

/// Lower bound of the faces' view cosines from `eye` (in the geometry's units), from either side; 0 if smooth normals lean
/// from their faces, so that nothing is proven.
pub fn least_view_cosine(geometry: &Geometry, eye: [f64; 3]) -> f64 {
    let eye = DVec3::from_array(eye);
    let of_face = |triangle: usize| {
        let [a, b, c] = exact(geometry.corners(triangle));
        let normal = (b - a).cross(c - a).normalize_or_zero();
        if !geometry.normals(triangle).into_iter().all(|shading| {
            let shading = DVec3::from_array(shading.map(f64::from)).normalize_or_zero();
            shading == DVec3::ZERO || shading.dot(normal).abs() > 1.0 - TOLERANCE
        }) {
            return 0.0;
        }
        // The height of the eye above the face is the same everywhere on it, and its farthest place is a corner.
        let farthest = [a, b, c]
            .map(|corner| corner.distance(eye))
            .into_iter()
            .fold(0.0, f64::max);
        ((eye - a).dot(normal) / farthest).abs()
    };
    let of_block = |triangles: Range<usize>| triangles.map(of_face).fold(1.0, f64::min);
    parallel::map_blocks(geometry.triangle_count(), of_block)
        .into_iter()
        .fold(1.0, f64::min)
}
