//! The plan: which effects a scene with these materials calls for. Pipelines are specialised for it
//! (`shaders/scene/plan.wgsl`).

use crate::optics::lobe::Lobe;
use crate::optics::material::Material;
use crate::scene::light::LightChoice;

/// What every material of the scene has in common, and what can be left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Plan {
    /// The lobe, curve, horizon policy and Fresnel model as numbers, where all specular materials share them.
    pub lobe: Option<u32>,
    /// See `lobe`.
    pub curve: Option<u32>,
    /// See `lobe`.
    pub horizon: Option<u32>,
    /// See `lobe`.
    pub fresnel: Option<u32>,
    /// Some lobe is stretched.
    pub anisotropy: bool,
    /// Some material has a Lambertian base.
    pub base: bool,
    /// Some material has a specular lobe.
    pub specular: bool,
    /// Some material emits.
    pub emission: bool,
    /// Some material transmits light.
    pub transmission: bool,
    /// Some material that transmits light absorbs it inside.
    pub absorption: bool,
    /// The environment is sampled: not where it is equally bright everywhere or black.
    pub light_sampling: bool,
    /// Emitting triangles are sampled.
    pub emitter_sampling: bool,
    /// The lens is open.
    pub lens: bool,
    /// Indirect contributions are limited.
    pub firefly_clamp: bool,
}

impl Plan {
    /// The plan that leaves nothing out.
    pub const GENERAL: Plan = Plan {
        lobe: None,
        curve: None,
        horizon: None,
        fresnel: None,
        anisotropy: true,
        base: true,
        specular: true,
        emission: true,
        transmission: true,
        absorption: true,
        light_sampling: true,
        emitter_sampling: true,
        lens: true,
        firefly_clamp: true,
    };

    /// What these materials call for under light that is shared out like this.
    pub fn new(materials: &[Material<f32>], light: &LightChoice, lens_radius: f64) -> Self {
        let specular: Vec<_> = materials.iter().filter(|m| m.has_specular()).collect();
        let shared = |number: fn(&Material<f32>) -> u32| {
            let first = specular.first().map(|m| number(m))?;
            specular.iter().all(|m| number(m) == first).then_some(first)
        };
        Plan {
            lobe: shared(|m| m.lobe),
            curve: shared(|m| if m.lobe == Lobe::Geometric as u32 { m.curve } else { 0 }),
            horizon: shared(|m| m.horizon),
            fresnel: shared(|m| m.fresnel),
            anisotropy: specular.iter().any(|m| m.anisotropy != 0.0),
            base: materials.iter().any(Material::has_base),
            specular: !specular.is_empty(),
            emission: materials.iter().any(|m| m.emission.max_component() > 0.0),
            transmission: materials.iter().any(Material::transmits),
            absorption: materials
                .iter()
                .any(|m| m.transmits() && m.absorption.max_component() > 0.0),
            light_sampling: light.environment_probability > 0.0,
            emitter_sampling: light.density_per_luminance > 0.0,
            lens: lens_radius > 0.0,
            firefly_clamp: false,
        }
    }

    /// The names of the effects that are simulated.
    pub fn effects(&self) -> Vec<&'static str> {
        let effects = [
            ("environment", true),
            ("light-sampling", self.light_sampling),
            ("emitter-sampling", self.emitter_sampling),
            ("specular", self.specular),
            ("base", self.base),
            ("anisotropy", self.anisotropy),
            ("emission", self.emission),
            ("transmission", self.transmission),
            ("absorption", self.absorption),
            ("depth-of-field", self.lens),
            ("firefly-clamp", self.firefly_clamp),
        ];
        effects
            .into_iter()
            .filter(|(_, is_on)| *is_on)
            .map(|(name, _)| name)
            .collect()
    }

    /// The override constants of the pipeline, by their names in `shaders/scene/plan.wgsl`.
    pub fn constants(&self) -> [(&'static str, f64); 14] {
        let number = |value: Option<u32>| f64::from(value.unwrap_or(u32::MAX));
        let flag = |value: bool| f64::from(u8::from(value));
        [
            ("PLAN_LOBE", number(self.lobe)),
            ("PLAN_CURVE", number(self.curve)),
            ("PLAN_HORIZON", number(self.horizon)),
            ("PLAN_FRESNEL", number(self.fresnel)),
            ("PLAN_ANISOTROPY", flag(self.anisotropy)),
            ("PLAN_BASE", flag(self.base)),
            ("PLAN_SPECULAR", flag(self.specular)),
            ("PLAN_EMISSION", flag(self.emission)),
            ("PLAN_TRANSMISSION", flag(self.transmission)),
            ("PLAN_ABSORPTION", flag(self.absorption)),
            ("PLAN_LIGHT_SAMPLING", flag(self.light_sampling)),
            ("PLAN_EMITTER_SAMPLING", flag(self.emitter_sampling)),
            ("PLAN_LENS", flag(self.lens)),
            ("PLAN_FIREFLY_CLAMP", flag(self.firefly_clamp)),
        ]
    }
}
