//! The GPU's hierarchy: eight-wide nodes of 80 bytes (CWBVH, Ylitie, Karras and Laine 2017), by obvhs.

use obvhs::{aabb::Aabb, bvh2::Bvh2, bvh2::node::Bvh2Node, cwbvh::CwBvh, cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh};

use super::tree::BoxedTree;

/// Triangles per leaf at most (the format's limit).
const LEAF_TRIANGLES: u32 = 3;

/// Compresses a tree; `primitive_indices` maps leaf entries to triangles.
pub fn compress(tree: &BoxedTree<'_>) -> CwBvh {
    let root = tree.root;
    let mut nodes = vec![Bvh2Node::default()];
    let mut open = vec![(root, 0)];
    while let Some((node, index)) = open.pop() {
        let bounds: Aabb = *tree.bounds(node);
        if node.count == 1 {
            nodes[index] = Bvh2Node::new(bounds, 1, node.first);
            continue;
        }
        let children = nodes.len();
        nodes[index] = Bvh2Node::new(bounds, 0, children as u32);
        nodes.extend([Bvh2Node::default(); 2]);
        open.extend(tree.tree.sides(node).into_iter().zip(children..));
    }
    let binary = Bvh2 {
        nodes,
        primitive_indices: (0..root.count).collect(),
        ..Bvh2::default()
    };
    bvh2_to_cwbvh(&binary, LEAF_TRIANGLES, true, false)
}

/// Levels of nodes.
pub fn depth(compressed: &CwBvh) -> usize {
    let mut deepest = 0;
    let mut open = vec![(0_usize, 1)];
    while let Some((index, level)) = open.pop() {
        let Some(node) = compressed.nodes.get(index) else {
            continue;
        };
        deepest = deepest.max(level);
        let children = node.imask.count_ones() as usize;
        let first = node.child_base_idx as usize;
        open.extend((first..first + children).map(|child| (child, level + 1)));
    }
    deepest
}
