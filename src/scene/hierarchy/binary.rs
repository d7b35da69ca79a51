//! Builder of the binary tree, by obvhs.

use glam::Vec3A;
use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, node::Bvh2Node, reinsertion::ReinsertionOptimizer},
    ploc::{PlocBuilder, PlocSearchDistance, SortPrecision},
};
use rayon::prelude::*;

use super::tree::Tree;
use crate::parallel;
use crate::scene::loading::{Cancelled, Loading};

/// From this many triangles on, build time matters more than the last 3 % of visited nodes.
const MANY: usize = 200_000;
/// Cells per axis of the clustering grid. Fine: only duplicates share a cell. Coarse: so few cells that the builder's
/// quadratic time for overlapping boxes does not matter.
const FINE: u32 = 1 << 21;
const COARSE: u32 = 1 << 4;
/// Up to this many triangles, overlap does not matter.
const SLIVERS_FROM: usize = 1 << 12;
/// Mean share of the bounds' area per box from which triangles count as slivers.
const SLIVERS_SHARE: f64 = 1.0 / 16.0;

/// Builds the tree over `count` triangles. Also returns the order of its leaves. More than `part_max` triangles are halved
/// along the longest side of their bounds, because building takes several hundred bytes per triangle.
pub fn tree(
    count: u32,
    part_max: u32,
    box_of: impl Fn(u32) -> Aabb + Sync,
    loading: &Loading,
) -> Result<(Tree, Vec<u32>), Cancelled> {
    let mut order: Vec<u32> = (0..count).collect();
    let mut tree = Tree {
        left_leaves: Vec::with_capacity(count.saturating_sub(1) as usize),
    };
    let mut parts = Parts {
        tree: &mut tree,
        count,
        part_max: part_max as usize,
        box_of,
        loading,
    };
    parts.build(&mut order)?;
    Ok((tree, order))
}

/// Builder of a tree, part by part.
struct Parts<'a, F> {
    tree: &'a mut Tree,
    /// Triangles in the whole tree.
    count: u32,
    part_max: usize,
    box_of: F,
    loading: &'a Loading,
}

impl<F: Fn(u32) -> Aabb + Sync> Parts<'_, F> {
    /// Appends the nodes over `triangles` and sorts these by leaf.
    fn build(&mut self, triangles: &mut [u32]) -> Result<(), Cancelled> {
        let percent = 100 * self.tree.left_leaves.len() / self.count as usize;
        self.loading.step(format!("hierarchy of triangles, {percent} %"))?;
        let box_of = &self.box_of;
        if triangles.len() <= self.part_max {
            let boxes: Vec<Aabb> = parallel::map_each(triangles, |&triangle| box_of(triangle));
            let (part, order) = Tree::of(&build(&boxes, self.loading)?);
            let sorted: Vec<u32> = order.into_iter().map(|place| triangles[place as usize]).collect();
            triangles.copy_from_slice(&sorted);
            self.tree.left_leaves.extend(part.left_leaves);
            return Ok(());
        }
        let middle = triangles.len() / 2;
        halve(triangles, middle, box_of);
        let (left, right) = triangles.split_at_mut(middle);
        self.tree.left_leaves.push(middle as u32);
        self.build(left)?;
        self.build(right)
    }
}

/// Partitions triangles at `middle` by their centres, along the longest side of the centres' bounds.
fn halve(triangles: &mut [u32], middle: usize, box_of: &(impl Fn(u32) -> Aabb + Sync)) {
    let bounds = parallel::map_blocks(triangles.len(), |range| {
        let centers = triangles[range].iter().map(|&triangle| box_of(triangle).center());
        centers.fold([Vec3A::INFINITY, Vec3A::NEG_INFINITY], |[low, high], center| {
            [low.min(center), high.max(center)]
        })
    });
    let low = bounds.iter().fold(Vec3A::INFINITY, |low, block| low.min(block[0]));
    let high = bounds
        .iter()
        .fold(Vec3A::NEG_INFINITY, |high, block| high.max(block[1]));
    let axis = (high - low).max_position();
    let mut keyed = parallel::map_each(triangles, |&triangle| (box_of(triangle).center()[axis], triangle));
    // Ties break by index, so that the order is deterministic.
    keyed.select_nth_unstable_by(middle, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    triangles
        .iter_mut()
        .zip(keyed)
        .for_each(|(place, (_, triangle))| *place = triangle);
}

/// Builds a BVH over boxes, in units of the bounding radius, with one triangle per leaf.
///
/// Without spatial splits: each triangle is in one leaf, so that triangles can be stored in the order of leaves.
fn build(boxes: &[Aabb], loading: &Loading) -> Result<Bvh2, Cancelled> {
    let clusters = Clusters::new(boxes, if are_slivers(boxes) { COARSE } else { FINE });
    loading.check()?;
    let mut binary = clusters.build_binary(boxes);
    let reinsertion = if boxes.len() < MANY { 0.2 } else { 0.02 };
    // Optimisation rounds over ever fewer nodes, from the top.
    for part in (1..32).step_by(2).map(|round| 1.0 / round as f32) {
        loading.check()?;
        ReinsertionOptimizer::default().run(&mut binary, reinsertion, Some(vec![part]));
    }
    clusters.expand(&mut binary, boxes);
    Ok(binary)
}

/// Whether boxes mostly overlap, as those of a polygon's triangles that share a corner.
fn are_slivers(boxes: &[Aabb]) -> bool {
    let whole = boxes.iter().fold(Aabb::INVALID, |all, aabb| all.union(aabb));
    let areas: f64 = boxes.iter().map(|aabb| f64::from(aabb.half_area())).sum();
    boxes.len() > SLIVERS_FROM && areas > SLIVERS_SHARE * boxes.len() as f64 * f64::from(whole.half_area())
}

/// Clusters of triangles with centres in the same grid cell; in a fine grid these are duplicates.
///
/// The builder pairs nearest neighbours and finds hardly any pairs among equal boxes: thousands of them would take quadratic
/// time. So it builds over clusters, and balanced trees continue below.
struct Clusters {
    /// Triangle indices, cluster by cluster.
    members: Vec<u32>,
    /// Start of each cluster in `members`, and the end of the last.
    starts: Vec<u32>,
}

impl Clusters {
    fn new(boxes: &[Aabb], cells_per_axis: u32) -> Self {
        let cell_of = |aabb: &Aabb| {
            let cells_per_axis = cells_per_axis as f32;
            // From [−1, 1]; the ground's centres lie outside and share the outermost cells.
            let place = ((aabb.min + aabb.max) * 0.25 + 0.5) * cells_per_axis;
            let [x, y, z] = place
                .clamp(Vec3A::ZERO, Vec3A::splat(cells_per_axis - 1.0))
                .as_uvec3()
                .to_array();
            u64::from(x) | u64::from(y) << 21 | u64::from(z) << 42
        };
        let mut keyed: Vec<(u64, u32)> = parallel::map(boxes.len(), |index| (cell_of(&boxes[index]), index as u32));
        keyed.par_sort_unstable();
        let starts = (0..=keyed.len())
            .filter(|&i| i == 0 || i == keyed.len() || keyed[i].0 != keyed[i - 1].0)
            .map(|i| i as u32)
            .collect();
        Self {
            members: keyed.into_iter().map(|(_, triangle)| triangle).collect(),
            starts,
        }
    }

    fn members(&self, cluster: u32) -> &[u32] {
        let [start, end] = [0, 1].map(|i| self.starts[cluster as usize + i] as usize);
        &self.members[start..end]
    }

    /// Builds a BVH over the clusters' boxes.
    fn build_binary(&self, boxes: &[Aabb]) -> Bvh2 {
        let count = self.starts.len() as u32 - 1;
        let cluster_boxes: Vec<Aabb> = (0..count).map(|cluster| union(self.members(cluster), boxes)).collect();
        PlocBuilder::with_capacity(cluster_boxes.len()).build(
            PlocSearchDistance::Medium,
            &cluster_boxes,
            (0..count).collect(),
            SortPrecision::U64,
            3,
        )
    }

    /// Replaces each cluster's leaf by a balanced tree of triangles.
    fn expand(&self, binary: &mut Bvh2, boxes: &[Aabb]) {
        for node in 0..binary.nodes.len() {
            if binary.nodes[node].is_leaf() {
                let cluster = binary.primitive_indices[binary.nodes[node].first_index as usize];
                split(&mut binary.nodes, node, self.members(cluster), boxes);
            }
        }
        binary.primitive_indices = (0..boxes.len() as u32).collect();
    }
}

/// Turns a node into the root of a balanced tree over triangles.
fn split(nodes: &mut Vec<Bvh2Node>, node: usize, triangles: &[u32], boxes: &[Aabb]) {
    let aabb = union(triangles, boxes);
    if let [triangle] = triangles {
        nodes[node] = Bvh2Node::new(aabb, 1, *triangle);
        return;
    }
    let children = nodes.len();
    nodes[node] = Bvh2Node::new(aabb, 0, children as u32);
    nodes.extend([Bvh2Node::default(); 2]);
    let (left, right) = triangles.split_at(triangles.len() / 2);
    split(nodes, children, left, boxes);
    split(nodes, children + 1, right, boxes);
}

fn union(triangles: &[u32], boxes: &[Aabb]) -> Aabb {
    triangles
        .iter()
        .map(|&triangle| boxes[triangle as usize])
        .fold(Aabb::INVALID, |all, aabb| all.union(&aabb))
}
