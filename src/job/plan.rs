//! The plan: for every effect, whether a scene calls for it, and why. Pipelines are specialised for it.

use super::effect::{Constant, Decision, EffectId};

/// The decision about every effect, in the order of [`EffectId::ALL`].
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Plan {
    decisions: Vec<Decision>,
}

/// Specialisation of a pipeline: values of the constants, in the order of [`Plan::constants`]. Plans that differ only in
/// reasons share it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Specialisation(Vec<u32>);

impl Plan {
    /// A plan from a decision per effect.
    pub fn new(decide: impl FnMut(EffectId) -> Decision) -> Self {
        Self {
            decisions: EffectId::ALL.iter().copied().map(decide).collect(),
        }
    }

    /// The plan of the über-shader.
    pub fn general() -> Self {
        Self::new(|effect| Decision::which(effect.constant().map_or(1, |c| c.general), "nothing is left out"))
    }

    /// The plan with another decision about one effect.
    pub fn with(mut self, effect: EffectId, decision: Decision) -> Self {
        self.decisions[effect as usize] = decision;
        self
    }

    /// Every effect with its decision.
    pub fn table(&self) -> impl Iterator<Item = (EffectId, &Decision)> {
        EffectId::ALL.iter().copied().zip(&self.decisions)
    }

    /// Whether an effect is simulated.
    pub fn has(&self, effect: EffectId) -> bool {
        self.decisions[effect as usize].is_on
    }

    /// The names of the effects that are simulated.
    pub fn effects(&self) -> Vec<&'static str> {
        let simulated = self.table().filter(|(_, decision)| decision.is_on);
        simulated.map(|(effect, _)| effect.name()).collect()
    }

    /// Number of effects that are compiled out of the kernel or fixed to one choice.
    pub fn left_out(&self) -> usize {
        self.switched()
            .filter(|(constant, value)| *value != constant.general)
            .count()
    }

    /// The override constants of the pipeline, by their names in WGSL.
    pub fn constants(&self) -> Vec<(&'static str, f64)> {
        self.switched()
            .map(|(constant, value)| (constant.name, f64::from(value)))
            .collect()
    }

    /// Specialisation of a pipeline for this plan.
    pub fn specialisation(&self) -> Specialisation {
        Specialisation(self.switched().map(|(_, value)| value).collect())
    }

    fn switched(&self) -> impl Iterator<Item = (Constant, u32)> {
        self.table()
            .filter_map(|(effect, decision)| Some((effect.constant()?, decision.value)))
    }
}
