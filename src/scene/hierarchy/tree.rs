//! The binary tree from which both engines' hierarchies are made. Triangles are stored in the order of its leaves.

use obvhs::{aabb::Aabb, bvh2::Bvh2};

use super::triangle_box;
use crate::parallel;

/// A binary tree with a triangle per leaf, from left to right. It takes four bytes per triangle: boxes are recomputed from
/// the triangles for each hierarchy.
#[derive(Clone, Debug, Default)]
pub struct Tree {
    /// Leaves in each inner node's left subtree. Order: parents before children, left before right.
    pub left_leaves: Vec<u32>,
}

/// A node with its subtree.
#[derive(Clone, Copy, Debug, Default)]
pub struct Subtree {
    /// Index among the inner nodes; meaningless for a leaf.
    inner: u32,
    /// First leaf.
    pub first: u32,
    /// Number of leaves.
    pub count: u32,
}

impl Tree {
    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.left_leaves[..])
    }

    /// Converts a hierarchy with one triangle per leaf. Also returns the order of its leaves.
    pub fn of(binary: &Bvh2) -> (Self, Vec<u32>) {
        let mut order = Vec::with_capacity(binary.primitive_indices.len());
        let mut left_leaves: Vec<u32> = Vec::with_capacity(binary.nodes.len() / 2);
        // Nodes to visit. A right child carries its parent, whose left subtree is then complete.
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

    /// The balanced tree over the same number of triangles.
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

    /// The root. Invariant: the tree has leaves.
    pub fn root(&self) -> Subtree {
        Subtree {
            inner: 0,
            first: 0,
            count: self.left_leaves.len() as u32 + 1,
        }
    }

    /// Left and right subtree of an inner node.
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

/// A subtree with the boxes of its nodes.
pub struct BoxedTree<'a> {
    pub tree: &'a Tree,
    pub root: Subtree,
    /// Inner nodes, parents before children.
    pub inner: Vec<Subtree>,
    /// Boxes of the inner nodes.
    inner_boxes: Vec<Aabb>,
    /// Boxes of the leaves.
    leaf_boxes: Vec<Aabb>,
}

impl<'a> BoxedTree<'a> {
    /// The subtree of `root`; `corners` are those of the triangles as stored.
    pub fn new(tree: &'a Tree, root: Subtree, corners: impl Fn(u32) -> [[f32; 3]; 3] + Sync) -> Self {
        let mut inner = vec![Subtree::default(); root.count as usize - 1];
        let mut boxed = Self {
            tree,
            root,
            inner_boxes: vec![Aabb::INVALID; inner.len()],
            leaf_boxes: parallel::map(root.count as usize, |index| {
                triangle_box(corners(root.first + index as u32))
            }),
            inner: Vec::new(),
        };
        if let Some(first) = inner.first_mut() {
            *first = root;
        }
        for node in 0..inner.len() {
            for side in tree.sides(inner[node]).into_iter().filter(|side| side.count > 1) {
                inner[boxed.inner_index(side)] = side;
            }
        }
        for node in inner.iter().rev() {
            let [left, right] = tree.sides(*node).map(|side| *boxed.bounds(side));
            let index = boxed.inner_index(*node);
            boxed.inner_boxes[index] = left.union(&right);
        }
        Self { inner, ..boxed }
    }

    /// Index of an inner node within the subtree.
    pub fn inner_index(&self, node: Subtree) -> usize {
        (node.inner - self.root.inner) as usize
    }

    /// Box of a node.
    pub fn bounds(&self, node: Subtree) -> &Aabb {
        match node.count {
            1 => &self.leaf_boxes[(node.first - self.root.first) as usize],
            _ => &self.inner_boxes[self.inner_index(node)],
        }
    }
}
