//! f32 against f64 over random pairs of a document's material and a ray, a case a lobe.

use std::sync::atomic::Ordering;

use super::{HardCase, Stage, StudyError};
use crate::{
    compile::compile,
    cpu::probe::probe_material,
    document::{CoatLobe, Kind, MaterialSettings, PARAMETERS, Value},
    job::precision::{ERROR_BOUND, relative_error},
    job::probe::{MaterialQuestion, MaterialView, ProbeScene},
    optics::{
        frame::{frame_from_normal, world_from_local},
        lobe::{Horizon, Lobe, LobeShape, lobe_sample},
        material::Material,
        random::hash_bits,
        vector::{Vec3, vec3},
        warp::uniform_sphere,
    },
    parallel,
    scene::surface::bent_normal,
};

/// Pairs a lobe: of a thorough run and of a quick one.
const PAIRS: [usize; 2] = [1_000_000, 10_000];
/// Documents that the pairs are spread over.
const DOCUMENTS: [usize; 2] = [250, 10];
/// Densities of the light's sample, per steradian: the weights of the competing strategies are tried, too.
const LIGHT_DENSITIES: [f32; 3] = [0.08, 10.0, 1e6];
const COSINES: [f32; 5] = [1.0, 0.7, 0.2, 0.001, 1e-6];

macro_rules! cases {
    ($($module:ident $lobe:ident = $index:literal, $name:literal, $label:literal, $help:literal;)*) => {
        pub(super) const CASES: &[HardCase] = &[AT_ITS_ENDS, $(HardCase {
            name: concat!("f32-against-f64-", $name),
            group: "lobe",
            danger: "terms that cancel lose the digits that f32 has to lose",
            made: "a million random pairs (10 000 in a quick run) of material, any value of every parameter, and of \
                   view, normals and light. Singularities are left out: there one rounding of the light's direction \
                   changes the f64 value by more than 2e-5",
            must: "largest error of the material's value, relative to it (or to 1e-3 of white), against f64",
            naive: "–",
            measure: "error",
            limit: ERROR_BOUND,
            find: |stage| largest_error(stage, Lobe::$lobe),
        },)*];
    };
}

crate::optics::lobe::list!(cases);

const AT_ITS_ENDS: HardCase = HardCase {
    name: "coat-at-its-ends",
    group: "lobe",
    danger: "a coat that reflects all over a white base is 0/0, and its way at index 1 has no end at the horizon",
    made: "coats of weight 0, 1e-6 and 1, roughness 0 and 1, index 1 and 3, white to black. Metal, gloss and glass below; \
           cosines from 1 to 1e-6",
    must: "every value is finite and not negative, and that of f64",
    naive: "NaN",
    measure: "error",
    limit: ERROR_BOUND,
    find: largest_error_of_coats,
};

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
            Kind::Number { range, .. } => Value::Number(within(range.map(|end| end as f32)).into()),
            Kind::Color { .. } => Value::Color([(); 3].map(|()| within([0.0, 1.0]))),
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
    let height = numbers.unit().max(0.001);
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

fn largest_error(stage: &mut Stage, lobe: Lobe) -> Result<f64, StudyError> {
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
    let question = |pair: usize, materials: &[Material<f32>], tables: &[f32]| {
        let mut numbers = Numbers(hash_bits(pair as u32) ^ lobe as u32);
        let material = pair % documents;
        let shape = LobeShape {
            horizon: Horizon::Mirror,
            ..materials[material].shape(tables)
        };
        random_question(&mut numbers, material as u32, &shape)
    };
    let answers = answers(stage, &settings, pairs, question)?;
    Ok(answers.into_iter().filter_map(|(_, error)| error).fold(0.0, f64::max))
}

/// Values of materials with their errors; none where the value is singular.
#[expect(clippy::type_complexity, reason = "pairs")]
fn answers(
    stage: &Stage,
    settings: &[MaterialSettings],
    count: usize,
    question: impl Fn(usize, &[Material<f32>], &[f32]) -> MaterialQuestion + Sync,
) -> Result<Vec<(Vec3<f32>, Option<f64>)>, StudyError> {
    let (materials, tables) = compile(settings);
    let questions = parallel::map(count, |index| question(index, &materials, &tables));
    let scene = ProbeScene {
        tables: &tables,
        materials: &materials,
        geometry: None,
    };
    let answers = stage.prober.materials(&scene, &questions)?;
    let stop = &stage.stop;
    let errors = parallel::map(count, |index| {
        let right = |moved| probe_material::<f64>(&scene, &questions[index], moved);
        (!stop.load(Ordering::Relaxed))
            .then(|| relative_error(answers[index], right))
            .flatten()
    });
    stage.check_stop()?;
    Ok(answers.into_iter().zip(errors).collect())
}

/// Every coat over every base.
fn coated() -> Vec<MaterialSettings> {
    let mut all = Vec::new();
    let bases = [(1.0, 0.0), (0.0, 0.0), (0.0, 1.0)];
    for (number, (metalness, transmission_weight)) in (0..).zip(bases) {
        for ends in 0..24_u32 {
            let [is_rough, is_dense, is_grey] = [1, 2, 4].map(|bit| ends & bit != 0);
            let color = [[1.0; 3], [0.9, 0.5, 0.2], [0.0; 3]][(ends as usize + number) % 3];
            all.push(MaterialSettings {
                metalness,
                transmission_weight,
                base_color: [if is_grey { 0.5 } else { 1.0 }; 3],
                coat_weight: [0.0, 1e-6, 1.0][ends as usize / 8],
                coat_roughness: f32::from(is_rough),
                coat_lobe: if is_rough { CoatLobe::Ggx } else { CoatLobe::Geometric },
                coat_ior: if is_dense { 3.0 } else { 1.0 },
                coat_color: color,
                ..MaterialSettings::default()
            });
        }
    }
    all
}

fn question(material: u32, cosines: [f32; 2], azimuth_rad: f32) -> MaterialQuestion {
    let up = vec3(0.0, 0.0, 1.0);
    let [wo, wi] = [(cosines[0], 0.0), (cosines[1], azimuth_rad)].map(|(cosine, azimuth)| {
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        vec3(sine * azimuth.cos(), sine * azimuth.sin(), cosine)
    });
    MaterialQuestion {
        view: MaterialView {
            material,
            is_inside: 0,
            shading: up,
            tangent: vec3(1.0, 0.0, 0.0),
            normal: up,
            wo,
        },
        wi,
        light_density: 1.0,
        competing: 0.0,
    }
}

fn largest_error_of_coats(stage: &mut Stage) -> Result<f64, StudyError> {
    let settings = coated();
    let question = |index: usize, _: &[Material<f32>], _: &[f32]| {
        let [light, view, material] = [index / 2, index / 10, index / 50];
        question(
            material as u32,
            [view, light].map(|i| COSINES[i % 5]),
            [0.3, 2.9][index % 2],
        )
    };
    let answers = answers(stage, &settings, 50 * settings.len(), question)?;
    let is_sound = |value: Vec3<f32>| value.to_f64().iter().all(|x| x.is_finite() && *x >= 0.0);
    let error = |(value, error)| {
        if is_sound(value) {
            Option::unwrap_or_default(error)
        } else {
            f64::INFINITY
        }
    };
    Ok(answers.into_iter().map(error).fold(0.0, f64::max))
}
