//! The effects that the renderer can simulate: what each is, and what decides whether a scene calls for it.
//!
//! To add an effect: its name in [`crate::job::effect`], and a line in the table here. Its code, if it has any, is
//! switched by the constant named there. The plan, the command line, the panel, the documentation and the tests of
//! specialised against general images loop over the table.

mod horizon;
mod table;

use std::borrow::Cow;

use crate::{
    document::{Document, MaterialSettings},
    job::{
        Settings,
        effect::{ANY, Decision, EffectId},
        plan::Plan,
    },
    optics::material::Material,
    scene::{Geometry, environment::Environment, texture::TextureTarget},
};

pub use super::switches::{EffectSwitches, Switch, SwitchError};
pub use table::EFFECTS;

/// What the user reads about an effect, and how a scene calls for it.
pub struct Effect {
    pub id: EffectId,
    /// Name in the panel.
    pub label: &'static str,
    /// What it is, in a sentence.
    pub help: &'static str,
    needs: Needs,
    remove: Remove,
}

/// Whether a scene calls for an effect.
enum Needs {
    /// Where some material does; the text completes "the material …" and "no material …".
    AnyMaterial(fn(&Material<f32>) -> bool, &'static str),
    /// Where this holds; why it is called for, and why not.
    When(fn(&Facts<'_>) -> bool, &'static str, &'static str),
    Scene(fn(&Facts<'_>) -> Decision),
}

/// What takes an effect out of a scene, so that it is no longer called for.
enum Remove {
    /// Nothing could be rendered without it.
    Never,
    /// The switch alone.
    Switched,
    EachMaterial(fn(&mut MaterialSettings)),
    /// Switches off the textures on these targets.
    Textures(&'static [TextureTarget]),
    Document(fn(&mut Document)),
}

impl Effect {
    /// The effect of a name.
    pub fn of(id: EffectId) -> &'static Self {
        &EFFECTS[id as usize]
    }

    /// Name on the command line, in files and reports.
    pub fn name(&self) -> &'static str {
        self.id.name()
    }

    /// Whether a switch makes a difference: what has no code of its own cannot run needlessly, and nothing could be rendered
    /// without some.
    pub fn can_be(&self, switch: Switch) -> bool {
        switch.can_be_set(self.id)
    }
}

/// What a scene calls for, and what the user switched on besides. What was switched off must be removed from the scene
/// before, see [`without_what_is_off`].
pub fn plan(facts: &Facts<'_>) -> Plan {
    let switches = facts.document.render.effects;
    Plan::new(|id| match (switches.get(id), id.constant()) {
        (Switch::Off, _) => Decision::off("switched off by you"),
        (Switch::On, Some(constant)) => Decision::which(constant.general, "switched on by you"),
        _ => match Effect::of(id).needs {
            Needs::AnyMaterial(needs, what) => facts.needed_by(needs, what),
            Needs::When(is_on, why, why_not) => Decision::when(is_on(facts), if is_on(facts) { why } else { why_not }),
            Needs::Scene(decide) => decide(facts),
        },
    })
}

/// The document without the effects that the user switched off.
pub fn without_what_is_off(document: &Document) -> Cow<'_, Document> {
    let switches: EffectSwitches = document.render.effects;
    let mut document = Cow::Borrowed(document);
    for effect in EFFECTS {
        if switches.get(effect.id) != Switch::Off {
            continue;
        }
        match effect.remove {
            Remove::Never | Remove::Switched => {}
            Remove::EachMaterial(change) => document.to_mut().materials.iter_mut().for_each(change),
            Remove::Textures(targets) => {
                for material in &mut document.to_mut().materials {
                    targets.iter().for_each(|target| material.textures[*target] = false);
                }
            }
            Remove::Document(change) => change(document.to_mut()),
        }
    }
    document
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
    /// Geometry that rays hit.
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

    fn is_environment_black(&self) -> bool {
        self.environment.is_black || self.settings.environment_strength == 0.0
    }
}
