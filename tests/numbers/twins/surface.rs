//! Rays against one triangle, and the surface where they meet it.

use glam::Vec3A;
use glossmith::{
    optics::{material::Material, real::Scalar, vector::Vec3},
    scene::{
        Hit, RayFrame, intersect_triangle,
        surface::{bent_normal, lifted_normal, rise_to_plane, surface_at},
        texture::uvs_at,
    },
};

use super::bench::SCENE;
use super::harness::{Case, Output, Rng, Row, Twin, Value, check, inputs, twin};

const UNIT: Output = Output::Vector(1.0);
const COORDINATE: Output = Output::Number(1.0);

/// A random triangle of the scene, and a place in it.
fn place_in_triangle(rng: &mut Rng) -> (u32, f32, f32) {
    let triangle = rng.below(SCENE.geometry.triangle_count()) as u32;
    let (u, v) = (rng.unit(), rng.unit());
    if u + v > 1.0 {
        (triangle, 1.0 - u, 1.0 - v)
    } else {
        (triangle, u, v)
    }
}

/// The materials of the geometry's slots.
fn slots<T: Scalar>() -> [Material<T>; 2] {
    [SCENE.material(0), SCENE.material(1)]
}

#[test]
fn surfaces_agree() {
    assert!((0..SCENE.geometry.triangle_count()).all(|triangle| SCENE.geometry.slot(triangle) < 2));
    check(
        &["scene/surface"],
        &[
            Case::new(
                "surface_at",
                "triangle t u v direction",
                "let slot = slot_at(triangle); \
                 let p = surface_of(Hit(t, triangle, u, v), direction, slot, material_at(slot));",
                twin!(|row| {
                    let triangle = SCENE.geometry.triangle_at(row.bits());
                    let [t, u, v] = row.numbers().map(|x: T| x.to_f64() as f32);
                    let hit = Hit { t, triangle, u, v };
                    let point = surface_at(&SCENE.geometry, &slots(), &SCENE.textures, &hit, row.vector());
                    let surface = point.surface;
                    let frame = surface.frame;
                    for v in [frame.tangent, frame.bitangent, frame.normal, surface.normal, surface.wo] {
                        row.put_vector(v);
                    }
                    row.put_vector(surface.coat_normal);
                    row.put_vector(point.position);
                    row.put(point.error);
                    for transmits in [false, true] {
                        row.put_vector(point.ray_origin(-frame.normal, transmits));
                    }
                    row.put(if surface.is_inside { T::ONE } else { T::ZERO });
                    row.put_bits(point.slot);
                }),
            )
            .output("p.surface.frame.tangent", UNIT)
            .output("p.surface.frame.bitangent", UNIT)
            .output("p.surface.frame.normal", UNIT)
            .output("p.surface.normal", UNIT)
            .output("p.surface.wo", UNIT)
            .output("p.surface.coat_normal", UNIT)
            .output("p.position", UNIT)
            .number("p.error", 0.0)
            .output("ray_origin(p, -p.surface.frame.normal, false)", UNIT)
            .output("ray_origin(p, -p.surface.frame.normal, true)", UNIT)
            .number("f32(p.surface.is_inside)", 1.0)
            .exact("p.slot")
            .group("teapot and ground", |rng, _| {
                let (triangle, u, v) = place_in_triangle(rng);
                inputs![triangle, rng.range(0.1, 10.0), u, v, rng.direction()]
            }),
            Case::new(
                "hit_uvs",
                "triangle u v",
                "var boxed = material_at(0u); boxed.flags |= HAS_BOX; let uvs = hit_uvs(Hit(1.0, triangle, u, v), boxed);",
                twin!(|row| {
                    let triangle = SCENE.geometry.triangle_at(row.bits());
                    let [u, v]: [T; 2] = row.numbers();
                    let weights = [T::ONE - u - v, u, v];
                    let sets = uvs_at(&SCENE.geometry, triangle as usize, weights, true);
                    sets.as_flattened().iter().for_each(|x| row.put(*x));
                }),
            )
            .output("uvs.sets.x", COORDINATE)
            .output("uvs.sets.y", COORDINATE)
            .output("uvs.sets.z", COORDINATE)
            .output("uvs.sets.w", COORDINATE)
            .output("uvs.on_box.x", COORDINATE)
            .output("uvs.on_box.y", COORDINATE)
            .group("teapot and ground", |rng, _| {
                let (triangle, u, v) = place_in_triangle(rng);
                inputs![triangle, u, v]
            }),
            Case::new(
                "rise_to_plane",
                "position corner normal weight sign",
                "",
                twin!(|row| {
                    let [position, corner, normal] = [(); 3].map(|()| row.vector());
                    let [weight, sign]: [T; 2] = row.numbers();
                    let is_turned = sign.less(T::from_f64(0.5));
                    row.put_vector(rise_to_plane(position, corner, normal, weight, is_turned));
                }),
            )
            .output("rise_to_plane(position, corner, normal, weight, sign < 0.5)", UNIT)
            .group("", |rng, _| {
                inputs![rng.direction(), rng.direction(), rng.direction(), rng.unit(), rng.unit()]
            }),
            Case::new(
                "bent_normal",
                "shading wo",
                "",
                twin!(vector shading, vector wo => put_vector(bent_normal(shading, wo))),
            )
            .output("bent_normal(shading, wo)", UNIT)
            .group("", |rng, _| inputs![rng.direction(), rng.direction()]),
            Case::new(
                "lifted_normal",
                "shading geometric wo",
                "",
                twin!(
                    vector shading, vector geometric, vector wo =>
                    put_vector(lifted_normal(shading, geometric, wo))
                ),
            )
            .output("lifted_normal(shading, geometric, wo)", UNIT)
            .group_of("", 16_000, |rng, _| {
                inputs![rng.direction(), rng.direction(), rng.direction()]
            }),
        ],
    );
}

fn vec3a<T: Scalar>(v: Vec3<T>) -> Vec3A {
    Vec3A::from_array(v.to_f32())
}

/// The Rust twin works on f32 alone.
fn meet(row: &mut Row<'_, f32>) {
    let frame = RayFrame::new(vec3a(row.vector()), vec3a(row.vector()));
    let [v0, v1, v2] = [(); 3].map(|()| vec3a(row.vector()));
    let t_max = row.number();
    let found = intersect_triangle(&frame, v0, v1, v2, t_max).unwrap_or((-1.0, -1.0, -1.0));
    row.put(found.0);
    row.put(found.1);
    row.put(found.2);
}

fn axes(row: &mut Row<'_, f32>) {
    let frame = RayFrame::new(vec3a(row.vector()), vec3a(row.vector()));
    for axis in [frame.axis_x, frame.axis_y] {
        row.put_vector(Vec3::from_f32(axis.to_array()));
    }
}

/// A ray at, or past, a triangle of random size and place.
fn ray_and_triangle(rng: &mut Rng, overshoot: f32) -> Vec<Value> {
    let center = rng.direction() * rng.unit();
    let size = rng.range(0.2, 1.0);
    let corners = [(); 3].map(|()| center + rng.direction() * size);
    let (u, v) = (rng.range(-overshoot, 1.0), rng.range(-overshoot, 1.0));
    let target = corners[0] * (1.0 - u - v) + corners[1] * u + corners[2] * v;
    let direction = rng.direction();
    let origin = target - direction * rng.range(-0.5, 3.0);
    let t_max = if rng.chance(0.2) { rng.range(0.1, 3.0) } else { 1e30 };
    inputs![origin, direction, corners[0], corners[1], corners[2], t_max]
}

#[test]
fn triangles_agree() {
    check(
        &["scene/intersect"],
        &[
            Case::new(
                "intersect_triangle",
                "origin direction v0 v1 v2 t_max",
                "let met = intersect_triangle(ray_frame(origin, direction), mat3x3f(v0, v1, v2), t_max);",
                Twin::single(meet),
            )
            .number("met.x", 1.0)
            .number("met.y", 1.0)
            .number("met.z", 1.0)
            .group("mostly met", |rng, _| ray_and_triangle(rng, 0.0))
            .group("mostly missed", |rng, _| ray_and_triangle(rng, 1.0)),
            Case::new(
                "ray_frame",
                "origin direction",
                "let frame = ray_frame(origin, direction);",
                Twin::single(axes),
            )
            .output("frame.axis_x", UNIT)
            .output("frame.axis_y", UNIT)
            .group("", |rng, _| inputs![rng.direction(), rng.direction()]),
        ],
    );
}
