//! Rays through the processor's hierarchy: each instruction set against exact arithmetic and
//! against the others.

use fearless_simd::Level;
use glam::{DMat4, DQuat, DVec3, EulerRot, Vec3, Vec4};
use glossmith::{
    import::load,
    instructions::Instructions,
    scene::{
        Geometry, Hit, MeshInstance, Model, ModelSource, PACKET, Packet, Slot, mesh::Mesh, ray_octant, shapes, teapot,
    },
};
use rayon::prelude::*;

use super::support::{Random, sets};

fn model_of(mesh: Mesh) -> Model {
    Model {
        mesh,
        slots: vec![Slot::neutral("only")],
        ..Model::default()
    }
}

struct Ray {
    origin: [f32; 3],
    direction: [f32; 3],
    t_max: f32,
}

/// From inside, from outside and from far away; to anywhere, to vertices and edges, along axes with zeros of either sign.
fn random_ray(random: &mut Random, geometry: &Geometry) -> Ray {
    let distance = [1.0, 4.0, 1000.0][random.below(3)];
    let mut origin = random.in_ball() * distance;
    let corners = geometry.corners(random.below(geometry.triangle_count()));
    let [a, b, _] = corners.map(Vec3::from_array);
    let target = match random.below(4) {
        0 => a,
        1 => a.lerp(b, random.unit()),
        _ => random.in_ball(),
    };
    let mut direction = target - origin;
    if random.below(6) == 0 {
        let axis = random.below(3);
        let signs = [0, 1, 2].map(|_| if random.below(2) == 0 { 1.0_f32 } else { -1.0 });
        let along = [0, 1, 2].map(|i| if i == axis { signs[i] } else { 0.0 * signs[i] });
        direction = along.into();
        origin = target - direction * distance;
    } else if random.below(2) == 0 {
        direction = direction.normalize();
    }
    let t_max = if random.below(4) == 0 {
        random.unit() * 2.0
    } else {
        f32::MAX
    };
    Ray {
        origin: origin.into(),
        direction: direction.into(),
        t_max,
    }
}

fn geometries() -> Vec<(&'static str, Geometry)> {
    vec![
        ("teapot", Geometry::build(&model_of(teapot::mesh(4)), false)),
        (
            "teapot on its ground",
            Geometry::build(&model_of(teapot::mesh(4)), true),
        ),
        ("sphere", Geometry::build(&model_of(shapes::sphere(24, 16)), false)),
        ("needles", Geometry::build(&model_of(needles()), false)),
        ("instances", Geometry::build(&instances(), true)),
        (
            "two triangles",
            Geometry::build(&load(&ModelSource::Plane).unwrap(), false),
        ),
    ]
}

/// A sphere with small teapots about it, turned, stretched and mirrored.
fn instances() -> Model {
    let at = |i: usize| {
        let angle = i as f64;
        let mirrored = if i.is_multiple_of(2) { -1.0 } else { 1.0 };
        DMat4::from_scale_rotation_translation(
            DVec3::new(0.2 * mirrored, 0.1 + 0.05 * (angle % 3.0), 0.3),
            DQuat::from_euler(EulerRot::XYZ, angle, 0.7 * angle, 0.2),
            DVec3::new(1.5 * angle.cos(), 0.5 * (3.0 * angle).sin(), 1.5 * angle.sin()),
        )
    };
    let instance = |i: usize| MeshInstance {
        mesh: usize::from(i == 6),
        world_from_mesh: if i == 6 { DMat4::IDENTITY } else { at(i) },
        object: i,
    };
    Model {
        repeated: vec![teapot::mesh(2), shapes::sphere(24, 16)],
        instances: (0..7).map(instance).collect(),
        ..model_of(Mesh::default())
    }
}

/// A fan of triangles ten thousand times as long as wide, and one that is there nine times.
fn needles() -> Mesh {
    let mut mesh = Mesh::default();
    let mut add = |corners: [DVec3; 3]| {
        let vertices = corners.map(|corner| mesh.push_vertex(corner, Vec3::Z, glam::Vec2::ZERO, Vec4::X + Vec4::W));
        mesh.push_triangle(vertices, 0);
    };
    for i in 0..200 {
        let angle = f64::from(i) * 0.031;
        let end = DVec3::new(angle.cos(), angle.sin(), 0.3 * (7.0 * angle).sin());
        add([DVec3::ZERO, end, end + DVec3::new(0.0, 0.0, 0.0001)]);
    }
    for _ in 0..9 {
        add([
            DVec3::new(0.0, 0.0, -0.5),
            DVec3::new(0.4, 0.0, -0.5),
            DVec3::new(0.0, 0.4, -0.5),
        ]);
    }
    mesh
}

/// What the ray meets, for certain, by arithmetic in f64: the nearest t, or nothing; `None` where a triangle's edge, its
/// plane or the end of the ray is so near that rounding may say otherwise.
fn exact(geometry: &Geometry, ray: &Ray) -> Option<Option<f64>> {
    let [origin, direction] = [ray.origin, ray.direction].map(|v| DVec3::from_array(v.map(f64::from)));
    let mut nearest = f64::INFINITY;
    for triangle in 0..geometry.triangle_count() {
        let [a, b, c] = geometry.corners(triangle).map(|v| DVec3::from_array(v.map(f64::from)));
        let normal = (b - a).cross(c - a);
        let sine = normal.dot(direction) / (normal.length() * direction.length());
        let t = normal.dot(a - origin) / normal.dot(direction);
        let place = origin + direction * t;
        let share = |p: DVec3, q: DVec3| (p - place).cross(q - place).dot(normal) / normal.length();
        // Signed distances from the edges.
        let distance = |p: DVec3, q: DVec3| share(p, q) / (q - p).length();
        let inside = distance(a, b).min(distance(b, c)).min(distance(c, a));
        let blur = 1e-5 * (1.0 + origin.length());
        let is_edge_on = sine.abs() < 0.001;
        if is_edge_on {
            // Near its plane anything may be said of it: is it anywhere near the ray at all?
            let nearest_along = |p: DVec3| (p - origin).cross(direction).length() / direction.length();
            let size = (b - a).length().max((c - a).length());
            if nearest_along(a) < size + blur {
                return None;
            }
            continue;
        }
        if inside.abs() * sine.abs() < blur {
            return None;
        }
        if inside > 0.0 {
            let margin = 0.0001 * t.abs().max(0.1);
            if t.abs() < margin || (t - f64::from(ray.t_max)).abs() < margin {
                return None;
            }
            if t > 0.0 && t < f64::from(ray.t_max) {
                nearest = nearest.min(t);
            }
        }
    }
    Some((nearest < f64::INFINITY).then_some(nearest))
}

#[test]
fn every_instruction_set_meets_what_exact_arithmetic_meets() {
    for (name, geometry) in geometries() {
        let mut random = Random::new(21);
        let rays: Vec<Ray> = (0..6_000).map(|_| random_ray(&mut random, &geometry)).collect();
        let sets = sets();
        let compare = |ray: &Ray| {
            let Some(expected) = exact(&geometry, ray) else {
                return (0, 0);
            };
            for (set, level) in &sets {
                let hit = geometry.intersect_by(*level, ray.origin, ray.direction, ray.t_max);
                let is_occluded = geometry.occluded_by(*level, ray.origin, ray.direction, ray.t_max);
                let t = hit.map(|hit| f64::from(hit.t));
                let agrees = match (t, expected) {
                    (Some(t), Some(expected)) => (t - expected).abs() < 0.0001 * expected.max(1.0),
                    (t, expected) => t.is_none() && expected.is_none(),
                };
                assert!(
                    agrees && is_occluded == expected.is_some(),
                    "{name}, {set}: {t:?}, occluded {is_occluded} instead of {expected:?} from {:?} along {:?}",
                    ray.origin,
                    ray.direction
                );
            }
            (1, usize::from(expected.is_some()))
        };
        let counts: Vec<(usize, usize)> = rays.par_iter().map(compare).collect();
        let (compared, met) = counts.iter().fold((0, 0), |all, one| (all.0 + one.0, all.1 + one.1));
        println!("{name}: {compared} rays compared, {met} of them met something");
        assert!(
            compared > 600 && met > 9,
            "{name}: {compared} compared, {met} met something"
        );
    }
}

/// As bits, so that nothing but the very same numbers is the same.
fn bits(hit: Option<Hit>) -> Option<[u32; 4]> {
    hit.map(|hit| [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.triangle])
}

#[test]
fn all_instruction_sets_give_the_same_bits() {
    let mut geometries = geometries();
    geometries.push(("fine teapot", Geometry::build(&model_of(teapot::mesh(25)), true)));
    for (name, geometry) in geometries {
        let mut random = Random::new(5);
        let rays: Vec<Ray> = (0..100_000).map(|_| random_ray(&mut random, &geometry)).collect();
        let outcome = |ray: &Ray| {
            let mut outcomes = sets().into_iter().map(|(_, level)| {
                let hit = geometry.intersect_by(level, ray.origin, ray.direction, ray.t_max);
                let is_occluded = geometry.occluded_by(level, ray.origin, ray.direction, ray.t_max);
                assert_eq!(
                    is_occluded,
                    hit.is_some(),
                    "{name}: {:?} {:?}",
                    ray.origin,
                    ray.direction
                );
                hit
            });
            let hit = outcomes.next().flatten();
            assert!(
                outcomes.all(|other| bits(other) == bits(hit)),
                "{name}: other bits than {hit:?}"
            );
            hit.is_some()
        };
        let met = rays.par_iter().filter(|ray| outcome(ray)).count();
        assert!(met > 10_000, "{name}: only {met} rays met something");
    }
}

/// Sixteen rays or fewer that go the same way, near each other or not; now and then one that goes another way.
fn random_packet(random: &mut Random, geometry: &Geometry) -> (Packet, usize) {
    let first = random_ray(random, geometry);
    let spread = [0.0001, 0.05, 1.0][random.below(3)];
    let has_stray = random.below(20) == 0;
    let count = 1 + random.below(PACKET);
    let mut packet = Packet::default();
    packet.set(0, first.origin, first.direction, first.t_max);
    for lane in 1..count {
        let mut ray = random_ray(random, geometry);
        let moved = |from: [f32; 3], by: glam::Vec3| (Vec3::from_array(from) + by * spread).to_array();
        for _ in 0..20 {
            ray.direction = moved(first.direction, random.in_ball());
            if has_stray || ray_octant(ray.direction) == ray_octant(first.direction) {
                break;
            }
            ray.direction = first.direction;
        }
        if random.below(4) > 0 {
            ray.origin = moved(first.origin, random.in_ball());
        }
        packet.set(lane, ray.origin, ray.direction, ray.t_max);
    }
    packet.fill(count);
    (packet, count)
}

/// A ray finds the same in a packet as alone, under every instruction set, to the last bit.
#[test]
fn rays_meet_the_same_in_packets_as_alone() {
    let mut geometries = geometries();
    geometries.push(("fine teapot", Geometry::build(&model_of(teapot::mesh(25)), true)));
    for (name, geometry) in geometries {
        let mut random = Random::new(17);
        let (mut met, mut rays) = (0, 0);
        for _ in 0..4_000 {
            let (packet, count) = random_packet(&mut random, &geometry);
            let outcomes = sets().into_iter().map(|(_, level)| {
                let hits = geometry.intersect_packet(level, &packet);
                (hits, geometry.occluded_packet(level, &packet))
            });
            let outcomes: Vec<_> = outcomes.collect();
            let (hits, hidden) = outcomes[0];
            for (others, others_hidden) in &outcomes {
                assert_eq!(
                    others.map(bits),
                    hits.map(bits),
                    "{name}: other bits under other instructions"
                );
                assert_eq!(*others_hidden, hidden, "{name}: other shadows under other instructions");
            }
            for lane in 0..PACKET {
                let (origin, direction) = (packet.origin(lane), packet.direction(lane));
                let alone = geometry.intersect_by(Level::new(), origin, direction, packet.t_max[lane]);
                assert!(lane < count || hits[lane].is_none(), "{name}: there is no ray {lane}");
                assert_eq!(
                    bits(hits[lane]),
                    bits(alone),
                    "{name}: other in company: {packet:?}, {lane}"
                );
                assert_eq!(
                    hidden[lane],
                    alone.is_some(),
                    "{name}: hidden in company: {packet:?}, {lane}"
                );
                met += usize::from(alone.is_some());
            }
            rays += count;
        }
        println!("{name}: {met} of {rays} rays met something");
        assert!(met > rays / 100, "{name}: {met} of {rays} rays met something");
    }
}

#[test]
fn rays_that_are_no_rays_meet_nothing() {
    let sphere = Geometry::build(&load(&ModelSource::Sphere).unwrap(), true);
    let empty = Geometry::build(&model_of(Mesh::default()), false);
    let nan = f32::NAN;
    for (set, level) in sets() {
        for direction in [[0.0; 3], [nan, 0.0, 1.0], [nan; 3], [f32::INFINITY, 0.0, 0.0]] {
            let hit = sphere.intersect_by(level, [0.0; 3], direction, f32::MAX);
            assert_eq!(hit, None, "{set}: {direction:?}");
            let mut packet = Packet::default();
            packet.set(0, [0.0; 3], direction, f32::MAX);
            packet.fill(1);
            assert_eq!(
                sphere.intersect_packet(level, &packet),
                [None; PACKET],
                "{set}: {direction:?}"
            );
        }
        for origin in [[nan, 0.0, 0.0], [f32::INFINITY; 3]] {
            let hit = sphere.intersect_by(level, origin, [0.0, 0.0, 1.0], f32::MAX);
            assert_eq!(hit, None, "{set}: from {origin:?}");
        }
        assert_eq!(
            empty.intersect_by(level, [0.0; 3], [0.0, 0.0, 1.0], f32::MAX),
            None,
            "{set}"
        );
        assert!(!empty.occluded_by(level, [0.0; 3], [0.0, 0.0, 1.0], f32::MAX), "{set}");
    }
}

#[test]
fn instruction_sets_that_are_missing_are_named_with_those_that_are_there() {
    let (here, missing): (Vec<_>, Vec<_>) = Instructions::ALL.iter().partition(|set| set.level().is_some());
    assert!(here.contains(&&Instructions::Auto) && here.contains(&&Instructions::Portable));
    // No processor has both.
    assert!(missing.contains(&&Instructions::Neon) || missing.contains(&&Instructions::Avx2));
    for set in missing {
        let message = set.force().expect_err("it is missing").to_string();
        assert!(
            message.contains(set.label()) && message.contains("portable"),
            "{message}"
        );
    }
}
