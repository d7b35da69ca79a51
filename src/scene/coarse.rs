//! Triangles that are coarse for the smooth normals at their corners.

use glam::{DVec3, Vec3};

use std::ops::Range;

use super::part::{Part, exact};
use crate::parallel;

/// Cosine of the largest lean of a normal from its triangle: 6 degrees. Beyond, the light cut off by the triangle's own
/// horizon is brighter than a tenth of light from straight above.
const LEAN_COSINE: f64 = 0.9945;
/// The share of the surface that may lean further: poles, lips and tips. Of the built-in teapot 4 % do.
const SHARE_MAX: f64 = 0.08;

/// True if more than a twelfth of the surface is coarse, by [`leaning_areas`].
pub fn is_coarse([all, leaning]: [f64; 2]) -> bool {
    leaning > SHARE_MAX * all
}

/// Twice the area of all triangles, and of those from which a normal leans far.
pub fn leaning_areas(part: &Part) -> [f64; 2] {
    let of_triangle = |triangle: usize| {
        let [a, b, c] = exact(part.corners(triangle));
        let out = (b - a).cross(c - a);
        let area = out.length();
        let leans = part.triangles[triangle].iter().any(|&vertex| {
            let normal = Vec3::from_array(part.vertices[vertex as usize].normal).as_dvec3();
            // Normals of 0 stand for that of the triangle.
            normal != DVec3::ZERO && normal.dot(out).abs() < LEAN_COSINE * area
        });
        [area, if leans { area } else { 0.0 }]
    };
    let add = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a + c, b + d];
    let of_block = |triangles: Range<usize>| triangles.map(of_triangle).fold([0.0; 2], add);
    parallel::map_blocks(part.triangles.len(), of_block)
        .into_iter()
        .fold([0.0; 2], add)
}
