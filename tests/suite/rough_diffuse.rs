//! The rough diffuse base: albedos and values in closed form, and light both ways.

use std::f64::consts::PI;

use glossmith::analysis::quadrature::integrate_hemisphere;
use glossmith::document::{MaterialSettings, assign};
use glossmith::optics::rough_diffuse::{rough_diffuse, single_albedo};
use glossmith::optics::vector::{Vec3, vec3};
use glossmith::render::{EngineChoice, Precision};
use glossmith::study::evaluate::Evaluator;

const ENGINES: [(EngineChoice, Precision); 2] = [
    (EngineChoice::Cpu, Precision::Single),
    (EngineChoice::Cpu, Precision::Double),
];
/// The GPU, which compiles a kernel for each material that is asked about: for few of them.
const GPU: (EngineChoice, Precision) = (EngineChoice::Gpu, Precision::Single);
/// Cosines of the views of the tables below (review of the physics, part 3.7).
const COSINES: [f64; 3] = [1.0, 0.6, 0.2];

fn matt(albedo: f64, roughness: f64) -> MaterialSettings {
    let mut material = MaterialSettings::default();
    for assignment in [
        "base.metalness=0",
        "specular.weight=0",
        &format!("base.color={albedo},{albedo},{albedo}"),
        &format!("base.diffuse_roughness={roughness}"),
    ] {
        assign(&mut material, assignment).unwrap();
    }
    material
}

#[test]
fn single_scattering_has_its_closed_albedo() {
    for (roughness, expected) in [(1.0, [0.77652, 0.84036, 0.94721]), (0.5, [0.87420, 0.91014, 0.97029])] {
        for (cosine, expected) in COSINES.iter().zip(expected) {
            let found = single_albedo(*cosine, roughness);
            assert!(
                (found - expected).abs() < 1e-5,
                "{roughness}, {cosine}: {found} for {expected}"
            );
        }
    }
    // Without multiple scattering a black surface's factor is that of single scattering alone.
    for roughness in [0.25, 1.0] {
        let wo = vec3(0.8, 0.0, 0.6);
        let albedo = integrate_hemisphere(200, |wi: Vec3<f64>| {
            wi.z / PI * rough_diffuse(Vec3::ZERO, roughness, [0.6, wi.z], wo.dot(wi)).x
        });
        assert!((albedo - single_albedo(0.6, roughness)).abs() < 1e-3, "{albedo}");
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
                assert!(
                    (found - expected).abs() < 1.5e-3,
                    "{engine:?}, {albedo}, {roughness}, {cosine}: {found} for {expected}"
                );
            }
        }
    }
}

#[test]
fn values_are_those_of_the_model_and_the_same_both_ways() {
    let direction = |theta_deg: f64, phi_deg: f64| {
        let (sine, cosine) = theta_deg.to_radians().sin_cos();
        let (across, along) = phi_deg.to_radians().sin_cos();
        Vec3::from_f64([sine * along, sine * across, cosine])
    };
    let (back, ahead) = (direction(60.0, 0.0), direction(60.0, 180.0));
    let aside = direction(80.0, 50.0);
    for (engine, precision) in ENGINES.into_iter().chain([GPU]) {
        let evaluator = Evaluator::open(&matt(0.8, 1.0), engine, precision).unwrap();
        let pairs = [[back, back], [back, ahead], [back, aside], [aside, back]];
        let found = evaluator.evaluate(&pairs).unwrap();
        // The value without its cosine, times π.
        let value = |pair: usize| PI * found[pair].value[0] / f64::from(pairs[pair][1].z);
        assert!((value(0) - 1.6198).abs() < 2e-4, "{engine:?}: {}", value(0));
        assert!((value(1) - 0.2221).abs() < 2e-4, "{engine:?}: {}", value(1));
        assert!(
            (value(2) - value(3)).abs() < 1e-5,
            "{engine:?}: {} and {}",
            value(2),
            value(3)
        );
        // Drawn as Lambert's base.
        assert!((found[2].density - f64::from(aside.z) / PI).abs() < 1e-6, "{engine:?}");
    }
}
