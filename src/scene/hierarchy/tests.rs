//! Hierarchies that are built in parts.

use glam::{DAffine3, DMat3, DVec3};

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

/// A mirrored, stretched and sheared placement.
fn mirrored() -> Placement {
    let turn = |x: f64, y: f64| DMat3::from_euler(glam::EulerRot::XYZ, x, y, 0.3);
    let linear = turn(0.4, 1.1) * DMat3::from_diagonal(DVec3::new(-0.3, 0.7, 0.5)) * turn(-0.6, 0.2);
    Placement::new(DAffine3::from_mat3_translation(linear, DVec3::new(0.3, -0.2, 0.1)))
}

#[test]
fn a_placement_moves_normals_tangents_and_areas_as_it_moves_corners() {
    let placement = mirrored();
    let place = |corner: [f32; 3]| glam::Vec3::from_array(placement.point(corner));
    for corners in triangles() {
        let [a, b, c] = corners.map(glam::Vec3::from_array);
        let (normal, tangent) = ((b - a).cross(c - a).normalize(), (b - a).normalize());
        let [placed_a, placed_b, placed_c] = placement.in_order(corners.map(place));
        let expected = (placed_b - placed_a).cross(placed_c - placed_a).normalize();
        let placed = glam::Vec3::from_array(placement.normal(normal.to_array()));
        assert!(placed.dot(expected) > 0.9999, "{placed} and {expected}");
        for side in [1.0, -1.0] {
            let [x, y, z, placed_side] = placement.tangent(tangent.to_array(), side);
            let along = glam::vec3(x, y, z);
            let expected = (place(b.to_array()) - place(a.to_array())).normalize();
            assert!(along.dot(expected) > 0.9999, "{along} and {expected}");
            let bitangent = side * normal.cross(tangent);
            let expected = place((a + bitangent).to_array()) - place(a.to_array());
            assert!(placed.cross(along).dot(expected) * placed_side > 0.0, "{corners:?}");
        }
    }
    let tripled = Placement::new(DAffine3::from_scale(DVec3::new(3.0, -3.0, 3.0)));
    assert!((tripled.area_scale() - 9.0).abs() < 1e-6, "{}", tripled.area_scale());
}

#[test]
fn an_instance_is_hit_as_its_triangles_one_by_one() {
    let (placement, found) = (mirrored(), triangles());
    let placed: Vec<[[f32; 3]; 3]> = found
        .iter()
        .map(|corners| placement.in_order(corners.map(|corner| placement.point(corner))))
        .collect();
    let wide = |triangles: &[[[f32; 3]; 3]]| {
        let box_of = |triangle: u32| triangle_box(triangles[triangle as usize]);
        let (tree, order) =
            binary::tree(triangles.len() as u32, u32::MAX, box_of, &Loading::default()).expect("not cancelled");
        let wide = Wide::new(&tree, u32::MAX, |triangle| triangles[order[triangle as usize] as usize]);
        (wide, order)
    };
    let ((mesh, order), (flat, order_of_flat)) = (wide(&found), wide(&placed));
    let corners = || placed.iter().flatten();
    let bound = |pick: fn(f32, f32) -> f32| {
        [0, 1, 2].map(|axis| corners().map(|corner| corner[axis]).reduce(pick).unwrap_or_default())
    };
    let (top, _) = wide(&[triangle_of_box([bound(f32::min), bound(f32::max)])]);
    let level = crate::instructions::level();
    let mut met = 0;
    for i in 0..400 {
        let angle = i as f32 * 0.37;
        let origin = [2.0 * angle.cos(), (i % 20) as f32 * 0.05 - 0.5, 2.0 * angle.sin()];
        let target = placed[i % placed.len()][0];
        let direction = [0, 1, 2].map(|axis| target[axis] - origin[axis] + 0.02);
        let frame = RayFrame::new(origin.into(), direction.into());
        let bottom = |_| Bottom {
            wide: &mesh,
            placement: &placement,
            first: 0,
        };
        let hit = top.hit_below::<false>(level, &frame, f32::MAX, bottom);
        let expected = flat.closest_hit(level, &frame, f32::MAX);
        let seen = hit.map(|hit| (hit.t, placed[order[hit.triangle as usize] as usize]));
        let expected = expected.map(|hit| (hit.t, placed[order_of_flat[hit.triangle as usize] as usize]));
        assert_eq!(seen, expected, "ray {i}");
        let any = top.hit_below::<true>(level, &frame, f32::MAX, bottom);
        assert_eq!(any.is_some(), expected.is_some(), "ray {i}");
        met += usize::from(expected.is_some());
    }
    assert!(met > 100, "{met} rays met something");
}
