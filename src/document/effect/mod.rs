//! The effects that the renderer can simulate, one file each, and what decides whether a scene calls for one.
//!
//! To add an effect: one file with an `EFFECT`, and one line in the registry below. If it has code of its own, an
//! override constant in `shaders/scene/plan.wgsl` switches it. The plan, the command line, the panel, the documentation
//! and the tests of specialised against general pictures loop over the registry.

mod switches;

use crate::document::{Document, MaterialSettings};
use crate::optics::material::Material;
use crate::scene::Geometry;
use crate::scene::environment::Environment;

use super::job::Settings;

pub use switches::{EffectSwitches, Switch, SwitchError};

/// The value of a constant that leaves a choice to each material.
pub const ANY: u32 = u32::MAX;

macro_rules! effects {
    ($($module:ident)*) => {
        $(mod $module;)*

        /// Every effect, in the order of the table.
        pub static EFFECTS: &[Effect] = &[$($module::EFFECT),*];
    };
}

effects! {
    environment
    light_sampling
    area_lights
    emission
    emitter_sampling
    background
    ground
    interreflection
    base
    specular
    lobe
    curve
    anisotropy
    horizon
    fresnel
    edge_tint
    coat
    transmission
    absorption
    color_texture
    roughness_texture
    rough_tables
    normal_map
    emission_texture
    alpha
    depth_of_field
    firefly_clamp
    adaptive_sampling
    variance
    picture_layers
}

/// Something that costs time and that not every scene needs.
pub struct Effect {
    /// Name on the command line, in files and reports.
    pub name: &'static str,
    /// Name in the panel.
    pub label: &'static str,
    /// What it is, in a sentence.
    pub help: &'static str,
    /// What switches its code in `shaders/scene/plan.wgsl`; `None` where it has none that could be left out.
    pub constant: Option<Constant>,
    /// Whether a scene calls for it.
    pub decide: fn(&Facts<'_>) -> Decision,
    /// Takes it out of the scene, so that it is no longer called for; `None` where nothing could be rendered without.
    pub remove: Option<fn(&mut Document)>,
}

impl Effect {
    /// Whether a switch makes a difference: what has no code of its own cannot run needlessly, and nothing could be rendered
    /// without some.
    pub fn can_be(&self, switch: Switch) -> bool {
        match switch {
            Switch::Auto => true,
            Switch::On => self.constant.is_some(),
            Switch::Off => self.remove.is_some(),
        }
    }
}

/// An override constant of the pipelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Constant {
    /// Its name in WGSL.
    pub name: &'static str,
    /// Its value where nothing is left out.
    pub general: u32,
}

impl Constant {
    /// 1 where the effect is simulated.
    const fn flag(name: &'static str) -> Option<Self> {
        Some(Self { name, general: 1 })
    }

    /// Which of several, or [`ANY`].
    const fn choice(name: &'static str) -> Option<Self> {
        Some(Self { name, general: ANY })
    }
}

/// What is decided about an effect, and why.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Decision {
    /// It is simulated.
    pub is_on: bool,
    /// The value of its constant.
    pub value: u32,
    /// In words.
    pub reason: String,
}

impl Decision {
    /// Simulated.
    pub fn on(reason: impl Into<String>) -> Self {
        Self::which(1, reason)
    }

    /// Left out.
    pub fn off(reason: impl Into<String>) -> Self {
        Self {
            is_on: false,
            ..Self::which(0, reason)
        }
    }

    /// Simulated, with a constant of this value.
    pub fn which(value: u32, reason: impl Into<String>) -> Self {
        Self {
            is_on: true,
            value,
            reason: reason.into(),
        }
    }
}

/// What decisions rest on: the scene as compiled.
#[derive(Clone, Copy)]
pub struct Facts<'a> {
    /// What was compiled, without what the user switched off.
    pub document: &'a Document,
    /// The materials of all slots as edited: the model's, the ground's, the area lights'.
    pub slots: &'a [MaterialSettings],
    /// The same as the integrators read them.
    pub materials: &'a [Material<f32>],
    /// What rays meet.
    pub geometry: &'a Geometry,
    /// What they see far away.
    pub environment: &'a Environment,
    /// Camera, light and sampling.
    pub settings: &'a Settings,
}

impl Facts<'_> {
    /// On where some material `needs` it; `what` completes "the material …" and "no material …".
    fn needed_by(&self, needs: fn(&Material<f32>) -> bool, what: &str) -> Decision {
        let mut names: Vec<&str> = std::iter::zip(self.slots, self.materials)
            .filter(|(_, material)| needs(&material.least_metallic()))
            .map(|(slot, _)| slot.name.as_str())
            .collect();
        names.dedup();
        match names.as_slice() {
            [] => Decision::off(format!("no material {what}")),
            [one] => Decision::on(format!("the material {one} {what}")),
            [first, rest @ ..] => Decision::on(format!("the material {first} and {} more {what}", rest.len())),
        }
    }

    /// The materials with a reflecting lobe.
    fn reflecting(&self) -> impl Iterator<Item = Material<f32>> {
        self.materials
            .iter()
            .map(Material::least_metallic)
            .filter(Material::has_specular)
    }

    /// The choice that all materials with a reflecting lobe share; `name` gives a choice's name.
    fn shared(&self, number: fn(&Material<f32>) -> u32, name: fn(u32) -> &'static str) -> Decision {
        let mut numbers = self.reflecting().map(|material| number(&material));
        let Some(first) = numbers.next() else {
            return Decision {
                value: ANY,
                ..Decision::off("nothing reflects but the base")
            };
        };
        match numbers.find(|&number| number != first) {
            None => Decision::which(first, format!("{} in every material that reflects", name(first))),
            Some(other) => Decision::which(ANY, format!("{} and {} are mixed", name(first), name(other))),
        }
    }
}

/// The effect of a name.
pub fn named(name: &str) -> Option<&'static Effect> {
    EFFECTS.iter().find(|effect| effect.name == name)
}
