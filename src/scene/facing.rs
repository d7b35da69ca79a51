//! How steeply a scene's faces are seen from a place.

use glam::DVec3;
use rayon::prelude::*;

use super::geometry::{Geometry, Vertex};

/// How far a corner's normal may be from its face's, as 1 − cosine: the rounding of f32 normals.
const TOLERANCE: f64 = 1e-6;

/// A cosine that no face's normal falls below towards `eye` (in the geometry's units), from either side; 0 where a
/// smooth surface's normals lean from its faces, and nothing is proven.
pub fn least_view_cosine(geometry: &Geometry, eye: [f64; 3]) -> f64 {
    let eye = DVec3::from_array(eye);
    let of_face = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| DVec3::from_array(geometry.positions[v as usize].map(f64::from)));
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let is_along = |vertex: &Vertex| {
            let shading = DVec3::from_array(vertex.normal.map(f64::from)).normalize_or_zero();
            shading == DVec3::ZERO || shading.dot(normal).abs() > 1.0 - TOLERANCE
        };
        if !triangle.iter().all(|&v| is_along(&geometry.vertices[v as usize])) {
            return 0.0;
        }
        // The height of the eye above the face is the same everywhere on it, and its farthest place is a corner.
        let farthest = [a, b, c]
            .map(|corner| corner.distance(eye))
            .into_iter()
            .fold(0.0, f64::max);
        ((eye - a).dot(normal) / farthest).abs()
    };
    geometry.triangles.par_iter().map(of_face).reduce(|| 1.0, f64::min)
}
