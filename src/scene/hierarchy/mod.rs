//! The hierarchies of boxes by which rays find triangles: one for each engine, built when it is first needed.

mod binary;
mod compressed;
mod traverse;
mod tree;
mod wide;

use std::sync::OnceLock;

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::node::CwBvhNode;

use tree::{BoxedTree, Tree};
pub(in crate::scene) use wide::Wide;

/// Boxes are grown by this on every side, in units of the bounding radius (some 16 roundings of a coordinate of 1), so
/// that rounding in a ray's test against a box never loses a triangle in it.
const BOX_MARGIN: f32 = 1.0 / (1 << 20) as f32;

/// Deepest hierarchy that a ray's stack has room for (`STACK_SIZE` in `shaders/scene/bvh.wgsl`).
const DEPTH_MAX: usize = 32;

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
    /// The hierarchy over triangles, and the order in which they are to be stored. Corners are in units of the bounding
    /// radius.
    pub(super) fn new(corners: impl ExactSizeIterator<Item = [[f32; 3]; 3]>) -> (Self, Vec<u32>) {
        let boxes: Vec<Aabb> = corners.map(triangle_box).collect();
        if boxes.is_empty() {
            return Default::default();
        }
        let (tree, order) = Tree::of(&binary::build(&boxes));
        let hierarchy = Self {
            tree: Some(tree),
            ..Self::default()
        };
        (hierarchy, order)
    }

    /// Bytes in memory of what has been built.
    pub(super) fn bytes(&self) -> usize {
        let compressed = |made: &Compressed| size_of_val(&made.nodes[..]) + size_of_val(&made.triangles[..]);
        self.tree.as_ref().map_or(0, Tree::bytes)
            + self.wide.get().map_or(0, Wide::bytes)
            + self.compressed.get().map_or(0, compressed)
    }

    /// The processor's; `corners` of the triangles as they are stored.
    pub(super) fn wide(&self, corners: impl Fn(u32) -> [[f32; 3]; 3]) -> &Wide {
        self.wide.get_or_init(|| {
            let make = |tree: &BoxedTree<'_>| Wide::new(tree, &corners);
            self.made(&corners, make, |wide| wide.depth).unwrap_or_default()
        })
    }

    /// The GPU's; `corners` of the triangles as they are stored.
    pub(super) fn compressed(&self, corners: impl Fn(u32) -> [[f32; 3]; 3]) -> &Compressed {
        self.compressed.get_or_init(|| {
            let made: CwBvh = self
                .made(&corners, compressed::compress, compressed::depth)
                .unwrap_or_default();
            Compressed {
                nodes: made.nodes,
                triangles: made.primitive_indices,
            }
        })
    }

    /// A hierarchy made of the tree; where that is too deep, of the tree that halves the triangles, whose depth is a third
    /// of the binary logarithm of their number.
    fn made<H>(
        &self,
        corners: impl Fn(u32) -> [[f32; 3]; 3],
        make: impl Fn(&BoxedTree<'_>) -> H,
        depth: impl Fn(&H) -> usize,
    ) -> Option<H> {
        let tree = self.tree.as_ref()?;
        let boxes: Vec<Aabb> = (0..tree.root().count)
            .map(|triangle| triangle_box(corners(triangle)))
            .collect();
        let boxed = BoxedTree::new(tree, boxes);
        let made = make(&boxed);
        if depth(&made) <= DEPTH_MAX {
            return Some(made);
        }
        // Triangles each a fraction of the last make a chain: halves instead, which rays pass more slowly but never in vain.
        log::debug!("a hierarchy of {} levels is built anew in halves", depth(&made));
        let halves = tree.of_halves();
        Some(make(&BoxedTree::new(&halves, boxed.leaf_boxes)))
    }
}

fn triangle_box(corners: [[f32; 3]; 3]) -> Aabb {
    let [a, b, c] = corners.map(Vec3A::from_array);
    Aabb::new(a.min(b).min(c) - BOX_MARGIN, a.max(b).max(c) + BOX_MARGIN)
}
