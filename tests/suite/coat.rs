//! The coat and the edge tint: samples against the density of the whole mixture, energy, engines and strategies.

use glossmith::analysis::chi_square::{PolarGrid, sidak_level, test_samples};
use glossmith::compile::compile;
use glossmith::document::{MaterialSettings, Strategy, assign};
use glossmith::optics::frame::frame_from_normal;
use glossmith::optics::fresnel::{fresnel_metal, fresnel_schlick};
use glossmith::optics::layer::{
    Layer, MaterialNumbers, base::Base, coat::Coat, layer_evaluate, material_layers, material_sample,
    specular::Specular,
};
use glossmith::optics::material::{Material, Surface};
use glossmith::optics::random::{Sequence, random_pair, random_state};
use glossmith::optics::vector::{Vec3, vec3};
use glossmith::render::EngineChoice;
use glossmith::scene::ModelSource;
use glossmith::scene::environment::EnvironmentSource;

use super::renders::{assert_same_picture, document, render, with_strategy};

/// Samples of a case.
const SAMPLES: u32 = 40_000;

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
        12,
        12,
        samples.iter().flatten().take(4000).copied(),
    );
    let mut supposed = *material;
    supposed.coat_roughness *= factor;
    let cuts = [surface.normal, surface.frame.normal];
    test_samples(&grid, &samples, &cuts, |wi| density(&supposed, tables, &surface, wi)).p_value
}

/// The variance of what 64 samples of a material tell of a light that is bright on one side, over that of independent
/// numbers. Of numbers `apart` the first one is of another pair than the second.
fn variance_left(material: &Material<f64>, tables: &[f32], apart: bool) -> f64 {
    let surface = surface(45.0);
    let layers = material_layers(material, tables, &surface);
    let light = |wi: Vec3<f64>| 1.0 + wi.x + 0.5 * wi.y;
    let mean_of_stream = |x: u32, sequence| {
        let sample = |i: u32| {
            let state = random_state(x, 0, 5, i, sequence);
            let ([a, b], [c, facet]) = (random_pair(state, 0), random_pair(state, 1));
            let [other, _] = random_pair(state, 2);
            let lobe = [if apart { other } else { a }, b, c];
            let numbers = MaterialNumbers {
                lobe,
                facet,
                below: lobe,
            };
            let drawn = material_sample(material, tables, &surface, &layers, numbers, false);
            drawn.throughput.luminance() * light(drawn.wi)
        };
        (0..64).map(sample).sum::<f64>() / 64.0
    };
    let variance = |sequence| {
        let means: Vec<f64> = (0..400).map(|x| mean_of_stream(x, sequence)).collect();
        let mean = means.iter().sum::<f64>() / means.len() as f64;
        means.iter().map(|x| (x - mean).powi(2)).sum::<f64>()
    };
    variance(Sequence::Sobol) / variance(Sequence::Independent)
}

/// The number that chooses a layer draws from it, too: so each layer's directions are spread as evenly as the points.
#[test]
fn layers_draw_evenly() {
    let cases = [
        &["base.metalness=0", "specular.lobe=ggx", "specular.roughness=0.3"][..],
        &["base.metalness=0", "specular.roughness=0.5", "specular.ior=2"],
        &["base.metalness=0", "specular.roughness=0.3", "coat.weight=1"],
    ];
    for case in cases {
        let (material, tables) = material(case);
        let even = variance_left(&material, &tables, false);
        let uneven = variance_left(&material, &tables, true);
        assert!(2.0 * even < uneven, "{case:?}: {even}, of numbers apart {uneven}");
    }
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
    let angles = [0.0, 45.0, 80.0];
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

/// The coat takes what it reflects from what is below it.
#[test]
fn a_coat_over_white_is_white_in_the_furnace() {
    for choice in [EngineChoice::Cpu, EngineChoice::Gpu] {
        for assignments in [
            &["base.metalness=0", "base.color=1,1,1", "coat.roughness=0"][..],
            &[
                "base.metalness=0",
                "base.color=1,1,1",
                "coat.roughness=0.4",
                "coat.weight=0.5",
            ],
            &[
                "base.metalness=1",
                "base.color=1,1,1",
                "coat.roughness=0.8",
                "coat.ior=2.2",
            ],
            &[
                "base.metalness=0",
                "base.color=1,1,1",
                "transmission.weight=1",
                "coat.roughness=0.3",
            ],
            &[
                "base.metalness=0",
                "base.color=1,1,1",
                "coat.lobe=ggx",
                "coat.roughness=0.6",
            ],
            // By azimuth it is up to 1 % off, over all of them it is white.
            &[
                "base.metalness=0",
                "base.color=1,1,1",
                "coat.lobe=ggx",
                "coat.roughness=0.4",
                "coat.anisotropy=0.7",
            ],
        ] {
            let all = [&["coat.weight=1", "specular.roughness=0.3"], assignments].concat();
            let mut document = document(ModelSource::Sphere, EnvironmentSource::Furnace, &all);
            document.lighting.background = glossmith::document::Background::Transparent;
            let film = render(choice, &document);
            let alpha: f64 = film.colors().map(|color| color[3]).sum();
            let value = film.colors().map(|color| color[1]).sum::<f64>() / alpha;
            println!("{choice:?} {assignments:?} {value}");
            assert!((value - 1.0).abs() < 4e-3, "{choice:?}, {assignments:?}: {value}");
            assert_eq!(film.dropped(), 0);
        }
    }
}

/// A rough coat over metal in part.
pub const COATED: [&str; 8] = [
    "base.metalness=0.3",
    "base.color=0.7,0.1,0.05",
    "base.weight=0.8",
    "specular.roughness=0.5",
    "specular.edge_tint=0.2,0.6,1",
    "coat.weight=0.9",
    "coat.roughness=0.5",
    "coat.color=0.6,0.9,0.8",
];

#[test]
fn strategies_agree_on_a_coat() {
    let mut document = document(ModelSource::Sphere, EnvironmentSource::Studio, &COATED);
    // Sampling the lobe alone finds bright light rarely: many samples, until their means are normal.
    document.render.samples = 2048;
    (document.render.width, document.render.height) = (32, 32);
    let cpu = render(EngineChoice::Cpu, &document);
    assert_eq!(cpu.dropped(), 0);
    for strategy in [Strategy::Lobe, Strategy::Light] {
        let other = render(EngineChoice::Cpu, &with_strategy(&document, strategy, 9));
        assert_same_picture(&cpu, &other, &format!("{strategy:?}"));
    }
}

/// A ball that shines under a coloured coat lights the ground: light sampling and paths that hit it see the same colours.
#[test]
fn strategies_and_engines_agree_on_light_from_below_a_coat() {
    let shining = [
        "emission.strength=3",
        "base.metalness=0",
        "coat.weight=0.8",
        "coat.ior=1.1",
        "coat.color=0.9,0.4,0.1",
    ];
    let mut document = document(ModelSource::Sphere, EnvironmentSource::Furnace, &shining);
    document.ground = true;
    document.lighting.strength = 0.0;
    // From above: rays from ground far away meet the ball too rarely for means that are normal.
    document.camera.pitch_deg = 75.0;
    document.render.samples = 1024;
    (document.render.width, document.render.height) = (32, 32);
    let cpu = render(EngineChoice::Cpu, &document);
    assert_eq!(cpu.dropped(), 0);
    let by_lobe = render(EngineChoice::Cpu, &with_strategy(&document, Strategy::Lobe, 9));
    assert_same_picture(&cpu, &by_lobe, "by the lobe");
    let gpu = render(EngineChoice::Gpu, &with_strategy(&document, Strategy::Mis, 5));
    assert_same_picture(&cpu, &gpu, "on the GPU");
    // Sees the test fail where the coat does not dim the emission.
    document.materials[0].coat_on_base = false;
    let bright = render(EngineChoice::Cpu, &document);
    assert!(std::panic::catch_unwind(|| assert_same_picture(&cpu, &bright, "not dimmed")).is_err());
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
