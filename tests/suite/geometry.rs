//! Built-in meshes, geometry made ready to trace, and rays against it.

use std::collections::HashMap;

use glam::{DVec3, Vec2, Vec3, Vec3A, Vec4};
use glossmith::import::load;
use glossmith::scene::mesh::{Mesh, plane_normal};
use glossmith::scene::{
    Geometry, Hit, Loading, Model, ModelSource, RayFrame, Slot, intersect_triangle, shapes, teapot,
};

use super::support::Random;

const BUILT_IN: [ModelSource; 4] = [
    ModelSource::Teapot,
    ModelSource::Sphere,
    ModelSource::Plane,
    ModelSource::Shaderball,
];

fn built_in(source: &ModelSource) -> Model {
    load(source).expect("built-in models load")
}

fn model_of(mesh: Mesh) -> Model {
    Model {
        mesh,
        slots: vec![Slot::neutral("only")],
        ..Model::default()
    }
}

fn mesh_of_triangles(corners: &[[DVec3; 3]]) -> Mesh {
    let mut mesh = Mesh::default();
    for triangle in corners {
        let normal = plane_normal(*triangle).as_vec3();
        let vertices = triangle.map(|corner| mesh.push_vertex(corner, normal, Vec2::ZERO, Vec4::X + Vec4::W));
        mesh.triangles.push(vertices);
        mesh.slots.push(0);
    }
    mesh
}

fn part(mesh: &Mesh, slot: u32) -> Mesh {
    let mut part = mesh.clone();
    let mut keep = part.slots.iter().map(|&s| s == slot);
    part.triangles.retain(|_| keep.next().unwrap_or(false));
    part.slots.retain(|&s| s == slot);
    part
}

/// How often each edge between two places is used, forwards minus backwards and in all.
fn edges(mesh: &Mesh) -> HashMap<([u64; 3], [u64; 3]), (i32, u32)> {
    let mut edges = HashMap::new();
    for triangle in 0..mesh.triangles.len() {
        let corners = mesh
            .corners(triangle)
            .map(|corner| (corner + 0.0).to_array().map(f64::to_bits));
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            let (key, direction) = if a < b { ((a, b), 1) } else { ((b, a), -1) };
            let uses: &mut (i32, u32) = edges.entry(key).or_default();
            *uses = (uses.0 + direction, uses.1 + 1);
        }
    }
    edges
}

#[test]
fn built_in_meshes_have_unit_frames_that_agree_with_their_triangles() {
    for source in BUILT_IN {
        let mesh = built_in(&source).mesh;
        let count = mesh.positions.len();
        assert_eq!(
            [mesh.normals.len(), mesh.uvs.len(), mesh.tangents.len()],
            [count; 3],
            "{source}"
        );
        assert_eq!(mesh.slots.len(), mesh.triangles.len(), "{source}");
        for (normal, tangent) in mesh.normals.iter().zip(&mesh.tangents) {
            assert!((normal.length() - 1.0).abs() < 1e-6, "{source}: normal {normal}");
            let direction = tangent.truncate();
            assert!(
                (direction.length() - 1.0).abs() < 1e-5 && tangent.w.abs() == 1.0,
                "{source}: tangent {tangent}"
            );
            assert!(
                normal.dot(direction).abs() < 0.02,
                "{source}: {normal} is not perpendicular to {direction}"
            );
        }
        for triangle in 0..mesh.triangles.len() {
            let flat = plane_normal(mesh.corners(triangle)).as_vec3();
            for vertex in mesh.triangles[triangle] {
                let normal = mesh.normals[vertex as usize];
                assert!(
                    normal.dot(flat) > 0.5,
                    "{source}: triangle {triangle} faces {flat}, its vertex {normal}"
                );
            }
        }
    }
}

#[test]
fn generated_tangents_are_the_analytic_ones() {
    for source in BUILT_IN {
        let mesh = built_in(&source).mesh;
        let mut generated = mesh.clone();
        generated.generate_tangents([1.0, 0.0, 0.0, 0.0, 1.0, 0.0], &Loading::default());
        assert_eq!(
            generated.positions.len(),
            mesh.positions.len(),
            "{source}: nothing is mirrored"
        );
        // At a pole the direction of u depends on the column, the average over triangles lies between two columns.
        let mut used = vec![false; mesh.positions.len()];
        mesh.triangles
            .iter()
            .flatten()
            .for_each(|&vertex| used[vertex as usize] = true);
        let mut differing = 0;
        for (vertex, (expected, actual)) in mesh.tangents.iter().zip(&generated.tangents).enumerate() {
            if used[vertex] {
                assert_eq!(
                    expected.w, actual.w,
                    "{source}: handedness at {}",
                    mesh.positions[vertex]
                );
                differing += usize::from(expected.truncate().dot(actual.truncate()) < 0.98);
            }
        }
        assert!(
            differing * 50 < mesh.positions.len(),
            "{source}: {differing} of {}",
            mesh.positions.len()
        );
    }
}

#[test]
fn the_teapot_is_where_it_should_be() {
    let mesh = built_in(&ModelSource::Teapot).mesh;
    // 32 + 5 patches of 24 × 24 × 2, less the 24 in each of the 8 patches at a pole and at both corners of the spout's
    // stop that shrink to lines.
    assert_eq!(mesh.triangles.len(), 37 * 24 * 24 * 2 - 10 * 24);
    let low = mesh.positions.iter().copied().reduce(DVec3::min).expect("vertices");
    let high = mesh.positions.iter().copied().reduce(DVec3::max).expect("vertices");
    // Spout to +X, lid's knob on top, bottom at 0.
    assert!(
        low.y.abs() < 1e-12 && (high.y - 3.15).abs() < 1e-9,
        "from {low} to {high}"
    );
    assert!(
        (high.x - 3.434).abs() < 0.01 && low.x < -2.9 && (low.z + high.z).abs() < 1e-12,
        "from {low} to {high}"
    );
    assert!(
        mesh.positions
            .iter()
            .any(|p| (p.y - 2.4).abs() < 1e-12 && (p.x.hypot(p.z) - 1.4).abs() < 1e-2),
        "rim"
    );
    let mut poles = 0;
    for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
        if position.x == 0.0 && position.z == 0.0 {
            let expected = if position.y > 1.0 { Vec3::Y } else { -Vec3::Y };
            assert!(
                normal.distance(expected) < 1e-6,
                "normal {normal} at the pole {position}"
            );
            poles += 1;
        }
    }
    assert_eq!(poles, 8 * 25, "vertices at the two poles");
}

#[test]
fn teapot_patches_join_without_cracks() {
    for segments in [2, 7, 25] {
        let mesh = teapot::mesh(segments);
        let edges = edges(&mesh);
        let open = edges.values().filter(|uses| uses.1 == 1).count();
        // 6 borders of patches are open: the ends of spout and handle inside the pot.
        assert_eq!(open, 6 * segments as usize, "{segments} segments");
        assert!(
            edges.values().all(|uses| *uses == (0, 2) || uses.1 == 1),
            "{segments} segments"
        );
    }
    let mesh = built_in(&ModelSource::Teapot).mesh;
    let mut normal_at: HashMap<[u64; 3], Vec3> = HashMap::new();
    let (mut shared, mut creased) = (0, 0);
    for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
        let place = (*position + 0.0).to_array().map(f64::to_bits);
        let first = *normal_at.entry(place).or_insert(*normal);
        shared += 1;
        creased += usize::from(first.distance(*normal) > 1e-6);
    }
    assert!(
        shared > 2000 && creased * 4 < shared,
        "{creased} of {shared} vertices have another normal"
    );
}

#[test]
fn closed_shapes_are_closed_and_face_outwards() {
    let sphere = built_in(&ModelSource::Sphere).mesh;
    let ball = built_in(&ModelSource::Shaderball).mesh;
    for (name, mesh) in [
        ("sphere", &sphere),
        ("body", &part(&ball, 0)),
        ("stand", &part(&ball, 1)),
    ] {
        let unmatched = edges(mesh).values().filter(|uses| uses.0 != 0 || uses.1 != 2).count();
        assert_eq!(unmatched, 0, "{name}: edges that are not shared by two triangles");
        assert!(mesh.signed_volume() > 0.1, "{name}: volume {}", mesh.signed_volume());
    }
    let expected = 4.0 / 3.0 * std::f64::consts::PI;
    assert!(
        (sphere.signed_volume() / expected - 1.0).abs() < 1e-3,
        "volume {}",
        sphere.signed_volume()
    );
    assert!(ball.positions.iter().all(|p| p.y > -1e-9), "the ball stands on y = 0");
}

#[test]
fn tessellation_scales_linearly() {
    let seconds = |segments: u32| {
        let start = std::time::Instant::now();
        let mesh = teapot::mesh(segments);
        assert_eq!(
            mesh.triangles.len(),
            (74 * segments * segments - 10 * segments) as usize
        );
        start.elapsed().as_secs_f64()
    };
    seconds(20);
    let (small, large) = (seconds(40), seconds(160));
    // 16 times the triangles; quadratic behaviour would take 256 times as long.
    assert!(
        large < 100.0 * small.max(1e-3),
        "{small} s for 40 segments, {large} s for 160"
    );
}

/// Rays that start inside a closed mesh and go to its vertices and to places on its edges.
fn escaping_rays(geometry: &Geometry, start: impl Fn(&mut Random) -> Vec3, count: usize) -> usize {
    let mut random = Random::new(7);
    let mut escaped = 0;
    for i in 0..count {
        let corners = geometry
            .corners(random.below(geometry.triangle_count()))
            .map(Vec3::from_array);
        let target = match i % 3 {
            0 => corners[0],
            1 => corners[0].lerp(corners[1], random.unit()),
            _ => corners[1].midpoint(corners[2]),
        };
        let origin = start(&mut random);
        escaped += usize::from(
            geometry
                .intersect(origin.into(), (target - origin).into(), f32::INFINITY)
                .is_none(),
        );
    }
    escaped
}

#[test]
fn nothing_leaks_through_edges_and_vertices() {
    let sphere = Geometry::build(&built_in(&ModelSource::Sphere), false);
    let anywhere = |random: &mut Random| random.in_ball() * 0.9;
    assert_eq!(escaping_rays(&sphere, anywhere, 150_000), 0, "from inside a sphere");
    assert_eq!(
        escaping_rays(&sphere, |_| Vec3::ZERO, 50_000),
        0,
        "from the very centre of a sphere"
    );
    // Directions with zeros go along edges of boxes and columns of triangles.
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        for direction in [axis, -axis] {
            assert!(
                sphere.intersect([0.0; 3], direction.into(), f32::INFINITY).is_some(),
                "{direction}"
            );
        }
    }
    let body = model_of(part(&built_in(&ModelSource::Shaderball).mesh, 1));
    let body = Geometry::build(&body, false);
    // Inside the core, which is at the middle of the ball.
    let middle = body.units_from_world(DVec3::new(0.0, 1.12, 0.0)).as_vec3();
    let near = |random: &mut Random| middle + random.in_ball() * 0.5;
    assert_eq!(
        escaping_rays(&body, near, 50_000),
        0,
        "from inside the core of the ball"
    );
}

#[test]
fn neighbours_share_an_edge_to_the_last_bit() {
    let mut random = Random::new(3);
    let mut hits = [0; 3];
    for _ in 0..200_000 {
        let [a, b] = [0; 2].map(|_| Vec3A::from(random.in_ball()));
        let (c, d) = (Vec3A::from(random.in_ball()), Vec3A::from(random.in_ball()));
        let origin = Vec3A::from(random.in_ball()) * 3.0;
        let ray = RayFrame::new(origin, a.lerp(b, random.unit()) - origin);
        // A ray to the common edge ab of two triangles on either side of it as seen from the origin.
        let side = |p: Vec3A| (a - origin).cross(b - origin).dot(p - origin);
        if side(c) * side(d) < 0.0 {
            let found = intersect_triangle(&ray, a, b, c, f32::INFINITY).is_some() as usize
                + intersect_triangle(&ray, b, a, d, f32::INFINITY).is_some() as usize;
            hits[found] += 1;
        }
    }
    assert!(hits[1] > 10_000, "{hits:?}");
    // What is left are ends of the edge, and planes seen so exactly from their side that they have no distance.
    assert!(hits[0] < hits[1] / 1000, "{hits:?}: rays between the two triangles");
}

fn brute_force(geometry: &Geometry, ray: &RayFrame, t_max: f32) -> Option<Hit> {
    let mut nearest: Option<Hit> = None;
    for triangle in 0..geometry.triangle_count() {
        let [v0, v1, v2] = geometry.corners(triangle).map(Vec3A::from_array);
        let limit = nearest.map_or(t_max, |hit| hit.t);
        if let Some((t, u, v)) = intersect_triangle(ray, v0, v1, v2, limit) {
            nearest = Some(Hit {
                t,
                triangle: triangle as u32,
                u,
                v,
            });
        }
    }
    nearest
}

#[test]
fn the_hierarchy_finds_what_brute_force_finds() {
    let meshes = [
        model_of(teapot::mesh(4)),
        model_of(shapes::sphere(24, 16)),
        built_in(&ModelSource::Plane),
    ];
    for (model, ground) in meshes.iter().flat_map(|model| [(model, false), (model, true)]) {
        let geometry = Geometry::build(model, ground);
        let mut random = Random::new(11);
        let mut hits = 0;
        for i in 0..6_000 {
            let origin = random.in_ball() * if i % 2 == 0 { 1.0 } else { 5.0 };
            let towards = random.in_ball() - if i % 4 == 1 { origin } else { Vec3::ZERO };
            let direction = if i % 7 == 0 {
                towards * Vec3::new(1.0, 0.0, 1.0)
            } else {
                towards
            };
            let t_max = if i % 3 == 0 { 1.5 } else { f32::INFINITY };
            let ray = RayFrame::new(origin.into(), direction.into());
            let expected = brute_force(&geometry, &ray, t_max);
            let actual = geometry.intersect(origin.into(), direction.into(), t_max);
            assert_eq!(
                actual.map(|hit| hit.t),
                expected.map(|hit| hit.t),
                "from {origin} along {direction}"
            );
            assert_eq!(
                geometry.occluded(origin.into(), direction.into(), t_max),
                expected.is_some()
            );
            if let Some(hit) = actual {
                hits += 1;
                let [a, b, c] = geometry.corners(hit.triangle as usize).map(Vec3::from_array);
                let place = a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v;
                let error = place.distance(origin + direction * hit.t);
                let size = [a, b, c]
                    .map(|corner| corner.distance(origin))
                    .into_iter()
                    .fold(1.0, f32::max);
                assert!(error < 1e-4 * size, "weights and distance disagree by {error}");
            }
        }
        assert!(hits > 500, "only {hits} rays hit");
    }
}

#[test]
fn hits_of_the_sphere_are_where_they_should_be() {
    let model = model_of(shapes::sphere(512, 256));
    let geometry = Geometry::build(&model, false);
    let mut random = Random::new(5);
    for _ in 0..2000 {
        let origin = random.in_ball() * 0.5;
        let direction = random.in_ball().normalize();
        let hit = geometry
            .intersect(origin.into(), direction.into(), f32::INFINITY)
            .expect("a hit");
        let half = origin.dot(direction);
        let expected = -half + (half * half + 1.0 - origin.length_squared()).sqrt();
        // The chord of a cell is 8e-5 below the sphere.
        assert!((hit.t - expected).abs() < 3e-4, "{} instead of {expected}", hit.t);
    }
}

#[test]
fn broken_triangles_are_left_out_and_counted() {
    let good = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let geometry = Geometry::build(&model_of(Mesh::default()), false);
    assert!(geometry.triangle_count() == 0 && geometry.model.compressed().nodes.is_empty());
    assert_eq!(
        geometry.intersect([0.0, 0.0, -1.0], [0.0, 0.0, 1.0], f32::INFINITY),
        None
    );
    assert!(Geometry::build(&model_of(Mesh::default()), true).occluded([0.0, 1.0, 0.0], [0.1, -1.0, 0.2], 100.0));

    let single = Geometry::build(&model_of(mesh_of_triangles(&[good])), false);
    let center = single.units_from_world(DVec3::new(0.25, 0.25, -1.0)).as_vec3();
    assert!(
        single
            .intersect(center.into(), [0.0, 0.0, 1.0], f32::INFINITY)
            .is_some()
    );

    let broken = [
        [DVec3::ZERO, DVec3::X, DVec3::new(f64::NAN, 0.0, 0.0)],
        [DVec3::ZERO, DVec3::INFINITY, DVec3::Y],
        [DVec3::X; 3],
        [DVec3::ZERO, DVec3::X, DVec3::X * 2.0],
    ];
    // Pairing nearest neighbours takes quadratic time where all are equally near: a minute for these.
    let mut all = vec![good; 100_000];
    all.extend(broken);
    let geometry = Geometry::build(&model_of(mesh_of_triangles(&all)), false);
    assert_eq!((geometry.dropped_not_finite, geometry.dropped_no_area), (2, 2));
    assert_eq!(geometry.warnings().len(), 2, "{:?}", geometry.warnings());
    assert_eq!(geometry.triangle_count(), 100_000);
    assert_eq!(geometry.bounds_world, [DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)]);
    let center = geometry.units_from_world(DVec3::new(0.25, 0.25, -1.0)).as_vec3();
    assert!(
        geometry
            .intersect(center.into(), [0.0, 0.0, 1.0], f32::INFINITY)
            .is_some()
    );
    for direction in [[0.0; 3], [f32::NAN, 0.0, 1.0]] {
        let frame = RayFrame::new(Vec3A::ZERO, direction.into());
        assert_eq!(
            intersect_triangle(&frame, Vec3A::X, Vec3A::Y, Vec3A::Z, f32::INFINITY),
            None
        );
        assert_eq!(geometry.intersect([0.0; 3], direction, f32::INFINITY), None);
    }
}

#[test]
fn the_ground_is_below_and_changes_nothing_else() {
    for source in BUILT_IN {
        let model = built_in(&source);
        let (without, with) = (Geometry::build(&model, false), Geometry::build(&model, true));
        assert_eq!(with.center_world, without.center_world);
        assert_eq!(with.world_units_per_unit, without.world_units_per_unit);
        assert_eq!(with.bounds_world, without.bounds_world);
        assert_eq!(with.triangle_count(), without.triangle_count() + 2);
        let ground = model.slots.len() as u32;
        assert!(without.model.slots.iter().all(|&slot| slot < ground));
        assert_eq!(with.around.slots, [ground; 2]);
        let hit = with
            .intersect([10.0, 3.0, -15.0], [0.0, -1.0, 0.0], f32::INFINITY)
            .expect("the ground");
        assert_eq!(with.slot(hit.triangle as usize), ground);
        let place = with.world_from_units([10.0, 3.0 - hit.t, -15.0]);
        let gap = (without.bounds_world[0].y - place.y) / with.world_units_per_unit;
        assert!(
            (0.5e-4..2e-4).contains(&gap),
            "{source}: the ground is {gap} below the lowest point"
        );
    }
}

#[test]
fn every_triangle_is_in_one_box_of_the_compressed_hierarchy() {
    let geometry = Geometry::build(&built_in(&ModelSource::Teapot), true);
    for (part, first) in geometry.parts() {
        assert_eq!(part.slots.len(), part.triangles.len());
        assert_eq!(part.vertices.len(), part.positions.len());
        let compressed = part.compressed();
        let mut covered = vec![0; part.triangles.len()];
        for node in &compressed.nodes {
            for child in (0..8).filter(|&child| node.is_leaf(child) && !node.is_child_empty(child)) {
                let (start, count) = node.child_primitives(child);
                let aabb = node.child_aabb(child);
                for place in start..start + count {
                    let triangle = compressed.triangles[place as usize] as usize;
                    assert_eq!(geometry.triangle_at(place + first as u32), (triangle + first) as u32);
                    covered[triangle] += 1;
                    for corner in part.corners(triangle).map(Vec3A::from_array) {
                        assert!(aabb.contains_point(corner), "triangle {triangle} is not in its box");
                    }
                }
            }
        }
        assert!(covered.iter().all(|&times| times == 1), "every triangle is in one leaf");
        let is_place = |(triangle, &place): (usize, &u32)| compressed.triangles[place as usize] as usize == triangle;
        assert!(
            compressed.places().iter().enumerate().all(is_place),
            "places are those of the triangles"
        );
    }
    let lengths = geometry.model.positions.iter().map(|&p| Vec3::from_array(p).length());
    let radius = lengths.fold(0.0, f32::max);
    assert!((radius - 1.0).abs() < 1e-6, "bounding radius {radius}");
}

#[test]
fn model_sources_are_written_as_they_are_read() {
    for text in [
        "teapot",
        "sphere",
        "plane",
        "shaderball",
        "still-life",
        "a folder/b.glb",
        "./teapot",
    ] {
        let source = ModelSource::from(text);
        assert_eq!(source.to_string(), text);
        let json = serde_json::to_string(&source).expect("serialises");
        assert_eq!(
            serde_json::from_str::<ModelSource>(&json).expect("deserialises"),
            source
        );
    }
    assert_eq!(ModelSource::File("teapot".into()).to_string(), "./teapot");
}

/// Every part stands on the ground, has a slot of its own, and touches no other.
#[test]
fn the_parts_of_the_still_life_stand_beside_each_other() {
    let model = built_in(&ModelSource::StillLife);
    let names: Vec<&str> = model.slots.iter().map(|slot| slot.name.as_str()).collect();
    assert_eq!(names, ["teapot", "bowl", "ball", "bead"]);
    let places = |part: usize| -> Vec<DVec3> {
        let slots = model
            .mesh
            .slots
            .iter()
            .enumerate()
            .filter(|(_, slot)| **slot as usize == part);
        slots.flat_map(|(triangle, _)| model.mesh.corners(triangle)).collect()
    };
    let parts = [0, 1, 2, 3].map(places);
    for (small, around) in parts.iter().enumerate() {
        let lowest = around.iter().map(|place| place.y).fold(f64::MAX, f64::min);
        assert!(lowest.abs() < 0.01, "{} begins at {lowest}", names[small]);
        let center = around.iter().sum::<DVec3>() / around.len() as f64;
        let away = |places: &[DVec3]| places.iter().map(|place| place.distance(center)).collect::<Vec<_>>();
        let radius = away(around).into_iter().fold(0.0, f64::max);
        for (other, places) in parts[..small].iter().enumerate() {
            let nearest = away(places).into_iter().fold(f64::MAX, f64::min);
            assert!(
                nearest > radius,
                "{} in {}: {nearest} of {radius}",
                names[small],
                names[other]
            );
        }
    }
}
