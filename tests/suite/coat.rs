//! The coat and the edge tint: samples against the density of the whole mixture, and the tint in closed form.

use glossmith::analysis::chi_square::{PolarGrid, sidak_level, test_samples};
use glossmith::compile::compile;
use glossmith::document::{MaterialSettings, assign};
use glossmith::optics::frame::frame_from_normal;
use glossmith::optics::fresnel::{fresnel_metal, fresnel_schlick};
use glossmith::optics::layer::{
    Layer, MaterialNumbers, base::Base, coat::Coat, layer_evaluate, material_layers, material_sample,
    specular::Specular,
};
use glossmith::optics::material::{Material, Surface};
use glossmith::optics::random::{Sequence, random_pair, random_state};
use glossmith::optics::vector::{Vec3, vec3};

/// Samples of a case.
const SAMPLES: u32 = 20_000;

fn material(assignments: &[&str]) -> (Material<f64>, Vec<f32>) {
    let mut settings = MaterialSettings::default();
    for assignment in assignments {
        assign(&mut settings, assignment).unwrap();
    }
    let (materials, tables) = compile(&[settings]);
    (materials[0].cast(), tables)
}

/// Seen under this angle; the coat's normal 10 degrees off the other one.
fn surface(angle_deg: f64) -> Surface<f64> {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    let normal = vec3(0.0, 0.0, 1.0);
    Surface {
        frame: frame_from_normal(vec3(0.0, 0.17, 1.0).normalize()),
        normal,
        wo: vec3(sin, 0.0, cos),
        coat_normal: normal,
        is_inside: false,
    }
}

/// The density of whatever layer is drawn.
fn density(material: &Material<f64>, tables: &[f32], surface: &Surface<f64>, wi: Vec3<f64>) -> f64 {
    let probabilities = material_layers(material, tables, surface).probabilities();
    let of = |layer: Layer, [_, density]: [f64; 2]| probabilities[layer as usize] * density;
    of(Layer::Coat, layer_evaluate::<f64, Coat>(material, tables, surface, wi))
        + of(
            Layer::Specular,
            layer_evaluate::<f64, Specular>(material, tables, surface, wi),
        )
        + of(Layer::Base, layer_evaluate::<f64, Base>(material, tables, surface, wi))
}

/// The p-value of samples under the mixture's density, the coat's roughness in it times `factor`.
fn p_value(material: &Material<f64>, tables: &[f32], angle_deg: f64, seed: u32, factor: f64) -> f64 {
    let surface = surface(angle_deg);
    let layers = material_layers(material, tables, &surface);
    let draw = |i: u32| {
        let state = random_state(17, 0, seed, i, Sequence::Independent);
        let ([a, b], [c, facet]) = (random_pair(state, 0), random_pair::<f64>(state, 1));
        let numbers = MaterialNumbers {
            lobe: [a, b, c],
            facet,
            below: [a, b, c],
        };
        let drawn = material_sample(material, tables, &surface, &layers, numbers, false);
        // What GGX loses below the shading normal's horizon is no direction.
        (drawn.throughput.max_component() > 0.0).then_some(drawn.wi)
    };
    let samples: Vec<_> = (0..SAMPLES).map(draw).collect();
    let middle = surface.wo.mirrored_about(surface.normal);
    let grid = PolarGrid::following(
        frame_from_normal(middle),
        8,
        8,
        samples.iter().flatten().take(4000).copied(),
    );
    let mut supposed = *material;
    supposed.coat_roughness *= factor;
    let cuts = [surface.normal, surface.frame.normal];
    test_samples(&grid, &samples, &cuts, |wi| density(&supposed, tables, &surface, wi)).p_value
}

#[test]
fn samples_follow_the_density_of_the_mixture() {
    let coats = ["coat.weight=1", "coat.roughness=0.2"];
    let cases = [
        &["base.metalness=0", "specular.roughness=0.5"][..],
        &["base.metalness=1", "specular.roughness=0.3", "coat.ior=2"],
        &["base.metalness=0.5", "specular.lobe=ggx", "specular.roughness=0.6"],
        &["base.metalness=0", "specular.weight=0", "coat.roughness=0.6"],
    ];
    let angles = [45.0, 80.0];
    let level = sidak_level(1e-3, cases.len() * angles.len());
    let mut found = false;
    for (number, case) in cases.iter().enumerate() {
        let (material, tables) = material(&[&coats[..], case].concat());
        for angle_deg in angles {
            let p = p_value(&material, &tables, angle_deg, number as u32, 1.0);
            assert!(p > level, "{case:?} at {angle_deg} degrees: p = {p:.1e}");
            found |= p_value(&material, &tables, angle_deg, number as u32, 1.1) < level;
        }
    }
    assert!(found, "a coat that is rougher than supposed is not found");
}

/// At a cosine of 1/7 the tint is what is left of Schlick's reflectance; head-on and at grazing angles nothing changes.
#[test]
fn the_edge_tint_is_what_is_left_at_82_degrees() {
    let (f0, tint) = (vec3(0.9, 0.5, 0.2), vec3(0.3, 0.8, 1.0));
    let seventh = 1.0 / 7.0;
    let expected = fresnel_schlick(f0, seventh) * tint;
    let found = fresnel_metal(f0, tint, seventh);
    for (a, b) in found.to_f64().into_iter().zip(expected.to_f64()) {
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
    assert_eq!(fresnel_metal(f0, tint, 1.0), f0);
    assert_eq!(fresnel_metal(f0, tint, 0.0), Vec3::splat(1.0));
    for i in 0..=100 {
        let value = fresnel_metal(vec3(0.0, 0.04, 1.0), Vec3::zero(), f64::from(i) / 100.0);
        assert!(value.to_f64().iter().all(|x| (0.0..=1.0).contains(x)), "{value:?}");
    }
}
