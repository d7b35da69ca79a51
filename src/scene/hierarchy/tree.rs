//! A binary tree over triangles that are stored in the order of its leaves: what both engines' hierarchies are made of.

use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use rayon::prelude::*;

use super::triangle_box;

/// A binary tree over triangles, which are its leaves from left to right. Four bytes a triangle: boxes are found again
/// from the triangles whenever a hierarchy is made of it.
#[derive(Clone, Debug, Default)]
pub(in crate::scene) struct Tree {
    /// How many leaves each inner node has on its left: parents before children, left before right.
    pub(super) left_leaves: Vec<u32>,
}

/// A node with all that is below it.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::scene) struct Subtree {
    /// Its number among the inner nodes; nothing for a single leaf.
    inner: u32,
    /// The first of its leaves.
    pub first: u32,
    /// Its leaves.
    pub count: u32,
}

impl Tree {
    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.left_leaves[..])
    }

    /// The tree of a hierarchy whose leaves have one triangle each, and the order of its leaves.
    pub fn of(binary: &Bvh2) -> (Self, Vec<u32>) {
        let mut order = Vec::with_capacity(binary.primitive_indices.len());
        let mut left_leaves: Vec<u32> = Vec::with_capacity(binary.nodes.len() / 2);
        // Nodes still to be visited, right children with the parent whose left side is then complete.
        let mut open = vec![(0, None)];
        while let Some((node, parent)) = open.pop() {
            if let Some(parent) = parent {
                left_leaves[parent] = order.len() as u32 - left_leaves[parent];
            }
            let node = &binary.nodes[node as usize];
            if node.is_leaf() {
                order.push(binary.primitive_indices[node.first_index as usize]);
                continue;
            }
            open.push((node.first_index + 1, Some(left_leaves.len())));
            open.push((node.first_index, None));
            left_leaves.push(order.len() as u32);
        }
        (Self { left_leaves }, order)
    }

    /// The tree over as many triangles that halves them again and again.
    pub fn of_halves(&self) -> Self {
        let mut left_leaves = Vec::with_capacity(self.left_leaves.len());
        let mut open = vec![self.root().count];
        while let Some(count) = open.pop() {
            if count > 1 {
                left_leaves.push(count / 2);
                open.extend([count - count / 2, count / 2]);
            }
        }
        Self { left_leaves }
    }

    /// All of a tree that has leaves.
    pub fn root(&self) -> Subtree {
        Subtree {
            inner: 0,
            first: 0,
            count: self.left_leaves.len() as u32 + 1,
        }
    }

    /// Both sides of a node that is no leaf.
    pub fn sides(&self, node: Subtree) -> [Subtree; 2] {
        let left = self.left_leaves[node.inner as usize];
        [
            Subtree {
                inner: node.inner + 1,
                first: node.first,
                count: left,
            },
            Subtree {
                inner: node.inner + left,
                first: node.first + left,
                count: node.count - left,
            },
        ]
    }
}

/// A part of a tree with the boxes of its nodes.
pub(in crate::scene) struct BoxedTree<'a> {
    pub tree: &'a Tree,
    /// All of the part.
    pub root: Subtree,
    /// Its inner nodes, parents before children.
    inner: Vec<Subtree>,
    /// Their boxes.
    inner_boxes: Vec<Aabb>,
    /// The triangles' boxes.
    leaf_boxes: Vec<Aabb>,
}

impl<'a> BoxedTree<'a> {
    /// All below a node; `corners` of the triangles as they are stored.
    pub fn new(tree: &'a Tree, root: Subtree, corners: impl Fn(u32) -> [[f32; 3]; 3] + Sync) -> Self {
        let triangles = (root.first..root.first + root.count).into_par_iter();
        let mut inner = vec![Subtree::default(); root.count as usize - 1];
        let mut boxed = Self {
            tree,
            root,
            inner_boxes: vec![Aabb::INVALID; inner.len()],
            leaf_boxes: triangles.map(|triangle| triangle_box(corners(triangle))).collect(),
            inner: Vec::new(),
        };
        if let Some(first) = inner.first_mut() {
            *first = root;
        }
        for node in 0..inner.len() {
            for side in tree.sides(inner[node]).into_iter().filter(|side| side.count > 1) {
                inner[boxed.place(side)] = side;
            }
        }
        for node in inner.iter().rev() {
            let [left, right] = tree.sides(*node).map(|side| *boxed.bounds(side));
            let place = boxed.place(*node);
            boxed.inner_boxes[place] = left.union(&right);
        }
        Self { inner, ..boxed }
    }

    /// The inner nodes, children before parents.
    pub fn children_first(&self) -> impl Iterator<Item = Subtree> {
        self.inner.iter().rev().copied()
    }

    /// How many inner nodes there are.
    pub fn inner_count(&self) -> usize {
        self.inner.len()
    }

    /// The number of an inner node among those of the part.
    pub fn place(&self, node: Subtree) -> usize {
        (node.inner - self.root.inner) as usize
    }

    /// The box of a node.
    pub fn bounds(&self, node: Subtree) -> &Aabb {
        match node.count {
            1 => &self.leaf_boxes[(node.first - self.root.first) as usize],
            _ => &self.inner_boxes[self.place(node)],
        }
    }
}
