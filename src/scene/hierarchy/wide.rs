//! The processor's hierarchy: nodes of eight children in plain f32, leaves of eight triangles, both laid out so that one
//! instruction treats all eight.

use glam::Vec3A;
use obvhs::aabb::Aabb;

use super::tree::{BoxedTree, Subtree, Tree};
use crate::optics::vector::Vec3;
use crate::scene::intersect::triangle_normal;
use crate::scene::memory::{in_large_pages, prefetch, room_in_large_pages};

/// Children of a node, and triangles of a leaf at most.
pub(super) const WIDTH: usize = 8;

/// Marks a child as a block of triangles; the other bits say which.
pub(super) const BLOCK: u32 = 1 << 31;

/// What a block costs a ray, a node costing 1.
const BLOCK_COST: f32 = 1.0;

/// Fewer triangles than most hierarchies have for each node and each block (28 and 4.7 where there are ten million).
const TRIANGLES_A_NODE: usize = 24;
const TRIANGLES_A_BLOCK: usize = 4;

/// A node. Its unused children have boxes that no ray meets, and lead to the first block, which could do no harm.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(in crate::scene) struct Node {
    /// Low and high sides of the children's boxes on each axis.
    pub sides: [[[f32; WIDTH]; 2]; 3],
    /// Which nodes, or which blocks if [`BLOCK`] is set.
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

/// The corners of up to eight triangles: corner, axis, triangle. Those that are not there are not numbers, which no ray
/// meets.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(in crate::scene) struct Block {
    pub corners: [[[f32; WIDTH]; 3]; 3],
}

/// The normals of a block's triangles: axis, triangle. Apart from the corners, as few rays come to need them.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(in crate::scene) struct Normals {
    pub axes: [[f32; WIDTH]; 3],
}

/// The hierarchy. Without nodes where there are no triangles.
#[derive(Clone, Debug, Default)]
pub(in crate::scene) struct Wide {
    pub nodes: Vec<Node>,
    pub blocks: Vec<Block>,
    pub normals: Vec<Normals>,
    /// The first triangle of each block.
    pub firsts: Vec<u32>,
    /// The largest coordinate's size on each axis.
    pub reach: Vec3A,
    /// Levels of nodes.
    pub depth: usize,
}

impl Wide {
    /// Of the trees that put up to eight nodes of a binary tree under one, that which costs rays least (as in section
    /// 3.1 of Ylitie, Karras and Laine 2017), found for parts of at most so many triangles, one after the other: what is
    /// needed to find it takes as much memory as what comes of it.
    pub fn new(tree: &Tree, part_max: u32, corners: impl Fn(u32) -> [[f32; 3]; 3] + Sync) -> Self {
        // Grown step by step they would be copied, and there twice. What is not used of it takes no memory.
        let [node_count, block_count] =
            [TRIANGLES_A_NODE, TRIANGLES_A_BLOCK].map(|each| tree.root().count as usize / each + 1);
        let mut made = Self {
            nodes: room_in_large_pages(node_count),
            blocks: room_in_large_pages(block_count),
            normals: room_in_large_pages(block_count),
            firsts: Vec::with_capacity(block_count),
            ..Self::default()
        };
        made.nodes.push(Node::EMPTY);
        let bounds = Parts {
            tree,
            part_max,
            corners,
        }
        .fill(&mut made, tree.root(), 0, 1);
        made.reach = bounds.min.abs().max(bounds.max.abs());
        Self {
            nodes: in_large_pages(made.nodes),
            blocks: in_large_pages(made.blocks),
            normals: in_large_pages(made.normals),
            ..made
        }
    }

    /// Has the processor fetch a child, given as a node has it.
    #[inline(always)]
    pub fn prefetch(&self, child: u32) {
        if child & BLOCK == 0 {
            prefetch(&self.nodes, child as usize);
        } else {
            prefetch(&self.blocks, (child & !BLOCK) as usize);
        }
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..])
            + size_of_val(&self.blocks[..])
            + size_of_val(&self.normals[..])
            + size_of_val(&self.firsts[..])
    }
}

/// How a subtree is best cut into up to eight, by the surface area heuristic.
#[derive(Clone, Copy, Default)]
struct Cut {
    /// Of the subtree as 1 to 7 children, the first as one: a node or a block.
    costs: [f32; WIDTH - 1],
    /// How many of so many children are on the left, 0 where fewer children are better; the first for the eight of a
    /// node of its own.
    lefts: [u8; WIDTH - 1],
    /// Whether it is a block when it is one child.
    is_block: bool,
}

impl Cut {
    /// The cost of a subtree as up to so many children.
    fn cost(cuts: &[Self], tree: &BoxedTree<'_>, node: Subtree, children: usize) -> f32 {
        match node.count {
            1 => tree.bounds(node).half_area() * BLOCK_COST,
            _ => cuts[tree.place(node)].costs[children - 1],
        }
    }
}

/// The best cut of each inner node.
fn cuts(tree: &BoxedTree<'_>) -> Vec<Cut> {
    let mut cuts = vec![Cut::default(); tree.inner_count()];
    for node in tree.children_first() {
        let [left, right] = tree.tree.sides(node);
        // Of so many children the number on the left that costs least.
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
        cuts[tree.place(node)] = cut;
    }
    cuts
}

/// A hierarchy in the making, part by part.
struct Parts<'a, F> {
    tree: &'a Tree,
    part_max: u32,
    corners: F,
}

impl<F: Fn(u32) -> [[f32; 3]; 3] + Sync> Parts<'_, F> {
    /// Fills the node at `place` with what is below a node of the binary tree; its box.
    fn fill(&self, made: &mut Wide, root: Subtree, place: usize, depth: usize) -> Aabb {
        if root.count <= self.part_max {
            let boxed = BoxedTree::new(self.tree, root, &self.corners);
            let mut builder = Builder {
                cuts: cuts(&boxed),
                tree: &boxed,
                corners: &self.corners,
                made,
            };
            builder.build(place, depth);
            return *boxed.bounds(root);
        }
        let children = self.children(root);
        let first = made.nodes.len();
        made.nodes.resize(first + children.len(), Node::EMPTY);
        let mut whole = Aabb::INVALID;
        for (slot, child) in children.into_iter().enumerate() {
            let bounds = self.fill(made, child, first + slot, depth + 1);
            made.nodes[place].set(slot, &bounds, (first + slot) as u32);
            whole = whole.union(&bounds);
        }
        whole
    }

    /// Up to eight children of a node that is more than a part: the largest are cut until there are eight, or all are
    /// parts.
    fn children(&self, root: Subtree) -> Vec<Subtree> {
        let mut children = self.tree.sides(root).to_vec();
        while children.len() < WIDTH {
            let largest = (0..children.len()).max_by_key(|&child| children[child].count);
            let Some(child) = largest.filter(|&child| children[child].count > self.part_max) else {
                break;
            };
            let sides = self.tree.sides(children[child]);
            children.splice(child..=child, sides);
        }
        children
    }
}

/// A part of a hierarchy in the making.
struct Builder<'a, F> {
    tree: &'a BoxedTree<'a>,
    cuts: Vec<Cut>,
    corners: F,
    made: &'a mut Wide,
}

impl<F: Fn(u32) -> [[f32; 3]; 3]> Builder<'_, F> {
    /// Fills the node at `place`, on this level, with the whole part.
    fn build(&mut self, place: usize, depth: usize) {
        let root = self.tree.root;
        if self.is_block(root) {
            let block = self.block(root);
            self.made.nodes[place].set(0, self.tree.bounds(root), block);
            self.made.depth = self.made.depth.max(depth);
            return;
        }
        let mut open = vec![(root, place, depth)];
        while let Some((node, place, depth)) = open.pop() {
            self.made.depth = self.made.depth.max(depth);
            // Siblings lie together, then what is below the first of them, and so on.
            let inner = self.children(node, place);
            open.extend(inner.into_iter().rev().map(|(node, place)| (node, place, depth + 1)));
        }
    }

    fn is_block(&self, node: Subtree) -> bool {
        node.count == 1 || self.cuts[self.tree.place(node)].is_block
    }

    /// Fills a node; its children that are nodes, with their places.
    fn children(&mut self, node: Subtree, place: usize) -> Vec<(Subtree, usize)> {
        let [left, right] = self.tree.tree.sides(node);
        let on_left = usize::from(self.cuts[self.tree.place(node)].lefts[0]);
        let mut children = Vec::with_capacity(WIDTH);
        self.cut(left, on_left, &mut children);
        self.cut(right, WIDTH - on_left, &mut children);
        let mut inner = Vec::new();
        for (slot, &child) in children.iter().enumerate() {
            let index = if self.is_block(child) {
                self.block(child)
            } else {
                inner.push((child, self.made.nodes.len()));
                self.made.nodes.push(Node::EMPTY);
                self.made.nodes.len() as u32 - 1
            };
            self.made.nodes[place].set(slot, self.tree.bounds(child), index);
        }
        inner
    }

    /// Cuts a subtree into so many children, or fewer.
    fn cut(&self, node: Subtree, mut count: usize, children: &mut Vec<Subtree>) {
        let lefts = |count: usize| usize::from(self.cuts[self.tree.place(node)].lefts[count - 1]);
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

    /// Adds a block; its index as a child.
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
        self.made.blocks.push(Block { corners });
        self.made.normals.push(Normals { axes: normals });
        self.made.firsts.push(node.first);
        BLOCK | (self.made.blocks.len() as u32 - 1)
    }
}
