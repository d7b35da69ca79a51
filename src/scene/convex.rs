//! Proof that a scene is one convex body: then rays that leave it outwards miss.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};

use glam::DVec3;

use super::loading::{Cancelled, Loading};
use crate::parallel;

/// Distance that a vertex may lie above a face's plane, in bounding radii: the rounding of f32 corners.
const TOLERANCE: f64 = 1e-6;
/// Vertices per cluster. They are consecutive in the order of the hierarchy's leaves, so that they are near each other.
const CLUSTER: usize = 64;
/// The most tests of a plane against a cluster or a place: a second on two cores. Beyond, the proof is given up.
const EFFORT_MAX: usize = 1 << 29;

/// Places near each other, with a sphere and a box around them.
struct Cluster {
    places: Vec<DVec3>,
    center: DVec3,
    radius: f64,
    middle: DVec3,
    half_sides: DVec3,
}

impl Cluster {
    fn new(places: &[[f32; 3]]) -> Self {
        let places: Vec<DVec3> = places
            .iter()
            .map(|place| DVec3::from_array(place.map(f64::from)))
            .collect();
        let center = places.iter().sum::<DVec3>() / places.len() as f64;
        let radius = places.iter().map(|place| place.distance(center)).fold(0.0, f64::max);
        let least = places.iter().copied().reduce(DVec3::min).unwrap_or(center);
        let most = places.iter().copied().reduce(DVec3::max).unwrap_or(center);
        Self {
            places,
            center,
            radius,
            middle: (least + most) / 2.0,
            half_sides: (most - least) / 2.0,
        }
    }

    /// Whether no vertex lies above the plane through `corner` with this unit normal. The box decides for axis-aligned
    /// planes, which no sphere does. Adds the tests made to `effort`.
    fn is_below(&self, corner: DVec3, normal: DVec3, effort: &mut usize) -> bool {
        *effort += 1;
        if (self.center - corner).dot(normal) + self.radius <= TOLERANCE
            || (self.middle - corner).dot(normal) + self.half_sides.dot(normal.abs()) <= TOLERANCE
        {
            return true;
        }
        *effort += self.places.len();
        self.places
            .iter()
            .all(|place| (*place - corner).dot(normal) <= TOLERANCE)
    }
}

/// True if no vertex lies above any face's plane, on the side from which its corners are anticlockwise. A ray that leaves a
/// face on that side then misses. Most other bodies are found out by their first faces; if the proof takes too long, the
/// body counts as not convex.
pub fn is_convex(positions: &[[f32; 3]], triangles: &[[u32; 3]], loading: &Loading) -> Result<bool, Cancelled> {
    let effort = AtomicUsize::new(0);
    let is_proven = is_proven(positions, triangles, &effort, &|| loading.check().is_ok());
    loading.check().map(|()| is_proven)
}

/// The proof and its effort: at most [`EFFORT_MAX`], but for the faces being tested.
fn is_proven(
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    effort: &AtomicUsize,
    is_wanted: &(impl Fn() -> bool + Sync),
) -> bool {
    if positions.len().div_ceil(CLUSTER).saturating_mul(triangles.len()) > EFFORT_MAX {
        return false;
    }
    let clusters: Vec<Cluster> = positions.chunks(CLUSTER).map(Cluster::new).collect();
    let is_refuted = AtomicBool::new(false);
    let is_below = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| DVec3::from_array(positions[vertex as usize].map(f64::from)));
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let mut here = 0;
        let is_below = clusters.iter().all(|cluster| cluster.is_below(a, normal, &mut here));
        is_below && effort.fetch_add(here, Relaxed) + here <= EFFORT_MAX && is_wanted()
    };
    parallel::for_blocks(triangles.len(), CLUSTER, &|faces| {
        for face in faces {
            if is_refuted.load(Relaxed) || !is_below(&triangles[face]) {
                return is_refuted.store(true, Relaxed);
            }
        }
    });
    !is_refuted.into_inner()
}
