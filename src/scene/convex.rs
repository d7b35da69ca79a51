//! Proof that a scene is one convex body, so that rays that leave it outwards meet nothing.

use glam::DVec3;
use rayon::prelude::*;

/// How far a place may lie above a face's plane, in bounding radii: the rounding of f32 corners.
const TOLERANCE: f64 = 1e-6;
/// Places that are looked at together; they follow each other in the order of the hierarchy's leaves, so they are near
/// each other.
const CLUSTER: usize = 64;
/// Products of faces and clusters beyond which the proof is not attempted: a second on two cores.
const EFFORT_MAX: usize = 1 << 29;

/// Places near each other, and a sphere around them.
struct Cluster {
    places: Vec<DVec3>,
    center: DVec3,
    radius: f64,
}

impl Cluster {
    fn new(places: &[[f32; 3]]) -> Self {
        let places: Vec<DVec3> = places
            .iter()
            .map(|place| DVec3::from_array(place.map(f64::from)))
            .collect();
        let center = places.iter().sum::<DVec3>() / places.len() as f64;
        let radius = places.iter().map(|place| place.distance(center)).fold(0.0, f64::max);
        Self { places, center, radius }
    }

    /// Whether nothing lies above the plane through `corner` with this unit normal.
    fn is_below(&self, corner: DVec3, normal: DVec3) -> bool {
        (self.center - corner).dot(normal) + self.radius <= TOLERANCE
            || self
                .places
                .iter()
                .all(|place| (*place - corner).dot(normal) <= TOLERANCE)
    }
}

/// True where no place lies above the plane of any face, seen from the side on which its corners run counter-clockwise.
/// A ray that leaves a face on that side then meets nothing. Most bodies that are not convex are found out by their
/// first faces.
pub(super) fn is_convex(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> bool {
    if positions.len().div_ceil(CLUSTER).saturating_mul(triangles.len()) > EFFORT_MAX {
        return false;
    }
    let clusters: Vec<Cluster> = positions.chunks(CLUSTER).map(Cluster::new).collect();
    triangles.par_iter().all(|triangle| {
        let [a, b, c] = triangle.map(|vertex| DVec3::from_array(positions[vertex as usize].map(f64::from)));
        let normal = (b - a).cross(c - a).normalize_or_zero();
        clusters.iter().all(|cluster| cluster.is_below(a, normal))
    })
}
