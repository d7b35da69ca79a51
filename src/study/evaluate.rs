//! Values, densities and albedos of a material, by the functions that the engines render with.
//!
//! The frame has the surface's outer normal as +z and the tangent, before the material's rotation, as +x. A viewer below
//! sees the surface from within.

use crate::{
    compile::compile,
    cpu::probe as cpu,
    document::MaterialSettings,
    gpu::GpuError,
    job::probe::{DrawAnswer, DrawQuestion, MaterialQuestion, MaterialView, ProbeScene},
    optics::{
        material::Material,
        random::{Sequence, random_pair, random_state},
        vector::{Vec3, vec3},
    },
    render::{EngineChoice, Precision, Prober},
};

/// Independent randomisations of the Sobol sequence, whose spread gives the standard errors of albedos.
pub const BATCHES: u32 = 16;

/// Value and density of a material for a pair of directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evaluation {
    /// Value times the cosine at the surface, linear RGB, per steradian.
    pub value: [f64; 3],
    /// Density of sampling the direction to the light, per steradian.
    pub density: f64,
}

/// Directional albedo of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Albedo {
    /// Share of light that leaves on the viewer's side, linear RGB.
    pub reflected: [f64; 3],
    /// Share of light that leaves on the other side, linear RGB.
    pub transmitted: [f64; 3],
    /// Standard errors of both, of the channel with the largest.
    pub standard_errors: [f64; 2],
}

/// Evaluates a material.
pub struct Evaluator {
    materials: Vec<Material<f32>>,
    tables: Vec<f32>,
    /// Functions of an engine; `None` for those in f64.
    prober: Option<Prober>,
}

impl Evaluator {
    /// Opens the requested engine for a material, without its textures. f64 is computed on the CPU.
    pub fn open(material: &MaterialSettings, engine: EngineChoice, precision: Precision) -> Result<Self, GpuError> {
        let plain = MaterialSettings {
            textures: Default::default(),
            user_textures: Default::default(),
            ..material.clone()
        };
        let (materials, tables) = compile(&[plain]);
        let prober = match precision {
            Precision::Single => Some(Prober::open(engine)?),
            Precision::Double => None,
        };
        Ok(Self {
            materials,
            tables,
            prober,
        })
    }

    /// True if the material has light on both sides.
    pub fn transmits(&self) -> bool {
        self.materials[0].transmits()
    }

    /// Values and densities for pairs of unit directions to the viewer and to the light.
    pub fn evaluate(&self, pairs: &[[Vec3<f32>; 2]]) -> Result<Vec<Evaluation>, GpuError> {
        let question = |&[wo, wi]: &[Vec3<f32>; 2]| MaterialQuestion {
            view: self.view(wo),
            wi,
            light_density: 1.0,
            competing: 0.0,
        };
        let questions: Vec<_> = pairs.iter().map(question).collect();
        let scene = self.scene();
        let (values, densities): (Vec<_>, Vec<_>) = match &self.prober {
            Some(prober) => (
                prober
                    .materials(&scene, &questions)?
                    .into_iter()
                    .map(|value| value.to_f64())
                    .collect(),
                prober
                    .densities(&scene, &questions)?
                    .into_iter()
                    .map(f64::from)
                    .collect(),
            ),
            None => (
                cpu::probe_materials::<f64>(&scene, &questions)
                    .into_iter()
                    .map(|value| value.to_f64())
                    .collect(),
                cpu::probe_density::<f64>(&scene, &questions),
            ),
        };
        Ok(values
            .into_iter()
            .zip(densities)
            .map(|(value, density)| Evaluation { value, density })
            .collect())
    }

    /// Albedo for a view in the plane of normal and tangent, from about `count` samples; a negative cosine is a view from
    /// below.
    pub fn albedo(&self, cosine: f64, count: u32, seed: u32) -> Result<Albedo, GpuError> {
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let view = self.view(Vec3::from_f64([sine, 0.0, cosine]));
        let of_batch = count.div_ceil(BATCHES).max(1);
        let mut means = Vec::new();
        for batch in 0..BATCHES {
            let questions: Vec<_> = (0..of_batch)
                .map(|sample| draw_question(view, batch, sample, seed))
                .collect();
            means.push(mean_throughputs(&self.draw(&questions)?, view.normal));
        }
        Ok(albedo_of(&means))
    }

    fn draw(&self, questions: &[DrawQuestion]) -> Result<Vec<DrawAnswer>, GpuError> {
        match &self.prober {
            Some(prober) => prober.draws(&self.scene(), questions),
            None => Ok(cpu::probe_draw::<f64>(&self.scene(), questions)),
        }
    }

    fn scene(&self) -> ProbeScene<'_> {
        ProbeScene {
            tables: &self.tables,
            materials: &self.materials,
            geometry: None,
        }
    }

    fn view(&self, wo: Vec3<f32>) -> MaterialView {
        let is_below = wo.z < 0.0;
        let normal = vec3(0.0, 0.0, if is_below { -1.0 } else { 1.0 });
        let (sine, cosine) = self.materials[0].rotation_rad.sin_cos();
        MaterialView {
            material: 0,
            is_inside: u32::from(is_below),
            shading: normal,
            tangent: vec3(cosine, sine, 0.0),
            normal,
            wo,
        }
    }
}

fn draw_question(view: MaterialView, batch: u32, sample: u32, seed: u32) -> DrawQuestion {
    let state = random_state(batch, 0, seed, sample, Sequence::Sobol);
    let [a, b] = random_pair(state, 0);
    let [c, facet] = random_pair(state, 1);
    let [d, e] = random_pair(state, 2);
    let [f, _] = random_pair(state, 3);
    DrawQuestion {
        view,
        lobe: [a, b, c],
        facet,
        below: [d, e, f],
    }
}

/// Means of the throughputs that leave on the viewer's side and on the other, each linear RGB.
fn mean_throughputs(drawn: &[DrawAnswer], normal: Vec3<f32>) -> [[f64; 3]; 2] {
    let mut sums = [[0.0; 3]; 2];
    for sample in drawn {
        let side = usize::from(sample.wi.dot(normal) < 0.0);
        for (sum, x) in sums[side].iter_mut().zip(sample.throughput.to_f64()) {
            *sum += x;
        }
    }
    sums.map(|sum| sum.map(|x| x / drawn.len() as f64))
}

/// The mean over batches, with the standard error that their spread gives.
fn albedo_of(means: &[[[f64; 3]; 2]]) -> Albedo {
    let count = means.len() as f64;
    let side = |side: usize| {
        let mut mean = [0.0; 3];
        let mut largest: f64 = 0.0;
        for channel in 0..3 {
            let of_batches = || means.iter().map(|batch| batch[side][channel]);
            mean[channel] = of_batches().sum::<f64>() / count;
            let squares: f64 = of_batches().map(|x| (x - mean[channel]).powi(2)).sum();
            largest = largest.max((squares / (count * (count - 1.0))).sqrt());
        }
        (mean, largest)
    };
    let ((reflected, of_reflected), (transmitted, of_transmitted)) = (side(0), side(1));
    Albedo {
        reflected,
        transmitted,
        standard_errors: [of_reflected, of_transmitted],
    }
}
