//! The hierarchies of boxes by which rays find triangles: one for each engine, built when it is first needed.

mod binary;
mod bundle;
mod compressed;
mod packet;
#[cfg(test)]
mod tests;
mod traverse;
mod tree;
mod wide;

use std::sync::OnceLock;

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::node::CwBvhNode;

pub(in crate::scene) use bundle::Doors;
pub(in crate::scene) use packet::Found;
pub use packet::{OCTANTS, PACKET, Packet, ray_octant};
use tree::{BoxedTree, Tree};
pub(in crate::scene) use wide::Wide;

use super::loading::{Cancelled, Loading};

/// Boxes are grown by this on every side, in units of the bounding radius (some 16 roundings of a coordinate of 1), so
/// that rounding in a ray's test against a box never loses a triangle in it.
const BOX_MARGIN: f32 = 1.0 / (1 << 20) as f32;

/// Deepest hierarchy that a ray's stack has room for (`STACK_SIZE` in `shaders/scene/bvh.wgsl`).
const DEPTH_MAX: usize = 32;

/// Triangles of which a hierarchy is built at once: what it takes meanwhile, some 300 bytes a triangle, is not asked for all
/// of a large model.
const PART_MAX: u32 = 1 << 20;

/// How triangles, in the order in which it wants them stored, are found by rays.
#[derive(Clone, Debug, Default)]
pub struct Hierarchy {
    /// Nothing where there are no triangles.
    tree: Option<Tree>,
    wide: OnceLock<Wide>,
    compressed: OnceLock<Compressed>,
}

/// The hierarchy as the GPU reads it.
#[derive(Clone, Debug, Default)]
pub struct Compressed {
    /// None where there are no triangles.
    pub nodes: Vec<CwBvhNode>,
    /// The triangles in the order of the leaves' entries, in which the GPU has them.
    pub triangles: Vec<u32>,
}

impl Compressed {
    /// Where in the GPU's order each triangle is.
    pub fn places(&self) -> Vec<u32> {
        let mut places = vec![0; self.triangles.len()];
        for (place, &triangle) in (0..).zip(&self.triangles) {
            places[triangle as usize] = place;
        }
        places
    }
}

impl Hierarchy {
    /// The hierarchy over so many triangles, and the order in which they are to be stored. Corners are in units of the
    /// bounding radius.
    pub(super) fn new(
        count: usize,
        corners: impl Fn(u32) -> [[f32; 3]; 3] + Sync,
        loading: &Loading,
    ) -> Result<(Self, Vec<u32>), Cancelled> {
        if count == 0 {
            return Ok(Default::default());
        }
        let box_of = |triangle| triangle_box(corners(triangle));
        let (tree, order) = binary::tree(count as u32, PART_MAX, box_of, loading)?;
        let hierarchy = Self {
            tree: Some(tree),
            ..Self::default()
        };
        Ok((hierarchy, order))
    }

    /// Bytes in memory of what has been built.
    pub(super) fn bytes(&self) -> usize {
        let compressed = |made: &Compressed| size_of_val(&made.nodes[..]) + size_of_val(&made.triangles[..]);
        self.tree.as_ref().map_or(0, Tree::bytes)
            + self.wide.get().map_or(0, Wide::bytes)
            + self.compressed.get().map_or(0, compressed)
    }

    /// The processor's; `corners` of the triangles as they are stored.
    pub(super) fn wide(&self, corners: impl Fn(u32) -> [[f32; 3]; 3] + Sync) -> &Wide {
        self.wide.get_or_init(|| {
            let make = |tree: &Tree| Wide::new(tree, PART_MAX, &corners);
            self.made(make, |wide| wide.depth).unwrap_or_default()
        })
    }

    /// The GPU's; `corners` of the triangles as they are stored.
    pub(super) fn compressed(&self, corners: impl Fn(u32) -> [[f32; 3]; 3] + Sync) -> &Compressed {
        self.compressed.get_or_init(|| {
            let make = |tree: &Tree| compressed::compress(&BoxedTree::new(tree, tree.root(), &corners));
            let made: CwBvh = self.made(make, compressed::depth).unwrap_or_default();
            Compressed {
                nodes: made.nodes,
                triangles: made.primitive_indices,
            }
        })
    }

    /// A hierarchy made of the tree; where that is too deep, of the tree that halves the triangles, whose depth is a third
    /// of the binary logarithm of their number.
    fn made<H>(&self, make: impl Fn(&Tree) -> H, depth: impl Fn(&H) -> usize) -> Option<H> {
        let tree = self.tree.as_ref()?;
        let made = make(tree);
        if depth(&made) <= DEPTH_MAX {
            return Some(made);
        }
        // Triangles each a fraction of the last make a chain: halves instead, which rays pass more slowly but never in vain.
        log::debug!("a hierarchy of {} levels is built anew in halves", depth(&made));
        drop(made);
        Some(make(&tree.of_halves()))
    }
}

fn triangle_box(corners: [[f32; 3]; 3]) -> Aabb {
    let [a, b, c] = corners.map(Vec3A::from_array);
    Aabb::new(a.min(b).min(c) - BOX_MARGIN, a.max(b).max(c) + BOX_MARGIN)
}
