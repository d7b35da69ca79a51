//! The environment's map and its sampling, and the camera's rays.

use glossmith::{
    optics::vector::{Vec3, vec3},
    scene::camera::{Camera, PixelFilter, camera_ray, filter_offset},
    scene::environment::{
        environment_density, environment_local_from_world, environment_radiance, environment_sample, environment_uv,
        environment_world_from_local,
    },
};

use super::bench::SCENE;
use super::harness::{Case, Output, Rng, Value, check, inputs, twin};

const UNIT: Output = Output::Vector(1.0);

/// A direction, its cosine and sine of a rotation.
fn direction_and_rotation(rng: &mut Rng) -> Vec<Value> {
    let angle = rng.range(-3.2, 3.2);
    inputs![rng.direction(), angle.cos(), angle.sin()]
}

#[test]
fn environments_agree() {
    check(
        &["scene/environment"],
        &[
            Case::new(
                "environment_local_from_…",
                "direction cosine sine",
                "",
                twin!(
                    vector direction, numbers rotation =>
                    put_vector(environment_local_from_world(direction, rotation))
                ),
            )
            .output("environment_local_from_world(direction, vec2f(cosine, sine))", UNIT)
            .group("", |rng, _| direction_and_rotation(rng)),
            Case::new(
                "environment_world_from_…",
                "direction cosine sine",
                "",
                twin!(
                    vector direction, numbers rotation =>
                    put_vector(environment_world_from_local(direction, rotation))
                ),
            )
            .output("environment_world_from_local(direction, vec2f(cosine, sine))", UNIT)
            .group("", |rng, _| direction_and_rotation(rng)),
            Case::new(
                "environment_uv",
                "direction",
                "let uv = environment_uv(direction);",
                twin!(vector direction => put_numbers(environment_uv(direction))),
            )
            .number("uv.x", 1.0)
            .number("uv.y", 1.0)
            .group("", |rng, _| inputs![rng.direction()]),
            Case::new(
                "environment_radiance",
                "direction",
                "",
                twin!(vector direction => put_vector(environment_radiance(&SCENE.environment, direction))),
            )
            // The studio's soft boxes have radiances of several units.
            .output("environment_radiance(direction)", Output::Vector(0.1))
            .group("", |rng, _| inputs![rng.direction()]),
            Case::new(
                "environment_sample",
                "a b c",
                "let drawn = environment_sample(vec3f(a, b, c), globals.environment_cells_size);",
                twin!(|row| {
                    let [a, b, c] = row.numbers();
                    let (direction, density) = environment_sample(SCENE.environment.distribution(false), vec3(a, b, c));
                    row.put_vector(direction);
                    row.put(density);
                }),
            )
            .output("drawn.direction", UNIT)
            .number("drawn.density", 0.0)
            .group("", |rng, _| [(); 3].map(|()| Value::Unit(rng.unit())).into()),
            Case::new(
                "environment_density",
                "direction",
                "",
                twin!(|row| {
                    let d: Vec3<T> = row.vector();
                    row.put(environment_density(SCENE.environment.distribution(false), d));
                }),
            )
            .number("environment_density(direction, globals.environment_cells_size)", 0.0)
            .group("", |rng, _| inputs![rng.direction()]),
        ],
    );
}

/// A camera looking at the origin from somewhere.
fn random_camera(rng: &mut Rng, lens_radius: f32) -> Camera<f32> {
    let position = rng.direction() * rng.range(2.0, 8.0);
    let filter = if rng.chance(0.5) {
        PixelFilter::Box
    } else {
        PixelFilter::Gaussian
    };
    let (fov_deg, aspect) = (rng.range(5.0, 90.0), rng.range(0.5, 2.0));
    let camera = Camera::look_at(
        position.to_f64(),
        [0.0; 3],
        f64::from(fov_deg),
        f64::from(aspect),
        filter,
    );
    Camera {
        lens_radius,
        ..camera.cast()
    }
}

/// A camera, a place in a picture, two numbers for the lens.
fn camera_inputs(rng: &mut Rng, [lens_radius, parallel_from]: [f32; 2]) -> Vec<Value> {
    let c = random_camera(rng, lens_radius);
    let size = [1 + rng.below(4096), 1 + rng.below(4096)];
    let place = size.map(|size| rng.range(0.0, size as f32));
    inputs![
        c.origin,
        c.lens_radius,
        c.forward,
        c.focus_distance,
        c.right,
        c.filter_kind,
        c.up,
        parallel_from,
        place[0],
        place[1],
        size[0] as u32,
        size[1] as u32,
        Value::Unit(rng.unit()),
        Value::Unit(rng.unit()),
    ]
}

#[test]
fn cameras_agree() {
    let filter = |kind: PixelFilter| {
        move |rng: &mut Rng, _: usize| inputs![kind as u32, Value::Unit(rng.unit()), Value::Unit(rng.unit())]
    };
    check(
        &["scene/camera"],
        &[
            Case::new(
                "filter_offset",
                "kind a b",
                "let offset = filter_offset(kind, vec2f(a, b));",
                twin!(bits kind, numbers xi => put_numbers(filter_offset(kind, xi))),
            )
            .number("offset.x", 0.5)
            .number("offset.y", 0.5)
            .group("box", filter(PixelFilter::Box))
            .group("Gaussian", filter(PixelFilter::Gaussian)),
            Case::new(
                "camera_ray",
                "origin lens_radius forward focus_distance right filter_kind up parallel_from x y width height a b",
                "let camera = Camera(origin, lens_radius, forward, focus_distance, right, filter_kind, up, parallel_from); \
                 let ray = camera_ray(camera, vec2f(x, y), vec2u(width, height), vec2f(a, b));",
                twin!(|row| {
                    let camera = Camera {
                        origin: row.vector(),
                        lens_radius: row.number(),
                        forward: row.vector(),
                        focus_distance: row.number(),
                        right: row.vector(),
                        filter_kind: row.bits(),
                        up: row.vector(),
                        parallel_from: row.number(),
                    };
                    let (place, size) = (row.numbers(), [row.bits(), row.bits()]);
                    for v in camera_ray(&camera, place, size, row.numbers()) {
                        row.put_vector(v);
                    }
                }),
            )
            .output("ray.origin", UNIT)
            .output("ray.direction", UNIT)
            .group("pinhole", |rng, _| camera_inputs(rng, [0.0; 2]))
            .group("parallel", |rng, _| {
                let radius = rng.range(-0.3, 0.3);
                camera_inputs(rng, [radius.max(0.0), 2.0])
            })
            .group("lens", |rng, _| {
                let radius = rng.range(0.01, 0.3);
                camera_inputs(rng, [radius, 0.0])
            }),
        ],
    );
}
