//! The plan: for every effect, whether a scene calls for it, and why. Pipelines are specialised for it
//! (`shaders/scene/plan.wgsl`).

use super::Document;
use super::effect::{Constant, Decision, EFFECTS, Effect, EffectSwitches, Facts, Switch};

/// What is decided about every effect, in the order of [`EFFECTS`].
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Plan {
    decisions: Vec<Decision>,
}

/// What a pipeline is made for: the values of the constants, in the order of [`Plan::constants`]. Plans that differ in
/// their reasons only share it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Specialisation(Vec<u32>);

impl Plan {
    /// What a scene calls for, and what the user switched on besides. What was switched off must be taken out of the
    /// scene before, see [`without_what_is_off`].
    pub fn new(facts: &Facts<'_>) -> Self {
        let switches = facts.document.render.effects;
        let decide = |effect: &Effect| match (switches.get(effect.name), effect.constant) {
            (Switch::Off, _) => Decision::off("switched off by you"),
            (Switch::On, Some(constant)) => Decision::which(constant.general, "switched on by you"),
            _ => (effect.decide)(facts),
        };
        Self {
            decisions: EFFECTS.iter().map(decide).collect(),
        }
    }

    /// The plan that leaves nothing out.
    pub fn general() -> Self {
        let on = |effect: &Effect| Decision::which(effect.constant.map_or(1, |c| c.general), "nothing is left out");
        Self {
            decisions: EFFECTS.iter().map(on).collect(),
        }
    }

    /// The same with another decision about one effect.
    pub fn with(mut self, name: &str, decision: Decision) -> Self {
        if let Some(place) = EFFECTS.iter().position(|effect| effect.name == name) {
            self.decisions[place] = decision;
        }
        self
    }

    /// Every effect with what was decided.
    pub fn table(&self) -> impl Iterator<Item = (&'static Effect, &Decision)> {
        EFFECTS.iter().zip(&self.decisions)
    }

    /// Whether the effect of this name is simulated.
    pub fn has(&self, name: &str) -> bool {
        self.table()
            .any(|(effect, decision)| effect.name == name && decision.is_on)
    }

    /// The names of the effects that are simulated.
    pub fn effects(&self) -> Vec<&'static str> {
        self.table()
            .filter(|(_, decision)| decision.is_on)
            .map(|(effect, _)| effect.name)
            .collect()
    }

    /// How many effects' code is left out of the kernel, or narrowed down to one choice.
    pub fn left_out(&self) -> usize {
        self.switched()
            .filter(|(constant, value)| *value != constant.general)
            .count()
    }

    /// The override constants of the pipeline, by their names in `shaders/scene/plan.wgsl`.
    pub fn constants(&self) -> Vec<(&'static str, f64)> {
        self.switched()
            .map(|(constant, value)| (constant.name, f64::from(value)))
            .collect()
    }

    /// What a pipeline for this plan is made for.
    pub fn specialisation(&self) -> Specialisation {
        Specialisation(self.switched().map(|(_, value)| value).collect())
    }

    fn switched(&self) -> impl Iterator<Item = (Constant, u32)> {
        self.table()
            .filter_map(|(effect, decision)| Some((effect.constant?, decision.value)))
    }
}

/// The document with the effects taken out that the user switched off.
pub fn without_what_is_off(document: &Document) -> Document {
    let switches: EffectSwitches = document.render.effects;
    let mut document = document.clone();
    for effect in EFFECTS {
        if let (Switch::Off, Some(remove)) = (switches.get(effect.name), effect.remove) {
            remove(&mut document);
        }
    }
    document
}
