//! Hierarchies that are built in parts.

use super::*;
use crate::scene::intersect::RayFrame;

/// Small triangles anywhere in the unit ball, and some in the same place.
fn triangles() -> Vec<[[f32; 3]; 3]> {
    let mut state = 7_u32;
    let mut unit = move || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as f32 / (1 << 24) as f32
    };
    let mut place = move || [unit(), unit(), unit()].map(|x| x - 0.5);
    let mut triangles: Vec<[[f32; 3]; 3]> = (0..500)
        .map(|_| {
            let middle = place();
            [(); 3].map(|()| {
                let step = place();
                [0, 1, 2].map(|axis| middle[axis] + 0.2 * step[axis])
            })
        })
        .collect();
    triangles.extend(vec![triangles[0]; 40]);
    triangles
}

#[test]
fn parts_hold_every_triangle_once_and_rays_find_the_same_as_without() {
    let found = triangles();
    let box_of = |triangle: u32| triangle_box(found[triangle as usize]);
    let whole = |part_max: u32| {
        let (tree, order) =
            binary::tree(found.len() as u32, part_max, box_of, &Loading::default()).expect("not cancelled");
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().copied().eq(0..found.len() as u32), "parts of {part_max}");
        let wide = Wide::new(&tree, part_max, |triangle| found[order[triangle as usize] as usize]);
        (order, wide)
    };
    let [(order, wide), (order_of_parts, of_parts)] = [u32::MAX, 24].map(whole);
    assert_ne!(order, order_of_parts, "built in parts");
    let level = crate::instructions::level();
    let mut met = 0;
    for i in 0..400 {
        let angle = i as f32 * 0.37;
        let origin = [2.0 * angle.cos(), (i % 20) as f32 * 0.05 - 0.5, 2.0 * angle.sin()];
        let direction = [-origin[0], 0.1 - origin[1], 0.05 - origin[2]];
        let frame = RayFrame::new(origin.into(), direction.into());
        let nearest = |wide: &Wide, order: &[u32]| {
            let hit = wide.closest_hit(level, &frame, f32::MAX)?;
            Some((hit.t, found[order[hit.triangle as usize] as usize]))
        };
        let (expected, of_parts) = (nearest(&wide, &order), nearest(&of_parts, &order_of_parts));
        assert_eq!(expected, of_parts, "ray {i}");
        met += usize::from(expected.is_some());
    }
    assert!(met > 100, "{met} rays met something");
}

#[test]
fn a_hierarchy_that_nobody_wants_is_not_built() {
    let found = triangles();
    let loading = Loading::default();
    loading.cancel();
    let built = Hierarchy::new(found.len(), |triangle| found[triangle as usize], &loading);
    assert!(built.is_err());
    loading.begin();
    assert!(Hierarchy::new(found.len(), |triangle| found[triangle as usize], &loading).is_ok());
    assert!(loading.doing().contains("hierarchy"), "{}", loading.doing());
}

/// Hierarchies too deep for the traversal stack are rebuilt: their depth must be right.
#[test]
fn levels_are_counted_to_the_deepest() {
    let found = triangles();
    let box_of = |triangle: u32| triangle_box(found[triangle as usize]);
    let (tree, order) = binary::tree(found.len() as u32, u32::MAX, box_of, &Loading::default()).expect("not cancelled");
    let corners = |triangle: u32| found[order[triangle as usize] as usize];
    let built = compressed::compress(&BoxedTree::new(&tree, tree.root(), corners));
    // Two levels of eight children hold 64 leaves of three triangles.
    let depth = compressed::depth(&built);
    assert!(
        (3..DEPTH_MAX).contains(&depth),
        "{depth} levels of {} triangles",
        found.len()
    );
}
