//! Questions to single functions of an engine.

use bytemuck::Pod;

use super::{EngineChoice, choice::device_for_functions};
use crate::{
    cpu::probe as cpu,
    gpu::{GpuError, probe::Probe},
    job::probe::{
        DrawAnswer, DrawQuestion, FresnelQuestion, LobeAnswer, LobeQuestion, MaterialQuestion, NO_HIT, ProbeScene,
        RandomQuestion, RayAnswer, RayQuestion,
    },
    job::scatter::{ScatterCloud, ScatterRequest},
    optics::vector::Vec3,
    parallel,
};

/// Samples of a cloud that are asked for at a time: some 24 MB of questions.
const SAMPLES: usize = 1 << 18;

/// Answers with the functions that the chosen engine renders with.
pub enum Prober {
    Cpu,
    Gpu(Box<Probe>),
}

impl Prober {
    /// Opens the requested engine; `auto` uses the CPU without a hardware GPU.
    pub fn open(choice: EngineChoice) -> Result<Self, GpuError> {
        Ok(match device_for_functions(choice)? {
            Some(device) => Self::Gpu(Box::new(Probe::new(device)?)),
            None => Self::Cpu,
        })
    }

    /// Hits of rays; triangles are numbered as in the geometry.
    pub fn rays(&self, scene: &ProbeScene<'_>, questions: &[RayQuestion]) -> Result<Vec<RayAnswer>, GpuError> {
        let mut answers = self.hits(scene, questions)?;
        if let (Self::Gpu(_), Some(geometry)) = (self, scene.geometry) {
            for answer in answers.iter_mut().filter(|answer| answer.triangle != NO_HIT) {
                answer.triangle = geometry.triangle_at(answer.triangle);
            }
        }
        Ok(answers)
    }

    /// Draws the samples of a cloud.
    pub fn scatter(&self, request: &ScatterRequest) -> Result<ScatterCloud, GpuError> {
        let scene = ProbeScene {
            tables: &request.model.table,
            ..ProbeScene::default()
        };
        let mut cloud = ScatterCloud::default();
        cloud.samples.reserve_exact(request.count as usize);
        for first in (0..request.count).step_by(SAMPLES) {
            let count = SAMPLES.min((request.count - first) as usize);
            let questions = parallel::map(count, |i| request.question(first + i as u32));
            self.lobes(&scene, &questions)?
                .iter()
                .for_each(|drawn| cloud.add(drawn));
        }
        Ok(cloud)
    }

    /// Answers of the CPU's function, or of a shader's entry point.
    fn answers<Q: Pod, A: Pod>(
        &self,
        scene: &ProbeScene<'_>,
        questions: &[Q],
        of_cpu: impl Fn(&ProbeScene<'_>, &[Q]) -> Vec<A>,
        entry_point: &'static str,
    ) -> Result<Vec<A>, GpuError> {
        match self {
            Self::Cpu => Ok(of_cpu(scene, questions)),
            Self::Gpu(probe) => probe.ask(entry_point, scene, questions),
        }
    }
}

macro_rules! functions {
    ($($visibility:vis $name:ident: $question:ty => $answer:ty = $of_cpu:expr, $entry_point:literal;)*) => {
        impl Prober {
            $($visibility fn $name(
                &self,
                scene: &ProbeScene<'_>,
                questions: &[$question],
            ) -> Result<Vec<$answer>, GpuError> {
                self.answers(scene, questions, $of_cpu, $entry_point)
            })*
        }
    };
}

functions! {
    pub lobes: LobeQuestion => LobeAnswer = cpu::probe_lobe, "probe_lobe";
    pub fresnel: FresnelQuestion => f32 = |_, questions| cpu::probe_fresnel(questions), "probe_fresnel";
    pub random: RandomQuestion => [u32; 2] = |_, questions| cpu::probe_random(questions), "probe_random";
    pub materials: MaterialQuestion => Vec3<f32> = cpu::probe_materials, "probe_material";
    pub densities: MaterialQuestion => f32 = cpu::probe_density, "probe_density";
    pub draws: DrawQuestion => DrawAnswer = cpu::probe_draw::<f32>, "probe_draw";
    hits: RayQuestion => RayAnswer = cpu::probe_ray, "probe_ray";
}
