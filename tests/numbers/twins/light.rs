//! Sampling of triangles that emit: the teapot's many small ones and the ground's two large ones.

use glossmith::{
    optics::{material::Material, real::Scalar, vector::vec3},
    scene::light::{Emitters, light_density, light_sample, spot_share},
};

use super::bench::SCENE;
use super::harness::{Case, Output, Value, check, inputs, twin};

const UNIT: Output = Output::Vector(1.0);

fn materials<T: Scalar>() -> [Material<T>; 2] {
    [SCENE.material(0), SCENE.material(1)]
}

fn density_per_luminance<T: Scalar>() -> T {
    // The shader has it in f32.
    T::from_f64(f64::from(SCENE.light_choice().density_per_luminance as f32))
}

#[test]
fn lights_agree() {
    check(
        &["scene/light"],
        &[
            Case::new(
                "light_sample",
                "origin error a b c",
                "let s = light_sample(origin, error, vec3f(a, b, c));",
                twin!(|row| {
                    let origin = row.vector();
                    let [error, a, b, c] = row.numbers();
                    let density = density_per_luminance();
                    let scene = &*SCENE;
                    let materials = materials();
                    let emitters = Emitters {
                        geometry: &scene.geometry,
                        materials: &materials,
                        textures: &scene.textures,
                        lights: &scene.lights,
                        tables: &scene.tables,
                        density_per_luminance: density,
                    };
                    let s = light_sample(&emitters, origin, error, vec3(a, b, c));
                    row.put_vector(s.direction);
                    row.put(s.density);
                    row.put(s.distance);
                    row.put_vector(s.radiance);
                }),
            )
            .output("s.direction", UNIT)
            .number("s.density", 0.0)
            .number("s.distance", 1.0)
            .output("s.radiance", Output::Vector(1e-3))
            .group_of("from around the teapot", 32_000, |rng, _| {
                inputs![
                    rng.direction() * rng.range(1.2, 5.0),
                    rng.log_range(1e-7, 1e-3),
                    Value::Unit(rng.unit()),
                    Value::Unit(rng.unit()),
                    Value::Unit(rng.unit())
                ]
            }),
            Case::new(
                "spot_share",
                "cosine",
                "",
                twin!(number cosine => put(spot_share(&materials()[0], cosine))),
            )
            .number("spot_share(material_at(0u), cosine)", 1.0)
            .group("", |rng, _| inputs![rng.range(-1.0, 1.0)]),
            Case::new(
                "light_density",
                "light_luminance cosine distance",
                "",
                twin!(
                    numbers [luminance, cosine, distance] =>
                    put(light_density(luminance, cosine, distance, density_per_luminance()))
                ),
            )
            .number("light_density(light_luminance, cosine, distance)", 0.0)
            .group("", |rng, _| {
                inputs![rng.range(0.1, 2.0), rng.range(0.0, 1.0), rng.log_range(1e-3, 100.0)]
            }),
        ],
    );
}
