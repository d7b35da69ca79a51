//! f32 against f64 over random pairs of a document's material and a ray, a case a lobe.

use std::sync::atomic::Ordering;

use super::{HardCase, HardError, Stage};
use crate::compile::compile;
use crate::cpu::probe::probe_material;
use crate::document::{Kind, MaterialSettings, PARAMETERS, Value};
use crate::job::precision::{ERROR_BOUND, relative_error};
use crate::job::probe::{MaterialQuestion, MaterialView, ProbeScene};
use crate::optics::frame::{frame_from_normal, world_from_local};
use crate::optics::lobe::{Horizon, Lobe, LobeShape, lobe_sample};
use crate::optics::random::hash_bits;
use crate::optics::vector::{Vec3, vec3};
use crate::optics::warp::uniform_sphere;
use crate::parallel;
use crate::scene::surface::bent_normal;

/// Pairs a lobe: of a thorough run and of a quick one.
const PAIRS: [usize; 2] = [1_000_000, 10_000];
/// Documents that the pairs are spread over.
const DOCUMENTS: [usize; 2] = [250, 10];
/// Densities of the light's sample, per steradian: the weights of the competing strategies are tried, too.
const LIGHT_DENSITIES: [f32; 3] = [0.08, 10.0, 1e6];

macro_rules! cases {
    ($($module:ident $lobe:ident = $index:literal, $name:literal, $label:literal, $help:literal;)*) => {
        pub(super) const CASES: &[HardCase] = &[$(HardCase {
            name: concat!("f32-against-f64-", $name),
            group: "lobe",
            danger: "terms that cancel lose the digits that f32 has to lose",
            made: "a million random pairs (10 000 in a quick run) of material, any value of every parameter, and of \
                   view, normals and light. Singularities are left out: there one rounding of the light's direction \
                   changes the f64 value by more than 2e-5",
            must: "largest error of the material's value, relative to it (or to 1e-3 of white), against f64",
            naive: || "–".to_owned(),
            measure: "error",
            limit: ERROR_BOUND,
            find: |stage| largest_error(stage, Lobe::$lobe),
        },)*];
    };
}

crate::optics::lobe::list!(cases);

/// Numbers that depend on their place only.
struct Numbers(u32);

impl Numbers {
    fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9);
        hash_bits(hash_bits(self.0) ^ 0x5bd1_e995)
    }
    /// In [0, 1).
    fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / 16_777_216.0
    }
    fn below(&mut self, count: usize) -> usize {
        self.bits() as usize % count.max(1)
    }
    fn direction(&mut self) -> Vec3<f32> {
        uniform_sphere([self.unit(), self.unit()]).normalize()
    }
}

/// Any value of every parameter, one in four of a number's at an end of its range.
fn random_material(numbers: &mut Numbers) -> MaterialSettings {
    let mut material = MaterialSettings::default();
    for parameter in PARAMETERS.iter() {
        let mut within = |[low, high]: [f32; 2]| match numbers.below(8) {
            0 => low,
            1 => high,
            _ => low + (high - low) * numbers.unit(),
        };
        let value = match &parameter.kind {
            Kind::Number { range, .. } => Value::Number(within(*range)),
            Kind::Color | Kind::Tint { .. } => Value::Color([(); 3].map(|()| within([0.0, 1.0]))),
            Kind::Triple { range } => Value::Triple([(); 3].map(|()| within(*range))),
            Kind::Choice(all) => Value::Choice(all[numbers.below(all.len())].name),
            Kind::Toggle => Value::Toggle(numbers.below(2) == 0),
            _ => continue,
        };
        // A value out of its range is refused; these are not.
        let _ = parameter.set(&mut material, value);
    }
    material
}

/// A view of a surface, and a direction of the light: drawn from the lobe every other time.
fn random_question(numbers: &mut Numbers, material: u32, shape: &LobeShape<'_, f32>) -> MaterialQuestion {
    let normal = numbers.direction();
    let around = frame_from_normal(normal);
    let height = numbers.unit().max(1e-3);
    let across = (1.0 - height * height).sqrt();
    let phi_rad = std::f32::consts::TAU * numbers.unit();
    let wo = world_from_local(&around, vec3(across * phi_rad.cos(), across * phi_rad.sin(), height)).normalize();
    let leaning = normal + numbers.direction() * (0.5 * numbers.unit());
    let shading = bent_normal(leaning.normalize(), wo);
    let wi = match numbers.below(2) {
        0 => numbers.direction(),
        _ => {
            let xi = [(); 3].map(|()| numbers.unit());
            lobe_sample(shape, &frame_from_normal(shading), normal, wo, xi).wi
        }
    };
    MaterialQuestion {
        view: MaterialView {
            material,
            is_inside: numbers.below(2) as u32,
            shading,
            tangent: frame_from_normal(shading).tangent,
            normal,
            wo,
        },
        wi,
        light_density: LIGHT_DENSITIES[numbers.below(3)],
        competing: 1.0,
    }
}

fn largest_error(stage: &mut Stage, lobe: Lobe) -> Result<f64, HardError> {
    let which = usize::from(!stage.thorough);
    let (pairs, documents) = (PAIRS[which], DOCUMENTS[which]);
    let settings: Vec<MaterialSettings> = (0..documents)
        .map(|document| {
            let mut numbers = Numbers((document as u32 + 1) * 0x1_0001);
            MaterialSettings {
                lobe,
                ..random_material(&mut numbers)
            }
        })
        .collect();
    let (materials, tables) = compile(&settings);
    let question = |pair: usize| {
        let mut numbers = Numbers(hash_bits(pair as u32) ^ lobe as u32);
        let material = pair % documents;
        let shape = LobeShape {
            horizon: Horizon::Mirror,
            ..materials[material].shape(&tables)
        };
        random_question(&mut numbers, material as u32, &shape)
    };
    let questions: Vec<MaterialQuestion> = parallel::map(pairs, question);
    let scene = ProbeScene {
        tables: &tables,
        materials: &materials,
        geometry: None,
    };
    let answers = stage.prober.materials(&scene, &questions)?;
    let stop = stage.stop();
    let errors = parallel::map(pairs, |pair| match stop.load(Ordering::Relaxed) {
        true => None,
        false => error(&scene, &questions[pair], &answers[pair]),
    });
    stage.check_stop()?;
    let singular = errors.iter().filter(|error| error.is_none()).count();
    log::debug!("{}: {singular} of {pairs} pairs are singular", lobe.name());
    let regular = (0..pairs).filter_map(|pair| Some((pair, errors[pair]?)));
    let Some((worst, error)) = regular.max_by(|a, b| a.1.total_cmp(&b.1)) else {
        return Ok(0.0);
    };
    let question = &questions[worst];
    let right = probe_material::<f64>(&scene, question, [0.0; 2]);
    let (material, answer) = (&materials[question.view.material as usize], answers[worst]);
    log::debug!("{error:.1e} at {question:?} of {material:?}: {answer:?}, right is {right:?}");
    Ok(error)
}

/// Relative error of an answer; 0 at a singularity.
fn error(scene: &ProbeScene<'_>, question: &MaterialQuestion, answer: &Vec3<f32>) -> Option<f64> {
    relative_error(*answer, |moved| probe_material::<f64>(scene, question, moved))
}
