//! Multiple scattering between facets: white metals keep all light, and coloured metals lose what their
//! colour takes each time.

use glossmith::document::{MaterialSettings, assign};
use glossmith::render::{EngineChoice, Precision};
use glossmith::study::evaluate::{Albedo, Evaluator};

/// Cosines of the views of the table below.
const COSINES: [f64; 6] = [1.0, 0.8, 0.6, 0.4, 0.2, 0.1];
/// What single scattering keeps of light on a white metal of GGX (review of the physics, part 3.1), by roughness.
const KEPT: [(f32, [f64; 6]); 4] = [
    (0.3, [0.9912, 0.9879, 0.9817, 0.9650, 0.9144, 0.8845]),
    (0.5, [0.9159, 0.8973, 0.8717, 0.8443, 0.8482, 0.8916]),
    (0.8, [0.5552, 0.5699, 0.5988, 0.6513, 0.7489, 0.8331]),
    (1.0, [0.3069, 0.3513, 0.4115, 0.4989, 0.6416, 0.7602]),
];
/// Both precisions of the CPU.
const ENGINES: [(EngineChoice, Precision); 2] = [
    (EngineChoice::Cpu, Precision::Single),
    (EngineChoice::Cpu, Precision::Double),
];
fn material(assignments: &[&str]) -> MaterialSettings {
    let mut material = MaterialSettings::default();
    for assignment in ["specular.lobe=ggx"].iter().chain(assignments) {
        assign(&mut material, assignment).unwrap();
    }
    material
}

fn albedos(material: &MaterialSettings, (engine, precision): (EngineChoice, Precision), side: f64) -> [Albedo; 6] {
    let evaluator = Evaluator::open(material, engine, precision).unwrap();
    COSINES.map(|cosine| evaluator.albedo(side * cosine, 1 << 16, 1).unwrap())
}

#[track_caller]
fn assert_albedo(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() < tolerance, "{what}: {found} for {expected}");
}

/// Light that is lost between white facets comes back with another factor of the colour.
#[test]
fn a_coloured_metal_takes_its_colour_twice() {
    let color = 0.5;
    let metal = material(&[
        "specular.fresnel=none",
        "specular.color=0.5,0.5,0.5",
        "base.metalness=1",
        "specular.roughness=0.8",
    ]);
    let [(_, _), (_, _), (_, kept), _] = KEPT;
    let found = albedos(&metal, ENGINES[1], 1.0);
    for (albedo, kept) in found.iter().zip(kept) {
        let expected = color * (kept + color * (1.0 - kept));
        assert_albedo(albedo.reflected[0], expected, 2e-3, "coloured metal");
    }
}

/// Of a stretched lobe the mean over all azimuths is kept.
#[test]
fn stretched_metals_keep_all_light_in_the_mean() {
    let turned = |turn: u32| {
        let rotation = format!("specular.rotation={}", f64::from(turn) * 22.5);
        let metal = material(&[
            "base.color=1,1,1",
            "base.metalness=1",
            "specular.fresnel=schlick",
            "specular.roughness=0.7",
            "specular.anisotropy=0.8",
            &rotation,
        ]);
        albedos(&metal, ENGINES[1], 1.0).map(|albedo| albedo.reflected[0])
    };
    let turns: Vec<_> = (0..8).map(turned).collect();
    for (view, cosine) in COSINES.iter().enumerate() {
        let mean = turns.iter().map(|found| found[view]).sum::<f64>() / 8.0;
        assert_albedo(mean, 1.0, 3e-3, &format!("cosine {cosine}"));
    }
}

/// Without facets, without roughness or over a base nothing is to be given back, and no table is made.
#[test]
fn what_loses_nothing_does_not_pay() {
    use glossmith::compile::compile;
    use glossmith::optics::material::COMPENSATES;
    let calls = |assignments: &[&str]| {
        let (materials, tables) = compile(&[material(assignments)]);
        (materials[0].has_flag(COMPENSATES), tables.len())
    };
    assert_eq!(calls(&["specular.lobe=geometric"]), (false, 0));
    assert_eq!(calls(&["specular.roughness=0.01"]), (false, 0));
    assert_eq!(calls(&["specular.multiple_scattering=off"]), (false, 0));
    assert!(!calls(&["base.metalness=0", "specular.roughness=0.7"]).0);
    assert!(calls(&["specular.roughness=0.1"]).0);
}
