//! The fuzz layer: its albedo by the published fits, and samples against their density.

use glossmith::analysis::chi_square::{PolarGrid, test_samples};
use glossmith::compile::compile;
use glossmith::document::{Document, MaterialSettings, assign};
use glossmith::optics::frame::frame_from_normal;
use glossmith::optics::layer::{MaterialNumbers, material_density, material_layers, material_sample};
use glossmith::optics::material::{Material, Surface};
use glossmith::optics::random::{Sequence, random_pair, random_state};
use glossmith::optics::vector::{Vec3, vec3};
use glossmith::render::{EngineChoice, Precision};
use glossmith::scene::texture::TextureTarget;
use glossmith::study::evaluate::Evaluator;

use crate::gltf_builder::Folder;
use crate::own_textures::coated_on_a_box;

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
/// Samples of a case.
const SAMPLES: u32 = 20_000;

/// Fuzz of weight 1 over a matt base.
fn fuzzy(base: f64, roughness: f64, more: &[&str]) -> MaterialSettings {
    let mut material = MaterialSettings::default();
    let assignments = [
        "base.metalness=0",
        "specular.weight=0",
        "fuzz.weight=1",
        &format!("base.color={base},{base},{base}"),
        &format!("fuzz.roughness={roughness}"),
    ];
    for assignment in assignments.iter().chain(more) {
        assign(&mut material, assignment).unwrap();
    }
    material
}

/// A ball whose fuzz has the weight that a picture on a box gives it.
pub fn fuzzy_on_a_box(folder: &Folder) -> Document {
    let mut document = coated_on_a_box(folder);
    let picture = document.materials[0].user_textures.get(TextureTarget::Coat).cloned();
    document.materials[0] = fuzzy(0.1, 0.5, &[]);
    document.materials[0].put_texture(TextureTarget::Fuzz, picture.unwrap());
    document
}

#[test]
fn fuzz_over_black_has_the_albedo_of_the_fits() {
    for (engine, precision) in ENGINES {
        for (roughness, expected) in ALBEDOS {
            let material = fuzzy(0.0, roughness, &["fuzz.color=1,0.5,0"]);
            let evaluator = Evaluator::open(&material, engine, precision).unwrap();
            for (cosine, expected) in COSINES.iter().zip(expected) {
                let [red, green, blue] = evaluator.albedo(*cosine, 1 << 12, 1).unwrap().reflected;
                let what = format!("{engine:?}, {roughness}, {cosine}: {red} for {expected}");
                assert!((red - expected).abs() < 1e-4, "{what}");
                assert!(
                    (green - 0.5 * red).abs() < 1e-5 && blue == 0.0,
                    "{what}, {green}, {blue}"
                );
            }
        }
    }
}

/// The p-value of samples of fuzz alone, or over a gloss, under a density that takes it for fuzz of another roughness.
fn p_value(material: &Material<f64>, tables: &[f32], supposed: &Material<f64>, angle_deg: f64) -> f64 {
    let (sine, cosine) = angle_deg.to_radians().sin_cos();
    let normal = vec3(0.0, 0.0, 1.0);
    let surface = Surface {
        // The shading normal leans, so that some samples are mirrored at the horizon.
        frame: frame_from_normal(vec3(0.0, 0.17, 1.0).normalize()),
        normal,
        wo: vec3(sine, 0.0, cosine),
        coat_normal: normal,
        is_inside: false,
    };
    let layers = material_layers(material, tables, &surface);
    let samples: Vec<Option<Vec3<f64>>> = (0..SAMPLES)
        .map(|i| {
            let state = random_state(5, 0, 0, i, Sequence::Independent);
            let ([a, b], [c, facet], [d, e]) = (random_pair(state, 0), random_pair(state, 1), random_pair(state, 2));
            let numbers = MaterialNumbers {
                lobe: [a, b, c],
                facet,
                below: [d, e, facet],
            };
            let drawn = material_sample(material, tables, &surface, &layers, numbers, true);
            (drawn.throughput.max_component() > 0.0).then_some(drawn.wi)
        })
        .collect();
    let middle = frame_from_normal(surface.wo.mirrored_about(normal));
    let grid = PolarGrid::following(middle, 8, 8, samples.iter().flatten().take(4000).copied());
    let density = |wi| material_density(supposed, tables, &surface, &layers, wi);
    test_samples(&grid, &samples, &[normal], density).p_value
}

#[test]
fn samples_follow_their_density() {
    let mut worst: f64 = 1.0;
    for (roughness, more) in [
        (0.15, &[][..]),
        (0.5, &[]),
        (1.0, &[]),
        (
            0.5,
            &["base.color=1,1,1", "specular.weight=1", "specular.roughness=0.4"],
        ),
    ] {
        let of = |roughness: f64| {
            let (materials, tables) = compile(&[fuzzy(0.0, roughness, more)]);
            (materials[0].cast::<f64>(), tables)
        };
        let ((material, tables), (wrong, _)) = (of(roughness), of(0.8 * roughness));
        let mut found = false;
        for angle_deg in [10.0, 50.0, 80.0] {
            let p = p_value(&material, &tables, &material, angle_deg);
            worst = worst.min(p);
            assert!(p > 1e-4, "{roughness}, {more:?} at {angle_deg} degrees: p = {p:.1e}");
            found |= p_value(&material, &tables, &wrong, angle_deg) < 1e-4;
        }
        assert!(found, "{roughness}, {more:?}: another roughness is not seen");
    }
    println!("least p {worst:.3}");
}
