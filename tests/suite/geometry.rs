//! Built-in meshes, geometry made ready to trace, and rays against it.

use std::collections::HashMap;

use glam::{DVec3, Vec2, Vec4};
use glossmith::{
    import::load,
    scene::{Geometry, Loading, Model, ModelSource, Slot, mesh::Mesh, mesh::plane_normal, teapot},
};

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
            near!(normal.length(), 1.0, 1e-6, "{source}");
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
            .any(|p| (p.y - 2.4).abs() < 1e-12 && (p.x.hypot(p.z) - 1.4).abs() < 0.01),
        "rim"
    );
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
    near!(sphere.signed_volume() / expected, 1.0, 0.001);
    assert!(ball.positions.iter().all(|p| p.y > -1e-9), "the ball stands on y = 0");
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
