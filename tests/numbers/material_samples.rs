//! Samples of whole materials against their density.

use glossmith::{
    analysis::chi_square::{PolarGrid, sidak_level, test_samples},
    compile::compile,
    document::{MaterialSettings, assign},
    job::probe::{DrawQuestion, MaterialView, ProbeScene},
    optics::{
        frame::frame_from_normal,
        layer::{material_density, material_layers},
        material::{Material, Surface},
        random::{Sequence, random_pair, random_state},
        vector::{Vec3, vec3},
    },
    render::{EngineChoice, Prober},
};

/// Samples of a case, of which the other density of its row is seen.
const SAMPLES: u32 = 20_000;
/// Views: angle to the normal, turn about it, and how far the shading normal leans towards the viewer, degrees.
const VIEWS: [[f64; 3]; 3] = [[10.0, 0.0, 0.0], [55.0, 35.0, 0.0], [75.0, 0.0, 10.0]];

/// What is drawn, and what makes another density of it: glass of facets, films over both bases, coats on everything, fuzz alone and on gloss.
const CASES: [(&str, &str); 16] = [
    (
        "transmission.weight=1 specular.lobe=ggx specular.roughness=0.6 specular.ior=2.31",
        "specular.ior=2",
    ),
    (
        "transmission.weight=1 specular.lobe=ggx-ndf specular.roughness=0.5",
        "specular.roughness=0.55",
    ),
    (
        "transmission.weight=1 specular.lobe=blinn-phong specular.roughness=0.4",
        "specular.roughness=0.45",
    ),
    (
        "thin_film.weight=1 thin_film.ior=2 thin_film.thickness=0.15 specular.lobe=ggx specular.roughness=0.5 \
         base.color=0.02,0.02,0.02",
        "thin_film.thickness=0.07",
    ),
    (
        "thin_film.weight=1 thin_film.ior=2 thin_film.thickness=0.15 specular.lobe=ggx specular.roughness=0.5 \
         transmission.weight=1",
        "thin_film.thickness=0.07",
    ),
    (
        "coat.weight=1 coat.ior=2 coat.lobe=ggx coat.roughness=0.5 base.color=0.05,0.05,0.05",
        "coat.roughness=0.6",
    ),
    (
        "coat.weight=1 coat.ior=2 coat.lobe=ggx coat.roughness=0.5 base.metalness=1 coat.anisotropy=0.7",
        "coat.anisotropy=0.4",
    ),
    (
        "coat.weight=1 coat.ior=2 coat.lobe=ggx coat.roughness=0.5 transmission.weight=1 coat.anisotropy=-0.5 \
         specular.lobe=ggx specular.roughness=0.5",
        "coat.anisotropy=0.5",
    ),
    (
        "coat.weight=1 coat.roughness=0.2 specular.roughness=0.5",
        "coat.roughness=0.3",
    ),
    (
        "coat.weight=1 coat.roughness=0.2 coat.ior=2 base.metalness=1 specular.roughness=0.3",
        "coat.roughness=0.25",
    ),
    (
        "coat.weight=1 coat.roughness=0.2 base.metalness=0.5 specular.lobe=ggx specular.roughness=0.6",
        "coat.roughness=0.3",
    ),
    (
        "coat.weight=1 coat.roughness=0.6 specular.weight=0",
        "coat.roughness=0.8",
    ),
    (
        "fuzz.weight=1 fuzz.roughness=0.15 specular.weight=0 base.color=0,0,0",
        "fuzz.roughness=0.4",
    ),
    (
        "fuzz.weight=1 fuzz.roughness=0.5 specular.weight=0 base.color=0,0,0",
        "fuzz.roughness=0.4",
    ),
    (
        "fuzz.weight=1 fuzz.roughness=1 specular.weight=0 base.color=0,0,0",
        "fuzz.roughness=0.8",
    ),
    (
        "fuzz.weight=1 fuzz.roughness=0.5 specular.roughness=0.4",
        "fuzz.roughness=0.1",
    ),
];

/// The default material but for assignments on a white dielectric.
pub fn compiled(assignments: &str) -> (Vec<Material<f32>>, Vec<f32>) {
    let mut settings = MaterialSettings::default();
    let dielectric = "base.metalness=0 base.color=1,1,1 specular.fresnel=dielectric";
    for assignment in dielectric.split(' ').chain(assignments.split_whitespace()) {
        assign(&mut settings, assignment).unwrap();
    }
    compile(&[settings])
}

/// The p-value of an engine's samples under the density of a material.
fn p_value(prober: &Prober, scene: &ProbeScene<'_>, supposed: (&Material<f64>, &[f32]), angles_deg: [f64; 3]) -> f64 {
    let [(sine, cosine), (across, along), (leaning, upright)] = angles_deg.map(|angle| angle.to_radians().sin_cos());
    let normal = vec3(0.0, 0.0, 1.0);
    let surface = Surface {
        frame: frame_from_normal(vec3(leaning, 0.0, upright)),
        coat_normal: vec3(leaning, 0.0, upright),
        ..Surface::upwards(vec3(sine * along, sine * across, cosine))
    };
    let single = |v: Vec3<f64>| Vec3::from_f64(v.to_f64());
    let view = MaterialView {
        material: 0,
        is_inside: 0,
        shading: single(surface.frame.normal),
        tangent: single(surface.frame.tangent),
        normal: single(normal),
        wo: single(surface.wo),
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
    let middle = frame_from_normal(surface.wo.mirrored_about(normal));
    let grid = PolarGrid::following(middle, 12, 12, samples.iter().flatten().take(4000).copied());
    let density = |wi| material_density(material, tables, &surface, &layers, wi);
    test_samples(&grid, &samples, &[normal, surface.frame.normal], density).p_value
}

fn assert_follow(engine: EngineChoice) {
    let prober = Prober::open(engine).unwrap();
    let level = sidak_level(1e-3, CASES.len() * VIEWS.len());
    for (assignments, other) in CASES {
        let (materials, tables) = compiled(assignments);
        let (wrong, wrong_tables) = compiled(&format!("{assignments} {other}"));
        let scene = ProbeScene {
            tables: &tables,
            materials: &materials,
            geometry: None,
        };
        let (right, wrong) = (materials[0].cast::<f64>(), wrong[0].cast::<f64>());
        let mut found = false;
        for view in VIEWS {
            let p = p_value(&prober, &scene, (&right, &tables), view);
            assert!(p > level, "{assignments} seen at {view:?}: p = {p:.1e}");
            found = found || p_value(&prober, &scene, (&wrong, &wrong_tables), view) < level;
        }
        assert!(found, "{assignments}: {other} is not seen");
    }
}

#[test]
fn samples_follow_their_density() {
    assert_follow(EngineChoice::Cpu);
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "thorough")]
fn samples_of_the_gpu_follow_their_density() {
    assert_follow(EngineChoice::Gpu);
}
