//! Samples of whole materials against their density, drawn by both engines.

use glossmith::analysis::chi_square::{PolarGrid, sidak_level, test_samples};
use glossmith::compile::compile;
use glossmith::document::{MaterialSettings, assign};
use glossmith::job::probe::{DrawQuestion, MaterialView, ProbeScene};
use glossmith::optics::frame::frame_from_normal;
use glossmith::optics::layer::{material_density, material_layers};
use glossmith::optics::material::{Material, Surface};
use glossmith::optics::random::{Sequence, random_pair, random_state};
use glossmith::optics::vector::{Vec3, vec3};
use glossmith::render::EngineChoice;
use glossmith::study::probe::Prober;

/// Samples of a case.
const SAMPLES: u32 = 40_000;
/// Views: angle to the normal, and turn about it, degrees.
const VIEWS: [[f64; 2]; 2] = [[10.0, 0.0], [55.0, 35.0]];
const FILM: [&str; 5] = [
    "thin_film.weight=1",
    "thin_film.ior=2",
    "thin_film.thickness=0.15",
    "specular.lobe=ggx",
    "specular.roughness=0.5",
];
const COAT: [&str; 4] = ["coat.weight=1", "coat.ior=2", "coat.lobe=ggx", "coat.roughness=0.5"];

/// What is drawn, and what makes another density of it.
const CASES: [(&[&str], &[&str], &str); 5] = [
    (&FILM, &["base.color=0.02,0.02,0.02"], "thin_film.thickness=0.07"),
    (&FILM, &["transmission.weight=1"], "thin_film.thickness=0.07"),
    (&COAT, &["base.color=0.05,0.05,0.05"], "coat.roughness=0.55"),
    (
        &COAT,
        &["base.metalness=1", "coat.anisotropy=0.7"],
        "coat.anisotropy=0.5",
    ),
    (
        &COAT,
        &[
            "transmission.weight=1",
            "coat.anisotropy=-0.5",
            "specular.lobe=ggx",
            "specular.roughness=0.5",
        ],
        "coat.anisotropy=0.5",
    ),
];

fn compiled(assignments: &[&str]) -> (Vec<Material<f32>>, Vec<f32>) {
    let mut settings = MaterialSettings::default();
    let dielectric = ["base.metalness=0", "specular.fresnel=dielectric"];
    for assignment in dielectric.iter().chain(assignments) {
        assign(&mut settings, assignment).unwrap();
    }
    compile(&[settings])
}

/// The p-value of an engine's samples under the density of a material.
fn p_value(
    prober: &Prober,
    scene: &ProbeScene<'_>,
    supposed: (&Material<f64>, &[f32]),
    [angle_deg, turn_deg]: [f64; 2],
) -> f64 {
    let ((sine, cosine), (across, along)) = (angle_deg.to_radians().sin_cos(), turn_deg.to_radians().sin_cos());
    let normal = vec3(0.0, 0.0, 1.0);
    let wo = vec3(sine * along, sine * across, cosine);
    let surface = Surface::upwards(wo);
    let view = MaterialView {
        material: 0,
        is_inside: 0,
        shading: normal,
        tangent: Vec3::from_f64(surface.frame.tangent.to_f64()),
        normal,
        wo: Vec3::from_f64(wo.to_f64()),
    };
    let questions: Vec<_> = (0..SAMPLES)
        .map(|i| {
            let state = random_state(5, 0, 0, i, Sequence::Independent);
            let ([a, b], [c, facet], [d, e]) = (random_pair(state, 0), random_pair(state, 1), random_pair(state, 2));
            DrawQuestion {
                view,
                lobe: [a, b, c],
                facet,
                below: [d, e, facet],
            }
        })
        .collect();
    let drawn = prober.draws(scene, &questions).unwrap();
    let samples: Vec<Option<Vec3<f64>>> = drawn
        .iter()
        .map(|drawn| (drawn.throughput.max_component() > 0.0).then(|| Vec3::from_f64(drawn.wi.to_f64())))
        .collect();
    let (material, tables) = supposed;
    let layers = material_layers(material, tables, &surface);
    let middle = frame_from_normal(surface.wo.mirrored_about(surface.normal));
    let grid = PolarGrid::following(middle, 12, 12, samples.iter().flatten().take(4000).copied());
    let density = |wi| material_density(material, tables, &surface, &layers, wi);
    test_samples(&grid, &samples, &[surface.normal], density).p_value
}

/// Films over both bases, and coats of GGX, stretched along and across.
#[test]
fn samples_follow_their_density_on_both_engines() {
    let mut worst: f64 = 1.0;
    let level = sidak_level(1e-3, 2 * CASES.len() * VIEWS.len());
    for (layer, others, other) in CASES {
        let assignments = [layer, others].concat();
        let (materials, tables) = compiled(&assignments);
        let (wrong, wrong_tables) = compiled(&[&assignments[..], &[other]].concat());
        let scene = ProbeScene {
            tables: &tables,
            materials: &materials,
            geometry: None,
        };
        let (right, wrong) = (materials[0].cast::<f64>(), wrong[0].cast::<f64>());
        for engine in [EngineChoice::Cpu, EngineChoice::Gpu] {
            let prober = Prober::open(engine).unwrap();
            let mut found = false;
            for view in VIEWS {
                let p = p_value(&prober, &scene, (&right, &tables), view);
                worst = worst.min(p);
                assert!(p > level, "{engine:?}, {assignments:?} seen at {view:?}: p = {p:.1e}");
                found |= p_value(&prober, &scene, (&wrong, &wrong_tables), view) < level;
            }
            assert!(found, "{engine:?}, {assignments:?}: another density is not seen");
        }
    }
    println!("least p {worst:.3}");
}
