//! The fuzz layer: its albedo by the published fits, samples against their density, the furnace, and both engines.

use glossmith::analysis::chi_square::{PolarGrid, test_samples};
use glossmith::compile::compile;
use glossmith::document::{Document, MaterialSettings, Strategy, TextureUse, assign};
use glossmith::optics::frame::frame_from_normal;
use glossmith::optics::layer::{MaterialNumbers, material_density, material_layers, material_sample};
use glossmith::optics::material::{Material, Surface};
use glossmith::optics::random::{Sequence, random_pair, random_state};
use glossmith::optics::vector::{Vec3, vec3};
use glossmith::render::{EngineChoice, Precision};
use glossmith::scene::environment::EnvironmentSource;
use glossmith::scene::texture::TextureTarget;
use glossmith::study::evaluate::Evaluator;
use image::{Rgba, RgbaImage};
use serde_json::json;

use crate::gltf_builder::Folder;
use crate::own_textures::coated_on_a_box;
use crate::renders::{assert_same_picture, render, with_strategy};
use crate::textures::{head_on, textured_square};

const ENGINES: [(EngineChoice, Precision); 2] = [
    (EngineChoice::Cpu, Precision::Single),
    (EngineChoice::Cpu, Precision::Double),
];
/// The GPU, which compiles a kernel for each material that is asked about: for few of them.
const GPU: (EngineChoice, Precision) = (EngineChoice::Gpu, Precision::Single);
/// Albedos of the fits at these cosines, by roughness (review of the physics, part 3.3).
const COSINES: [f64; 4] = [1.0, 0.5, 0.2, 0.05];
const ALBEDOS: [(f64, [f64; 4]); 3] = [
    (0.2, [0.0003, 0.0010, 0.0963, 0.4706]),
    (0.5, [0.0249, 0.1497, 0.4295, 0.6235]),
    (1.0, [0.3446, 0.4957, 0.6432, 0.7205]),
];
/// Samples of a case.
const SAMPLES: u32 = 40_000;

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

/// Textures of the fuzz alone: both engines and all strategies draw the same, and each of the three shows.
#[test]
fn strategies_and_engines_agree_on_textured_fuzz() {
    let folder = Folder::new();
    let material = json!({
        "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.5, "baseColorFactor": [0.06, 0.03, 0.01, 1]},
        "extensions": {"KHR_materials_fuzz": {
            "fuzzFactor": 1, "fuzzTexture": {"index": 0}, "fuzzColorTexture": {"index": 0},
            "fuzzRoughnessFactor": 1, "fuzzRoughnessTexture": {"index": 0},
        }},
    });
    let texels = [
        [255, 200, 40, 255],
        [200, 20, 120, 60],
        [120, 250, 250, 160],
        [60, 160, 255, 255],
    ];
    let picture = RgbaImage::from_fn(2, 2, |x, y| Rgba(texels[(x + 2 * y) as usize]));
    let (buffer, json) = textured_square(&material, &[picture], &json!({}));
    let mut document = head_on(&folder, &buffer, &json, EnvironmentSource::Studio);
    (document.camera.yaw_deg, document.camera.pitch_deg) = (30.0, 25.0);
    (document.camera.distance, document.camera.fov_deg) = (Some(3.0), 40.0);
    document.render.samples = 512;
    let uses = document.materials[0].textures;
    assert!(uses.fuzz && uses.fuzz_color && uses.fuzz_roughness);
    let cpu = render(EngineChoice::Cpu, &document);
    assert_eq!(cpu.dropped(), 0);
    for strategy in [Strategy::Lobe, Strategy::Light] {
        let other = render(EngineChoice::Cpu, &with_strategy(&document, strategy, 9));
        assert_same_picture(&cpu, &other, &format!("{strategy:?}"));
    }
    let gpu = render(EngineChoice::Gpu, &with_strategy(&document, Strategy::Mis, 5));
    assert_same_picture(&cpu, &gpu, "on the GPU");
    for leave_out in [
        (|uses| uses.fuzz = false) as fn(&mut TextureUse),
        |uses| uses.fuzz_color = false,
        |uses| uses.fuzz_roughness = false,
    ] {
        let mut without = with_strategy(&document, Strategy::Mis, 9);
        leave_out(&mut without.materials[0].textures);
        let plain = render(EngineChoice::Cpu, &without);
        assert!(std::panic::catch_unwind(|| assert_same_picture(&cpu, &plain, "without")).is_err());
    }
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

#[test]
fn the_gpu_has_the_same_fuzz() {
    let material = fuzzy(0.0, 0.5, &["coat.weight=0.5", "coat.roughness=0.4"]);
    let [exact, found] = [ENGINES[1], GPU].map(|(engine, precision)| {
        let evaluator = Evaluator::open(&material, engine, precision).unwrap();
        let albedos = COSINES.map(|cosine| evaluator.albedo(cosine, 1 << 12, 1).unwrap().reflected[0]);
        let directions = [[0.6, 0.0, 0.8], [-0.6, 0.48, 0.64], [0.0, 0.96, 0.28]].map(Vec3::from_f64);
        let pairs = directions.map(|wi| [directions[0], wi]);
        (albedos, evaluator.evaluate(&pairs).unwrap())
    });
    for (exact, found) in std::iter::zip(exact.0, found.0) {
        assert!((exact - found).abs() < 1e-4, "albedo {found} for {exact}");
    }
    for (exact, found) in std::iter::zip(exact.1, found.1) {
        let apart = (exact.value[0] - found.value[0]).abs() + (exact.density - found.density).abs();
        assert!(apart < 1e-3 * exact.density, "{found:?} for {exact:?}");
    }
}

#[test]
fn white_fuzz_over_white_layers_keeps_all_light() {
    for more in [
        &[][..],
        &["fuzz.weight=0.3"],
        &["coat.weight=1", "coat.roughness=0.3"],
        &["base.metalness=1", "specular.weight=1", "specular.roughness=0.4"],
        &["specular.weight=1", "specular.lobe=ggx", "specular.roughness=0.5"],
    ] {
        for (engine, precision) in ENGINES {
            let evaluator = Evaluator::open(&fuzzy(1.0, 0.6, more), engine, precision).unwrap();
            for cosine in COSINES {
                let found = evaluator.albedo(cosine, 1 << 15, 1).unwrap().reflected[1];
                assert!((found - 1.0).abs() < 4e-3, "{engine:?}, {more:?}, {cosine}: {found}");
            }
        }
    }
}

/// Values for themselves and drawn ones agree: the sum over a grid is the albedo.
#[test]
fn values_add_up_to_the_albedo() {
    const STEPS: usize = 60;
    let direction = |theta: f64, phi: f64| {
        let (sine, cosine) = theta.sin_cos();
        Vec3::from_f64([sine * phi.cos(), sine * phi.sin(), cosine])
    };
    for (engine, precision) in ENGINES {
        for (roughness, expected) in ALBEDOS {
            let evaluator = Evaluator::open(&fuzzy(0.0, roughness, &[]), engine, precision).unwrap();
            // At 60 degrees, the second cosine.
            let wo = direction(60.0_f64.to_radians(), 0.7);
            let step = std::f64::consts::FRAC_PI_2 / STEPS as f64;
            let thetas: Vec<f64> = (0..STEPS).map(|i| step * (i as f64 + 0.5)).collect();
            let pairs: Vec<_> = thetas
                .iter()
                .flat_map(|theta| (0..2 * STEPS).map(move |turn| (*theta, 2.0 * step * turn as f64)))
                .map(|(theta, phi)| [wo, direction(theta, phi)])
                .collect();
            let found = evaluator.evaluate(&pairs).unwrap();
            let sum = |of: &dyn Fn(usize) -> f64| -> f64 {
                let cell = |i: usize| of(i) * thetas[i / (2 * STEPS)].sin() * step * 2.0 * step;
                (0..pairs.len()).map(cell).sum()
            };
            let (albedo, density) = (sum(&|i| found[i].value[0]), sum(&|i| found[i].density));
            assert!((albedo - expected[1]).abs() < 2e-3, "{engine:?}, {roughness}: {albedo}");
            assert!((density - 1.0).abs() < 5e-3, "{engine:?}, {roughness}: {density}");
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
    let grid = PolarGrid::following(middle, 12, 12, samples.iter().flatten().take(4000).copied());
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

/// Both ends: no weight is no layer, the least roughness and grazing views stay finite.
#[test]
fn both_ends_of_fuzz_are_finite() {
    let bare = fuzzy(0.5, 0.5, &["fuzz.weight=0"]);
    for (engine, precision) in ENGINES {
        let evaluator = Evaluator::open(&bare, engine, precision).unwrap();
        let found = evaluator.albedo(0.5, 1 << 10, 1).unwrap().reflected[0];
        assert!((found - 0.5).abs() < 1e-5, "{found}");
        for (weight, roughness) in [(1e-6, 0.5), (1.0, 0.0), (1.0, 1.0)] {
            let material = fuzzy(1.0, roughness, &[&format!("fuzz.weight={weight}")]);
            let evaluator = Evaluator::open(&material, engine, precision).unwrap();
            for cosine in [1.0, 0.3, 1e-3] {
                let found = evaluator.albedo(cosine, 1 << 12, 1).unwrap().reflected[0];
                assert!(
                    (found - 1.0).abs() < 1e-2,
                    "{engine:?}, {weight}, {roughness}, {cosine}: {found}"
                );
            }
            let grazing = Vec3::from_f64([1.0, 0.0, 1e-7]);
            let values = evaluator.evaluate(&[[grazing, grazing]]).unwrap()[0];
            assert!(values.value[0].is_finite() && values.density.is_finite(), "{values:?}");
        }
    }
}
