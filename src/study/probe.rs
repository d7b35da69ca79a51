//! Questions to single functions of an engine.

use bytemuck::Pod;

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
        self.answers(scene, questions, cpu::probe_lobe, "probe_lobe")
    }

    /// The shares that boundaries reflect.
    pub fn fresnel(&self, questions: &[FresnelQuestion]) -> Result<Vec<f32>, GpuError> {
        self.answers(
            &ProbeScene::default(),
            questions,
            |_, questions| cpu::probe_fresnel(questions),
            "probe_fresnel",
        )
    }

    /// The bits of pairs of random numbers.
    pub fn random(&self, questions: &[RandomQuestion]) -> Result<Vec<[u32; 2]>, GpuError> {
        self.answers(
            &ProbeScene::default(),
            questions,
            |_, questions| cpu::probe_random(questions),
            "probe_random",
        )
    }

    /// Materials' values, linear RGB.
    pub fn materials(
        &self,
        scene: &ProbeScene<'_>,
        questions: &[MaterialQuestion],
    ) -> Result<Vec<Vec3<f32>>, GpuError> {
        self.answers(scene, questions, cpu::probe_materials, "probe_material")
    }

    /// Densities with which materials draw directions, per steradian.
    pub fn densities(&self, scene: &ProbeScene<'_>, questions: &[MaterialQuestion]) -> Result<Vec<f32>, GpuError> {
        self.answers(scene, questions, cpu::probe_density, "probe_density")
    }

    /// Directions drawn from materials.
    pub fn draws(&self, scene: &ProbeScene<'_>, questions: &[DrawQuestion]) -> Result<Vec<DrawAnswer>, GpuError> {
        self.answers(scene, questions, cpu::probe_draw::<f32>, "probe_draw")
    }

    /// Hits of rays.
    pub fn rays(&self, scene: &ProbeScene<'_>, questions: &[RayQuestion]) -> Result<Vec<RayAnswer>, GpuError> {
        let mut answers = self.answers(scene, questions, cpu::probe_ray, "probe_ray")?;
        if let (Self::Gpu(_), Some(geometry)) = (self, scene.geometry) {
            for answer in answers.iter_mut().filter(|answer| answer.triangle != NO_HIT) {
                answer.triangle = geometry.triangle_at(answer.triangle);
            }
        }
        Ok(answers)
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
