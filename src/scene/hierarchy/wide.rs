//! The CPU's hierarchy: nodes of eight children in plain f32 and leaves of eight triangles, laid out for SIMD tests of all
//! eight.

use glam::Vec3A;
use obvhs::aabb::Aabb;

use super::tree::{BoxedTree, Subtree, Tree};
use crate::{
    optics::vector::Vec3,
    scene::intersect::triangle_normal,
    scene::memory::{in_large_pages, prefetch, room_in_large_pages},
};

/// Children per node, and triangles per leaf at most.
pub const WIDTH: usize = 8;

/// Flag of a child that is a block of triangles; the other bits are its index.
pub const BLOCK: u32 = 1 << 31;

/// Cost of a block's test relative to a node's.
const BLOCK_COST: f32 = 1.0;

/// Triangles per node and per block, below the usual numbers (28 and 4.7 for ten million triangles), to reserve memory.
const TRIANGLES_A_NODE: usize = 24;
const TRIANGLES_A_BLOCK: usize = 4;

/// A node of eight children. Unused children have boxes that no ray hits; they refer to the first block, which is harmless.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Node {
    /// Sides of the children's boxes: `[axis][low, high][child]`.
    pub sides: [[[f32; WIDTH]; 2]; 3],
    /// Indices of nodes, or of blocks if [`BLOCK`] is set.
    pub children: [u32; WIDTH],
}

impl Node {
    const EMPTY: Self = {
        Self {
            sides: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3],
            children: [BLOCK; WIDTH],
        }
    };

    fn set(&mut self, child: usize, bounds: &Aabb, index: u32) {
        let (low, high) = (bounds.min.to_array(), bounds.max.to_array());
        for ([lows, highs], (low, high)) in self.sides.iter_mut().zip(low.into_iter().zip(high)) {
            (lows[child], highs[child]) = (low, high);
        }
        self.children[child] = index;
    }
}

/// Corners of up to eight triangles: `[corner][axis][triangle]`. Missing triangles are NaN, which no ray hits.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Block {
    pub corners: [[[f32; WIDTH]; 3]; 3],
}

/// Normals of a block's triangles: `[axis][triangle]`. Apart from the corners, because few rays need them.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Normals {
    pub axes: [[f32; WIDTH]; 3],
}

/// The CPU's hierarchy; empty without triangles.
#[derive(Clone, Debug, Default)]
pub struct Wide {
    pub nodes: Vec<Node>,
    pub blocks: Vec<Block>,
    pub normals: Vec<Normals>,
    /// First triangle of each block.
    pub firsts: Vec<u32>,
    /// Largest absolute coordinate on each axis.
    pub reach: Vec3A,
    /// Levels of nodes.
    pub depth: usize,
}

impl Wide {
    /// Collapses a binary tree to eight children per node with the least surface area cost (section 3.1 of Ylitie, Karras
    /// and Laine 2017). Works on parts of at most `part_max` triangles one after the other, because the search takes as much
    /// memory as its result.
    pub fn new(tree: &Tree, part_max: u32, corners: impl Fn(u32) -> [[f32; 3]; 3] + Sync) -> Self {
        // Reserved in full: growing would copy, and hold both copies. Unused room takes no memory.
        let [node_count, block_count] =
            [TRIANGLES_A_NODE, TRIANGLES_A_BLOCK].map(|each| tree.root().count as usize / each + 1);
        let mut built = Self {
            nodes: room_in_large_pages(node_count),
            blocks: room_in_large_pages(block_count),
            normals: room_in_large_pages(block_count),
            firsts: Vec::with_capacity(block_count),
            ..Self::default()
        };
        built.nodes.push(Node::EMPTY);
        let bounds = Parts {
            tree,
            part_max,
            corners,
        }
        .fill(&mut built, tree.root(), 0, 1);
        built.reach = bounds.min.abs().max(bounds.max.abs());
        Self {
            nodes: in_large_pages(built.nodes),
            blocks: in_large_pages(built.blocks),
            normals: in_large_pages(built.normals),
            ..built
        }
    }

    /// Prefetches a child, given as in [`Node::children`].
    #[inline(always)]
    pub fn prefetch(&self, child: u32) {
        if child & BLOCK == 0 {
            prefetch(&self.nodes, child as usize);
        } else {
            prefetch(&self.blocks, (child & !BLOCK) as usize);
        }
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..])
            + size_of_val(&self.blocks[..])
            + size_of_val(&self.normals[..])
            + size_of_val(&self.firsts[..])
    }
}

/// The best cut of a subtree into up to eight children, by the surface area heuristic.
#[derive(Clone, Copy, Default)]
struct Cut {
    /// Costs as 1 to 7 children; as one child it is a node or a block.
    costs: [f32; WIDTH - 1],
    /// Per number of children, how many are from the left subtree; 0 if fewer children are cheaper. The first entry is for
    /// the eight children of a node of its own.
    lefts: [u8; WIDTH - 1],
    /// Whether it is a block if it is one child.
    is_block: bool,
}

impl Cut {
    /// Cost of a subtree as up to `children` children.
    fn cost(cuts: &[Self], tree: &BoxedTree<'_>, node: Subtree, children: usize) -> f32 {
        match node.count {
            1 => tree.bounds(node).half_area() * BLOCK_COST,
            _ => cuts[tree.inner_index(node)].costs[children - 1],
        }
    }
}

/// The best cut of each inner node, bottom up.
fn cuts(tree: &BoxedTree<'_>) -> Vec<Cut> {
    let mut cuts = vec![Cut::default(); tree.inner.len()];
    for &node in tree.inner.iter().rev() {
        let [left, right] = tree.tree.sides(node);
        // The cheapest number of left children out of `children`, with its cost.
        let best = |children: usize| {
            let cost = |on_left: usize| {
                Cut::cost(&cuts, tree, left, on_left) + Cut::cost(&cuts, tree, right, children - on_left)
            };
            let choices = (1..children).map(|on_left| (cost(on_left), on_left as u8));
            choices.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f32::INFINITY, 0))
        };
        let area = tree.bounds(node).half_area();
        let (inside, on_left) = best(WIDTH);
        let as_node = inside + area;
        let as_block = if node.count as usize <= WIDTH {
            area * BLOCK_COST
        } else {
            f32::INFINITY
        };
        let mut cut = Cut {
            is_block: as_block <= as_node,
            ..Cut::default()
        };
        (cut.costs[0], cut.lefts[0]) = (as_node.min(as_block), on_left);
        for children in 2..WIDTH {
            let (cost, on_left) = best(children);
            let fewer = cut.costs[children - 2];
            (cut.costs[children - 1], cut.lefts[children - 1]) =
                if cost < fewer { (cost, on_left) } else { (fewer, 0) };
        }
        cuts[tree.inner_index(node)] = cut;
    }
    cuts
}

/// Builder of a hierarchy, part by part.
struct Parts<'a, F> {
    tree: &'a Tree,
    part_max: u32,
    corners: F,
}

impl<F: Fn(u32) -> [[f32; 3]; 3] + Sync> Parts<'_, F> {
    /// Fills node `index` with the subtree of `root`. Returns its box.
    fn fill(&self, built: &mut Wide, root: Subtree, index: usize, depth: usize) -> Aabb {
        if root.count <= self.part_max {
            let boxed = BoxedTree::new(self.tree, root, &self.corners);
            let mut builder = Builder {
                cuts: cuts(&boxed),
                tree: &boxed,
                corners: &self.corners,
                built,
            };
            builder.build(index, depth);
            return *boxed.bounds(root);
        }
        let children = self.children(root);
        let first = built.nodes.len();
        built.nodes.resize(first + children.len(), Node::EMPTY);
        let mut whole = Aabb::INVALID;
        for (slot, child) in children.into_iter().enumerate() {
            let bounds = self.fill(built, child, first + slot, depth + 1);
            built.nodes[index].set(slot, &bounds, (first + slot) as u32);
            whole = whole.union(&bounds);
        }
        whole
    }

    /// Up to eight children of a node above the parts. The largest are split until there are eight, or all are parts.
    fn children(&self, root: Subtree) -> Vec<Subtree> {
        let mut children = self.tree.sides(root).to_vec();
        while children.len() < WIDTH {
            let largest = (0..children.len()).max_by_key(|&child| children[child].count);
            let Some(child) = largest.filter(|&child| children[child].count > self.part_max) else {
                break;
            };
            children.splice(child..=child, self.tree.sides(children[child]));
        }
        children
    }
}

/// Builder of one part.
struct Builder<'a, F> {
    tree: &'a BoxedTree<'a>,
    cuts: Vec<Cut>,
    corners: F,
    built: &'a mut Wide,
}

impl<F: Fn(u32) -> [[f32; 3]; 3]> Builder<'_, F> {
    /// Fills node `index` at level `depth` with the whole part.
    fn build(&mut self, index: usize, depth: usize) {
        let root = self.tree.root;
        if self.is_block(root) {
            let block = self.block(root);
            self.built.nodes[index].set(0, self.tree.bounds(root), block);
            self.built.depth = self.built.depth.max(depth);
            return;
        }
        let mut open = vec![(root, index, depth)];
        while let Some((node, index, depth)) = open.pop() {
            self.built.depth = self.built.depth.max(depth);
            // Depth first: siblings are adjacent, followed by the subtree of the first.
            let inner = self.children(node, index);
            open.extend(inner.into_iter().rev().map(|(node, index)| (node, index, depth + 1)));
        }
    }

    fn is_block(&self, node: Subtree) -> bool {
        node.count == 1 || self.cuts[self.tree.inner_index(node)].is_block
    }

    /// Fills node `index`. Returns its children that are nodes, with their indices.
    fn children(&mut self, node: Subtree, index: usize) -> Vec<(Subtree, usize)> {
        let [left, right] = self.tree.tree.sides(node);
        let on_left = usize::from(self.cuts[self.tree.inner_index(node)].lefts[0]);
        let mut children = Vec::with_capacity(WIDTH);
        self.cut(left, on_left, &mut children);
        self.cut(right, WIDTH - on_left, &mut children);
        let mut inner = Vec::new();
        for (slot, &child) in children.iter().enumerate() {
            let child_index = if self.is_block(child) {
                self.block(child)
            } else {
                inner.push((child, self.built.nodes.len()));
                self.built.nodes.push(Node::EMPTY);
                self.built.nodes.len() as u32 - 1
            };
            self.built.nodes[index].set(slot, self.tree.bounds(child), child_index);
        }
        inner
    }

    /// Cuts a subtree into at most `count` children.
    fn cut(&self, node: Subtree, mut count: usize, children: &mut Vec<Subtree>) {
        let lefts = |count: usize| usize::from(self.cuts[self.tree.inner_index(node)].lefts[count - 1]);
        while node.count > 1 && count > 1 && lefts(count) == 0 {
            count -= 1;
        }
        if node.count == 1 || count == 1 {
            children.push(node);
            return;
        }
        let [left, right] = self.tree.tree.sides(node);
        self.cut(left, lefts(count), children);
        self.cut(right, count - lefts(count), children);
    }

    /// Adds a block. Returns its index, as in [`Node::children`].
    fn block(&mut self, node: Subtree) -> u32 {
        let mut corners = [[[f32::NAN; WIDTH]; 3]; 3];
        let mut normals = [[f32::NAN; WIDTH]; 3];
        for lane in 0..node.count {
            let triangle = (self.corners)(node.first + lane);
            let normal = triangle_normal(triangle.map(Vec3::<f32>::from_f32)).to_f32();
            let lane = lane as usize;
            for (lanes, coordinate) in normals.iter_mut().zip(normal) {
                lanes[lane] = coordinate;
            }
            for (lanes, coordinate) in corners.iter_mut().flatten().zip(triangle.into_iter().flatten()) {
                lanes[lane] = coordinate;
            }
        }
        self.built.blocks.push(Block { corners });
        self.built.normals.push(Normals { axes: normals });
        self.built.firsts.push(node.first);
        BLOCK | (self.built.blocks.len() as u32 - 1)
    }
}
