//! The fuzz layer: its albedo by the published fits.

use glossmith::{
    document::{Document, MaterialSettings},
    render::{EngineChoice, Precision},
    scene::texture::TextureTarget,
    study::evaluate::Evaluator,
};

use crate::{cli_support::Workplace, own_textures::coated_on_a_box, renders::material};

const ENGINES: [(EngineChoice, Precision); 2] = [
    (EngineChoice::Cpu, Precision::Single),
    (EngineChoice::Cpu, Precision::Double),
];
/// Albedos of the fits at these cosines, by roughness (review of the physics, part 3.3).
const COSINES: [f64; 4] = [1.0, 0.5, 0.2, 0.05];
const ALBEDOS: [(f64, [f64; 4]); 3] = [
    (0.2, [0.0003, 0.0010, 0.0963, 0.4706]),
    (0.5, [0.0249, 0.1497, 0.4295, 0.6235]),
    (1.0, [0.3446, 0.4957, 0.6432, 0.7205]),
];

/// Fuzz of weight 1 over a matt base.
fn fuzzy(base: f64, roughness: f64, color: &str) -> MaterialSettings {
    material(&format!(
        "base.metalness=0 specular.weight=0 fuzz.weight=1 base.color={base},{base},{base} fuzz.roughness={roughness} \
         fuzz.color={color}"
    ))
}

/// A ball whose fuzz has the weight that a picture on a box gives it.
pub fn fuzzy_on_a_box(folder: &Workplace) -> Document {
    let mut document = coated_on_a_box(folder);
    let picture = document.materials[0].user_textures.get(TextureTarget::Coat).cloned();
    document.materials[0] = fuzzy(0.1, 0.5, "1,1,1");
    document.materials[0].put_texture(TextureTarget::Fuzz, picture.unwrap());
    document
}

#[test]
fn fuzz_over_black_has_the_albedo_of_the_fits() {
    for (engine, precision) in ENGINES {
        for (roughness, expected) in ALBEDOS {
            let material = fuzzy(0.0, roughness, "1,0.5,0");
            let evaluator = Evaluator::open(&material, engine, precision).unwrap();
            for (cosine, expected) in COSINES.iter().zip(expected) {
                let [red, green, blue] = evaluator.albedo(*cosine, 1 << 12, 1).unwrap().reflected;
                let what = format!("{engine:?}, {roughness}, {cosine}: {red} for {expected}");
                near!(red, expected, 0.0001, "{what}");
                assert!(
                    (green - 0.5 * red).abs() < 1e-5 && blue == 0.0,
                    "{what}, {green}, {blue}"
                );
            }
        }
    }
}
