//! The bounding volume hierarchies (BVHs) over triangles: one per engine, built on first use.

/// Calls a function with the proof of an instruction set: that of the level if it is AVX-512, AVX2 or NEON, else what every
/// processor has. SSE4.2 is not worth a fourth copy of the traversal.
macro_rules! dispatch {
    ($level:expr, $simd:ident => $traversal:expr) => {
        match $level {
            #[cfg(target_arch = "x86_64")]
            Level::Avx512($simd) => $simd.vectorize(
                #[inline(always)]
                || $traversal,
            ),
            #[cfg(target_arch = "x86_64")]
            Level::Avx2($simd) => $simd.vectorize(
                #[inline(always)]
                || $traversal,
            ),
            _ => {
                let $simd = super::baseline();
                $simd.vectorize(
                    #[inline(always)]
                    || $traversal,
                )
            }
        }
    };
}

mod binary;
mod compressed;
mod instances;
mod interval;
mod packet;
mod packet_trace;
mod traverse;
mod tree;
mod wide;

use std::sync::OnceLock;

use fearless_simd::{Level, Simd};
use glam::Vec3A;
use obvhs::{aabb::Aabb, cwbvh::CwBvh, cwbvh::node::CwBvhNode};

pub use instances::{Bottom, Placement};
pub use interval::EntryPoints;
pub use packet::{OCTANTS, PACKET, Packet, PacketHits, ray_octant};
use tree::{BoxedTree, Tree};
pub use wide::Wide;

use super::loading::{Cancelled, Loading};

/// The instructions that every processor has.
fn baseline() -> impl Simd {
    #[cfg(target_arch = "x86_64")]
    let baseline = Level::baseline().as_sse2();
    #[cfg(target_arch = "aarch64")]
    let baseline = Level::baseline().as_neon();
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    let baseline = Some(fearless_simd::Fallback::new());
    baseline.expect("each has them")
}

/// Margin of every box, in units of the bounding radius (about 16 roundings of a coordinate of 1). It keeps rounding in a
/// ray's test against a box from losing a triangle in it.
const BOX_MARGIN: f32 = 1.0 / (1 << 20) as f32;

/// Levels that the traversal stack has room for (`STACK_SIZE` in `shaders/scene/bvh.wgsl`).
const DEPTH_MAX: usize = 32;

/// Triangles that are built into a hierarchy at once, because building takes about 300 bytes per triangle.
const PART_MAX: u32 = 1 << 20;

/// The hierarchies over a set of triangles, which are stored in its order of leaves.
#[derive(Clone, Debug, Default)]
pub struct Hierarchy {
    /// `None` without triangles.
    tree: Option<Tree>,
    wide: OnceLock<Wide>,
    compressed: OnceLock<Compressed>,
}

/// The GPU's hierarchy.
#[derive(Clone, Debug, Default)]
pub struct Compressed {
    /// Empty without triangles.
    pub nodes: Vec<CwBvhNode>,
    /// Triangle indices in the order of the leaves' entries, which is the GPU's order.
    pub triangles: Vec<u32>,
}

impl Compressed {
    /// Position of each triangle in the GPU's order.
    pub fn places(&self) -> Vec<u32> {
        let mut places = vec![0; self.triangles.len()];
        for (place, &triangle) in (0..).zip(&self.triangles) {
            places[triangle as usize] = place;
        }
        places
    }
}

impl Hierarchy {
    /// Builds the hierarchy over `count` triangles. Also returns the order in which they are to be stored. Corners are in
    /// units of the bounding radius.
    pub fn new(
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

    /// Memory in bytes of the hierarchies built so far.
    pub fn bytes(&self) -> usize {
        self.tree.as_ref().map_or(0, Tree::bytes)
            + self.wide.get().map_or(0, Wide::bytes)
            + self.compressed.get().map_or(0, |built| {
                size_of_val(&built.nodes[..]) + size_of_val(&built.triangles[..])
            })
    }

    /// The CPU's hierarchy; `corners` are those of the triangles as stored.
    pub fn wide(&self, corners: impl Fn(u32) -> [[f32; 3]; 3] + Sync) -> &Wide {
        self.wide.get_or_init(|| {
            self.built(|tree| Wide::new(tree, PART_MAX, &corners), |wide| wide.depth)
                .unwrap_or_default()
        })
    }

    /// The GPU's hierarchy; `corners` are those of the triangles as stored.
    pub fn compressed(&self, corners: impl Fn(u32) -> [[f32; 3]; 3] + Sync) -> &Compressed {
        self.compressed.get_or_init(|| {
            let built: CwBvh = self
                .built(
                    |tree| compressed::compress(&BoxedTree::new(tree, tree.root(), &corners)),
                    compressed::depth,
                )
                .unwrap_or_default();
            Compressed {
                nodes: built.nodes,
                triangles: built.primitive_indices,
            }
        })
    }

    /// Converts the tree to a hierarchy. If that is too deep, converts the balanced tree instead, whose depth is a third of
    /// the binary logarithm of the number of triangles.
    fn built<H>(&self, make: impl Fn(&Tree) -> H, depth: impl Fn(&H) -> usize) -> Option<H> {
        let tree = self.tree.as_ref()?;
        let built = make(tree);
        if depth(&built) <= DEPTH_MAX {
            return Some(built);
        }
        // Triangles each a fraction of the last make a chain. The balanced tree is slower to traverse, but fits the stack.
        log::debug!("a hierarchy of {} levels is rebuilt as a balanced tree", depth(&built));
        drop(built);
        Some(make(&tree.of_halves()))
    }
}

/// A box as a triangle with the same box, to build hierarchies over boxes.
pub fn triangle_of_box([low, high]: [[f32; 3]; 2]) -> [[f32; 3]; 3] {
    [low, high, high]
}

fn triangle_box(corners: [[f32; 3]; 3]) -> Aabb {
    let [a, b, c] = corners.map(Vec3A::from_array);
    Aabb::new(a.min(b).min(c) - BOX_MARGIN, a.max(b).max(c) + BOX_MARGIN)
}
