//! What a file says of GGX as the default lobe shows it: how wide it is, reflected and refracted.

use std::f64::consts::PI;

use glossmith::{
    compile::compile,
    compile::compile_textured,
    document::{
        ImportLobe, MaterialSettings, import::geometric_from_ggx, of_model::import_report, of_model::materials_of,
    },
    optics::{
        frame::frame_from_normal,
        lobe::{Lobe, LobeShape, is_mirror, lobe_sample},
        material::Material,
        random::{Sequence, random_pair, random_state},
        vector::vec3,
    },
    scene::{Model, Slot, texture::Textures, texture::textured_material},
};
use image::{Rgba, RgbaImage};
use serde_json::json;

use super::textures::load as load_textured;

/// The angle to the normal in degrees within which half the samples are under a view along it.
fn median_deg(shape: &LobeShape<'_, f64>) -> f64 {
    let normal = vec3(0.0, 0.0, 1.0);
    let drawn = (0..5_000).filter_map(|i| {
        let state = random_state(5, 0, 0, i, Sequence::Independent);
        let ([a, b], [c, _]) = (random_pair(state, 0), random_pair(state, 1));
        let sample = lobe_sample(shape, &frame_from_normal(normal), normal, normal, [a, b, c]);
        (sample.weight > 0.0).then(|| sample.wi.z.abs().min(1.0).acos() * 180.0 / PI)
    });
    let mut angles: Vec<f64> = drawn.collect();
    angles.sort_by(f64::total_cmp);
    angles[angles.len() / 2]
}

/// A slot of clear glass as a lobe shows it.
fn glass(roughness: f32, ior: f32, lobe: ImportLobe) -> Material<f64> {
    let slot = Slot::default().with(&[
        ("specular.roughness", roughness),
        ("specular.ior", ior),
        ("transmission.weight", 1.0),
        ("base.metalness", 0.0),
    ]);
    compile(&[MaterialSettings::from_slot(&slot, lobe)]).0[0].cast()
}

const LOBES: [ImportLobe; 2] = [ImportLobe::Geometric, ImportLobe::Ggx];

#[test]
fn reflections_are_as_wide_as_the_file_says() {
    for step in (0..=40).step_by(4) {
        let roughness = step as f32 / 40.0;
        let [found, expected] = LOBES.map(|lobe| median_deg(&glass(roughness, 1.5, lobe).shape(&[])));
        println!("{roughness}: {found}, GGX {expected}");
        near!(found, expected, 2.0, "{roughness}");
    }
}

#[test]
fn refractions_are_as_wide_as_the_file_says() {
    for (ior, is_inside) in [
        (1.05, false),
        (1.33, false),
        (1.5, false),
        (2.4, false),
        (1.33, true),
        (1.5, true),
    ] {
        for step in (1..=14).step_by(3) {
            let roughness = step as f32 / 20.0;
            let [found, expected] =
                LOBES.map(|lobe| median_deg(&glass(roughness, ior, lobe).transmission_shape(&[], is_inside)));
            println!("{ior} {is_inside} {roughness}: {found}, GGX {expected}");
            // Of the median of so many samples 2 %.
            let tolerance = 0.15 * expected + 0.02;
            near!(
                found,
                expected,
                tolerance,
                "index {ior}, from within {is_inside}, roughness {roughness}"
            );
        }
    }
}

#[test]
fn what_has_the_index_around_it_goes_straight_on_at_every_roughness() {
    for &lobe in Lobe::ALL.iter().filter(|lobe| **lobe != Lobe::Lambert) {
        for step in 0..=10 {
            let settings = MaterialSettings {
                lobe,
                roughness: step as f32 / 10.0,
                metalness: 0.0,
                ior: 1.0,
                transmission_weight: 1.0,
                ..MaterialSettings::default()
            };
            let material: Material<f64> = compile(&[settings]).0[0].cast();
            for is_inside in [false, true] {
                let shape = material.transmission_shape(&[], is_inside);
                assert!(is_mirror(&shape), "{lobe:?} {step}");
                assert!(median_deg(&shape) < 0.02, "{lobe:?} {step}: {}", median_deg(&shape));
            }
        }
    }
}

/// A metal whose roughness is a texture of these values, times a factor.
fn textured(factor: f32, values: [u8; 2]) -> Model {
    let texels = RgbaImage::from_fn(2, 1, |x, _| Rgba([0, values[x as usize], 255, 255]));
    let material =
        json!({"pbrMetallicRoughness": {"roughnessFactor": factor, "metallicRoughnessTexture": {"index": 0}}});
    load_textured(&material, &[texels], &json!({"magFilter": 9728}))
}

#[test]
fn a_roughness_texture_is_not_cut_off() {
    let model = textured(1.0, [51, 153]);
    let materials = materials_of(&model, ImportLobe::Geometric);
    assert_eq!(materials[0].lobe, Lobe::Geometric);
    let textures = Textures::new(&model);
    let (compiled, tables) = compile_textured(&materials, &textures.slots);
    for (u, roughness) in [(0.25, 0.2), (0.75, 0.6)] {
        let there = textured_material(
            &textures,
            &tables,
            &compiled[0],
            &[[[u, 0.5], [0.0; 2], [0.0; 2]]],
            vec3(1.0, 1.0, 1.0),
        );
        let expected = geometric_from_ggx(roughness);
        near!(there.roughness, expected, 0.001);
    }
    for (factor, values, lobe) in [
        (1.0, [51, 240], Lobe::Ggx),
        (0.9, [51, 51], Lobe::Ggx),
        (0.6, [51, 240], Lobe::Geometric),
    ] {
        let material = &materials_of(&textured(factor, values), ImportLobe::Geometric)[0];
        assert_eq!(material.lobe, lobe, "{factor} {values:?}");
    }
}

#[test]
fn the_report_says_where_the_lobe_is_another_one() {
    let report = |slot: Slot, lobe: ImportLobe| {
        let model = Model {
            slots: vec![slot],
            ..Model::default()
        };
        import_report(&model, lobe).lines().join("\n")
    };
    for of_coat in [0.0, 1.0] {
        let rough = Slot::default().with(&[
            ("specular.roughness", 0.8 - 0.5 * of_coat),
            ("coat.weight", of_coat),
            ("coat.roughness", 0.9),
        ]);
        let told = report(rough.clone(), ImportLobe::Geometric);
        assert!(told.contains("approximated: a roughness above 0.7"), "{told}");
        assert_eq!(report(rough, ImportLobe::Ggx), "");
    }
    let glass = Slot::default().with(&[
        ("specular.roughness", 0.4),
        ("base.metalness", 0.0),
        ("transmission.weight", 1.0),
    ]);
    assert!(report(glass, ImportLobe::Geometric).contains("approximated: a rough refraction"));
}
