//! The wide hierarchy of boxes (CWBVH, Ylitie, Karras and Laine 2017) that rays find triangles by, built by obvhs.

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

/// Boxes are grown by this on every side, in units of the bounding radius (some 16 roundings of a coordinate of 1), so
/// that rounding in a ray's test against a box never loses a triangle in it.
const BOX_MARGIN: f32 = 1.0 / (1 << 20) as f32;

/// Up to this many triangles share a leaf (the format's limit).
const LEAF_TRIANGLES: u32 = 3;

/// From this many triangles on the time to build counts more than the last 3 % of nodes visited.
const MANY: usize = 200_000;

/// The hierarchy over triangles given by their corners; its `primitive_indices` are the order of leaves.
///
/// Not by spatial splits: each triangle is in one leaf, so triangles can be stored in the order of leaves.
pub(super) fn build(corners: impl ExactSizeIterator<Item = [[f32; 3]; 3]>) -> CwBvh {
    let boxes: Vec<Aabb> = corners
        .map(|corners| {
            let [a, b, c] = corners.map(Vec3A::from_array);
            Aabb::new(a.min(b).min(c) - BOX_MARGIN, a.max(b).max(c) + BOX_MARGIN)
        })
        .collect();
    if boxes.is_empty() {
        return CwBvh::default();
    }
    let order = (0..boxes.len() as u32).collect();
    let mut binary =
        PlocBuilder::with_capacity(boxes.len()).build(PlocSearchDistance::Medium, &boxes, order, SortPrecision::U64, 3);
    let reinsertion = if boxes.len() < MANY { 0.2 } else { 0.02 };
    ReinsertionOptimizer::default().run(&mut binary, reinsertion, None);
    bvh2_to_cwbvh(&binary, LEAF_TRIANGLES, true, false)
}
