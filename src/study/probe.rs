//! Questions to single functions of an engine.

use crate::cpu::probe as cpu;
use crate::gpu::GpuError;
use crate::gpu::probe::Probe;
use crate::job::probe::{
    DrawAnswer, DrawQuestion, FresnelQuestion, LobeAnswer, LobeQuestion, MaterialQuestion, NO_HIT, ProbeScene,
    RandomQuestion, RayAnswer, RayQuestion,
};
use crate::optics::vector::Vec3;
use crate::render::{EngineChoice, device_for_functions};

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

    /// Samples, values and densities of lobes.
    ///
    /// # Errors
    ///
    /// If the GPU fails; so do all later calls.
    pub fn lobes(&self, scene: &ProbeScene<'_>, questions: &[LobeQuestion]) -> Result<Vec<LobeAnswer>, GpuError> {
        match self {
            Self::Cpu => Ok(cpu::probe_lobe(scene, questions)),
            Self::Gpu(probe) => probe.ask("probe_lobe", scene, questions),
        }
    }

    /// The shares that boundaries reflect.
    pub fn fresnel(&self, questions: &[FresnelQuestion]) -> Result<Vec<f32>, GpuError> {
        match self {
            Self::Cpu => Ok(cpu::probe_fresnel(questions)),
            Self::Gpu(probe) => probe.ask("probe_fresnel", &ProbeScene::default(), questions),
        }
    }

    /// The bits of pairs of random numbers.
    pub fn random(&self, questions: &[RandomQuestion]) -> Result<Vec<[u32; 2]>, GpuError> {
        match self {
            Self::Cpu => Ok(cpu::probe_random(questions)),
            Self::Gpu(probe) => probe.ask("probe_random", &ProbeScene::default(), questions),
        }
    }

    /// Materials' values, linear RGB.
    pub fn materials(
        &self,
        scene: &ProbeScene<'_>,
        questions: &[MaterialQuestion],
    ) -> Result<Vec<Vec3<f32>>, GpuError> {
        match self {
            Self::Cpu => Ok(cpu::probe_materials(scene, questions)),
            Self::Gpu(probe) => probe.ask("probe_material", scene, questions),
        }
    }

    /// Densities with which materials draw directions, per steradian.
    pub fn densities(&self, scene: &ProbeScene<'_>, questions: &[MaterialQuestion]) -> Result<Vec<f32>, GpuError> {
        match self {
            Self::Cpu => Ok(cpu::probe_density(scene, questions)),
            Self::Gpu(probe) => probe.ask("probe_density", scene, questions),
        }
    }

    /// Directions drawn from materials.
    pub fn draws(&self, scene: &ProbeScene<'_>, questions: &[DrawQuestion]) -> Result<Vec<DrawAnswer>, GpuError> {
        match self {
            Self::Cpu => Ok(cpu::probe_draw::<f32>(scene, questions)),
            Self::Gpu(probe) => probe.ask("probe_draw", scene, questions),
        }
    }

    /// Hits of rays.
    pub fn rays(&self, scene: &ProbeScene<'_>, questions: &[RayQuestion]) -> Result<Vec<RayAnswer>, GpuError> {
        match self {
            Self::Cpu => Ok(cpu::probe_ray(scene, questions)),
            Self::Gpu(probe) => {
                let mut answers: Vec<RayAnswer> = probe.ask("probe_ray", scene, questions)?;
                let is_hit = |answer: &&mut RayAnswer| answer.triangle != NO_HIT;
                if let Some(geometry) = scene.geometry {
                    for answer in answers.iter_mut().filter(is_hit) {
                        answer.triangle = geometry.triangle_at(answer.triangle);
                    }
                }
                Ok(answers)
            }
        }
    }
}
