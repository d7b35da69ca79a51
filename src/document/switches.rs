//! What the user decides about effects, against the plan.

use std::{collections::BTreeMap, str::FromStr};

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::{job::effect::EffectId, named::named};

named! {
    /// What the user decides about an effect.
    #[derive(Default)]
    Switch {
        #[default]
        Auto, "auto", "auto", "Simulated where the scene calls for it.";
        On, "on", "on", "Its code runs whether it is needed or not: to see what it costs.";
        Off, "off", "off", "Removed from the scene: to see what it does to the image.";
    }
}

impl Switch {
    /// Whether it makes a difference to an effect: what has no code of its own cannot run needlessly, and nothing could be
    /// rendered without some.
    pub fn can_be_set(self, effect: EffectId) -> bool {
        match self {
            Self::Auto => true,
            Self::On => effect.constant().is_some(),
            Self::Off => !effect.is_needed(),
        }
    }
}

/// A switch for each effect. In files an object with the names of those that are not automatic; names that this version
/// does not know are passed over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct EffectSwitches([Switch; EffectId::ALL.len()]);

impl Default for EffectSwitches {
    fn default() -> Self {
        Self([Switch::Auto; EffectId::ALL.len()])
    }
}

impl EffectSwitches {
    /// Everything on that has code of its own: the general pipeline.
    pub fn all_on() -> Self {
        Self::of(|_| Switch::On)
    }

    /// The switch that `choose` gives for each effect.
    pub fn of(choose: impl Fn(EffectId) -> Switch) -> Self {
        let mut switches = Self::default();
        for &effect in EffectId::ALL {
            switches.set(effect, choose(effect));
        }
        switches
    }

    /// The switch of an effect.
    pub fn get(&self, effect: EffectId) -> Switch {
        self.0[effect as usize]
    }

    /// Sets the switch of an effect; to automatic where it can't be set so ([`Switch::can_be_set`]).
    pub fn set(&mut self, effect: EffectId, switch: Switch) {
        let is_possible = switch.can_be_set(effect);
        self.0[effect as usize] = if is_possible { switch } else { Switch::Auto };
    }
}

/// A list that is not understood.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SwitchError {
    /// No effect has this name.
    #[error("no effect is called {0}; there are {names}", names = names(|_| true))]
    Unknown(String),
    /// It is always there.
    #[error("nothing can be rendered without {0}; what can be removed: {names}", names = names(|effect| Switch::Off.can_be_set(effect)))]
    Needed(String),
    /// It is simulated where it is called for, and has no code that could run besides.
    #[error("{0} has no code that could run where it is not called for; what has: {names}", names = names(|effect| Switch::On.can_be_set(effect)))]
    NoCode(String),
    /// Names to keep and changes to what the scene calls for.
    #[error("give either the names of the effects to keep, or changes such as +anisotropy,-ground")]
    Mixed,
}

fn names(chosen: fn(EffectId) -> bool) -> String {
    let chosen = EffectId::ALL.iter().filter(|effect| chosen(**effect));
    crate::named::joined(chosen.map(|effect| effect.name()), ", ")
}

/// `auto`; `all`, needed or not; the names of the effects to keep, with commas between, all others that can be removed
/// being removed; or changes to what the scene calls for, such as `+anisotropy,-ground`.
impl FromStr for EffectSwitches {
    type Err = SwitchError;

    fn from_str(text: &str) -> Result<Self, SwitchError> {
        match text {
            "auto" => return Ok(Self::default()),
            "all" => return Ok(Self::all_on()),
            _ => {}
        }
        let items: Vec<&str> = text.split(',').map(str::trim).collect();
        let is_change = |item: &&str| item.starts_with(['+', '-']);
        let changes = items.iter().filter(|item| is_change(item)).count();
        if changes != 0 && changes != items.len() {
            return Err(SwitchError::Mixed);
        }
        let mut switches = if changes == 0 {
            Self::of(|_| Switch::Off)
        } else {
            Self::default()
        };
        for item in items {
            let name = item.trim_start_matches(['+', '-']);
            let id: EffectId = name.parse().map_err(|_| SwitchError::Unknown(name.to_owned()))?;
            let switch = match item.chars().next() {
                Some('+') => Switch::On,
                Some('-') => Switch::Off,
                _ => Switch::Auto,
            };
            match switch {
                _ if switch.can_be_set(id) => {}
                Switch::On => return Err(SwitchError::NoCode(name.to_owned())),
                _ => return Err(SwitchError::Needed(name.to_owned())),
            }
            switches.set(id, switch);
        }
        Ok(switches)
    }
}

impl Serialize for EffectSwitches {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let switched = EffectId::ALL.iter().map(|effect| (effect.name(), self.get(*effect)));
        let switched = switched.filter(|(_, switch)| *switch != Switch::Auto);
        switched.collect::<BTreeMap<_, _>>().serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for EffectSwitches {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut switches = Self::default();
        for (name, switch) in BTreeMap::<String, Switch>::deserialize(deserializer)? {
            if let Ok(effect) = name.parse() {
                switches.set(effect, switch);
            }
        }
        Ok(switches)
    }
}
