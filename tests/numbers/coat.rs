//! The normal on which fuzz lies.

use glossmith::{
    compile::compile,
    document::{MaterialSettings, assign},
    optics::{
        frame::frame_from_normal,
        layer::{Layer, material_layers},
        material::{Material, Surface},
        numeric::normalize_or,
        vector::vec3,
    },
};

/// Fuzz stands on the coat's normal as far as there is a coat, else on that of the base (OpenPBR 1.1).
#[test]
fn fuzz_lies_on_the_coat() {
    let (up, tilted) = (vec3(0.0, 0.0, 1.0), vec3(0.6, 0.0, 0.8));
    for weight in [0.0, 0.3, 1.0] {
        let mut settings = MaterialSettings::default();
        for assignment in ["fuzz.weight=1", &format!("coat.weight={weight}")] {
            assign(&mut settings, assignment).unwrap();
        }
        let (materials, tables) = compile(&[settings]);
        let material: Material<f64> = materials[0].cast();
        let albedo = |base, coat_normal| {
            let surface = Surface {
                frame: frame_from_normal(base),
                coat_normal,
                ..Surface::upwards(vec3(0.0, 0.6, 0.8))
            };
            material_layers(&material, &tables, &surface)[Layer::Fuzz].albedo.x
        };
        let mixed = normalize_or(tilted.mix(up, f64::from(weight as f32)), up);
        let (found, expected) = (albedo(tilted, up), albedo(mixed, mixed));
        assert!((found - expected).abs() < 1e-9, "{weight}: {found} for {expected}");
    }
}
