//! The rough diffuse base: albedos and values in closed form, and light both ways.

use glossmith::{
    document::MaterialSettings,
    optics::rough_diffuse::single_albedo,
    render::{EngineChoice, Precision},
    study::evaluate::Evaluator,
};

use crate::renders::material;

const ENGINES: [(EngineChoice, Precision); 2] = [
    (EngineChoice::Cpu, Precision::Single),
    (EngineChoice::Cpu, Precision::Double),
];
/// Cosines of the views of the tables below (review of the physics, part 3.7).
const COSINES: [f64; 3] = [1.0, 0.6, 0.2];

fn matt(albedo: f64, roughness: f64) -> MaterialSettings {
    material(&format!(
        "base.metalness=0 specular.weight=0 base.color={albedo},{albedo},{albedo} base.diffuse_roughness={roughness}"
    ))
}

#[test]
fn single_scattering_has_its_closed_albedo() {
    for (roughness, expected) in [(1.0, [0.77652, 0.84036, 0.94721]), (0.5, [0.87420, 0.91014, 0.97029])] {
        for (cosine, expected) in COSINES.iter().zip(expected) {
            let found = single_albedo(*cosine, roughness);
            near!(found, expected, 1e-5, "{roughness}, {cosine}");
        }
    }
}

#[test]
fn albedos_are_those_of_the_model() {
    for (albedo, roughness, expected) in [
        (0.8, 1.0, [0.7587, 0.7705, 0.7902]),
        (0.5, 1.0, [0.4390, 0.4565, 0.4856]),
        (1.0, 1.0, [1.0; 3]),
        (1.0, 0.3, [1.0; 3]),
        (0.8, 0.0, [0.8; 3]),
    ] {
        let material = matt(albedo, roughness);
        for (engine, precision) in ENGINES {
            let evaluator = Evaluator::open(&material, engine, precision).unwrap();
            for (cosine, expected) in COSINES.iter().zip(expected) {
                let found = evaluator.albedo(*cosine, 1 << 15, 3).unwrap().reflected[1];
                near!(found, expected, 1.5e-3, "{engine:?}, {albedo}, {roughness}, {cosine}");
            }
        }
    }
}
