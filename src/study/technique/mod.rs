//! Ways to render the same scene: a document with some of its settings changed, by name.
//!
//! A technique is written as its settings with commas between them: `strategy=lobe,bounces=4`; `as-is` changes nothing.
//! The name of a group alone, `strategy`, stands for all of its members.

mod exact;

use std::{fmt, str::FromStr};

use serde::{Serialize, Serializer};

use crate::{
    document::{
        Denoise, Document, RenderSettings, Strategy, ViewSettings,
        effect::{EFFECTS, Effect, EffectSwitches, Switch, without_what_is_off},
    },
    job::{effect::EffectId, plan::Plan},
    matching::{lobe_of_material, matched_lobe_and_curve},
    named::{Named, joined},
    optics::{curve::Curve, lobe::Lobe, random::Sequence},
};

pub use exact::{with_exact_fresnel, with_schlick};

/// Longest path of the most accurate setting.
const BOUNCES_MAX: u32 = 64;
const AS_IS: &str = "as-is";

/// A setting of a kind, and its value as it is written.
#[derive(Clone, Debug, PartialEq)]
struct Setting {
    group: &'static str,
    value: String,
}

/// Settings that are tried together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Technique(Vec<Setting>);

/// Techniques of a kind.
pub struct Group {
    /// Name on the command line.
    pub name: &'static str,
    /// Name in the panel.
    pub label: &'static str,
    /// What its members differ in.
    pub help: &'static str,
    members: fn(&Plan) -> Vec<String>,
    /// What a value is called; none where it is no value of this kind.
    label_of: fn(&str) -> Option<String>,
    apply: fn(&mut Document, &str),
}

impl Group {
    /// Its members, for a scene with this plan.
    pub fn members(&self, plan: &Plan) -> Vec<Technique> {
        let values = (self.members)(plan).into_iter();
        values
            .map(|value| {
                Technique(vec![Setting {
                    group: self.name,
                    value,
                }])
            })
            .collect()
    }

    fn by_name(name: &str) -> Option<&'static Self> {
        GROUPS.iter().find(|group| group.name == name)
    }

    /// What can be given for a value.
    fn expected(&self) -> String {
        match self.name {
            "curve" => format!("{}; a drawn curve has no points here", self.names()),
            "bounces" => format!("a number from 1 to {BOUNCES_MAX}"),
            "effect" => {
                let names = |switch: Switch| {
                    let possible = EFFECTS.iter().filter(|effect| effect.can_be(switch));
                    joined(possible.map(Effect::name), ", ")
                };
                format!(
                    "+NAME of one of {}, or -NAME of one of {}",
                    names(Switch::On),
                    names(Switch::Off)
                )
            }
            _ => self.names(),
        }
    }

    fn names(&self) -> String {
        (self.members)(&Plan::general()).join(", ")
    }
}

macro_rules! groups {
    ($($name:literal $label:literal $help:literal $members:expr, $label_of:expr, $apply:expr;)*) => {
        /// Every kind, in the order of the panel.
        pub static GROUPS: &[Group] = &[$(Group {
            name: $name, label: $label, help: $help, members: $members, label_of: $label_of, apply: $apply,
        }),*];
    };
}

groups! {
    "strategy" "Light sampling" "By the lobe, by the light, or by both; all converge to the same image."
        |_| names::<Strategy>(),
        |value| known(value, &[
            ("lobe", "BSDF sampling only"), ("light", "Light sampling only"), ("mis", "BSDF and light sampling"),
        ]),
        |document, value| set(&mut document.render.strategy, value);
    "sequence" "Random numbers" "Sobol sequence or uniform random numbers; both converge to the same image."
        |_| names::<Sequence>(),
        |value| known(value, &[("sobol", "Sobol sequence"), ("independent", "Uniform random numbers")]),
        |document, value| set(&mut document.render.sequence, value);
    "adaptive" "Adaptive sampling" "Samples where the error is, or evenly; both converge to the same image."
        |_| texts(["on", "off"]),
        |value| known(value, &[("on", "Adaptive"), ("off", "Even")]),
        |document, value| document.render.adaptive = Some(value == "on");
    "denoise" "Denoising" "Raw, or denoised in each available way; the remaining bias is measured."
        |_| names::<Denoise>(),
        |value| Some(format!("Denoising: {}", Denoise::by_name(value)?.label().to_lowercase())),
        |document, value| set(&mut document.view.denoise, value);
    "bounces" "Bounces" "Longest path, from 1 to 16 reflections."
        |_| texts(["1", "2", "3", "4", "8", "16"]),
        |value| match value.parse().ok().filter(|bounces| (1..=BOUNCES_MAX).contains(bounces))? {
            1 => Some("1 bounce".to_owned()),
            bounces => Some(format!("{bounces} bounces")),
        },
        |document, value| document.render.bounces = value.parse().unwrap_or(BOUNCES_MAX);
    "fresnel" "Fresnel term" "The exact equations or Schlick's approximation, equal along the normal."
        |_| texts(["exact", "schlick"]),
        |value| known(value, &[("exact", "Exact Fresnel"), ("schlick", "Schlick's Fresnel")]),
        |document, value| {
            let change = if value == "exact" { with_exact_fresnel } else { with_schlick };
            document.materials.iter_mut().for_each(change);
        };
    "lobe" "Lobes" "Each reflecting lobe with the roughness at which it looks most like the material's own."
        |_| Lobe::ALL.iter().filter(|lobe| lobe.has_roughness()).map(|lobe| lobe.name().to_owned()).collect(),
        |value| Some(Lobe::by_name(value)?.label().to_owned()),
        |document, value| change_lobes(document, Lobe::by_name(value).unwrap_or(Lobe::Geometric), Curve::Smooth);
    "curve" "Curves" "The geometric lobe's curves, each with the roughness at which it looks most like the material's own."
        |_| Curve::with_formulas().map(|curve| curve.name().to_owned()).collect(),
        |value| {
            let curve = Curve::by_name(value).filter(|curve| !curve.has_table())?;
            Some(format!("Curve: {}", curve.label().to_lowercase()))
        },
        |document, value| change_lobes(document, Lobe::Geometric, Curve::by_name(value).unwrap_or(Curve::Smooth));
    "scattering" "Scattering between facets" "GGX with the light that meets more than one facet, or without, which loses it. Other lobes become GGX first."
        |_| texts(["multiple", "single"]),
        |value| known(value, &[("multiple", "GGX, multiple scattering"), ("single", "GGX, single scattering")]),
        |document, value| {
            change_lobes(document, Lobe::Ggx, Curve::Smooth);
            document.materials.iter_mut().for_each(|material| material.multiple_scattering = value == "multiple");
        };
    "effect" "Effects disabled" "The scene without one of the effects that it calls for."
        |plan| {
            let removable = plan.table().filter(|(effect, decision)| {
                // These have groups of their own.
                let is_own_kind = matches!(*effect, EffectId::AdaptiveSampling | EffectId::Denoising);
                decision.is_on && !effect.is_needed() && !is_own_kind
            });
            removable.map(|(effect, _)| format!("-{effect}")).collect()
        },
        |value| {
            let (effect, switch) = switched(value)?;
            let Effect { label, .. } = Effect::of(effect);
            Some(match switch {
                Switch::Off => format!("Without: {}", label.to_lowercase()),
                Switch::On | Switch::Auto => format!("{label}: {}", switch.label()),
            })
        },
        |document, value| if let Some((effect, switch)) = switched(value) {
            document.render.effects.set(effect, switch);
        };
}

fn texts<const N: usize>(values: [&str; N]) -> Vec<String> {
    values.map(str::to_owned).to_vec()
}

fn names<T: Named>() -> Vec<String> {
    T::ALL.iter().map(|choice| choice.name().to_owned()).collect()
}

fn known(value: &str, labels: &[(&str, &str)]) -> Option<String> {
    labels
        .iter()
        .find(|(name, _)| *name == value)
        .map(|(_, label)| (*label).to_owned())
}

fn set<T: Named>(field: &mut T, value: &str) {
    *field = T::by_name(value).unwrap_or(*field);
}

/// An effect with `-` or `+` before its name.
fn switched(text: &str) -> Option<(EffectId, Switch)> {
    let switch = match text.chars().next()? {
        '-' => Switch::Off,
        '+' => Switch::On,
        _ => return None,
    };
    let effect = text[1..].parse().ok()?;
    Effect::of(effect).can_be(switch).then_some((effect, switch))
}

/// Gives every material that reflects this lobe, looks matched where they can be: mirrors stay as narrow as they are.
fn change_lobes(document: &mut Document, lobe: Lobe, curve: Curve) {
    let reflecting = document.materials.iter_mut().filter(|m| m.reflects());
    for material in reflecting {
        let is_same_curve = !lobe.has_curves() || material.curve == curve || curve == Curve::Smooth;
        if material.lobe == lobe && is_same_curve {
            continue;
        }
        // The stretch is kept, and looks are matched without it.
        let mut model = lobe_of_material(material);
        model.anisotropy = 0.0;
        if let Ok(matched) = matched_lobe_and_curve(&model, lobe, curve) {
            material.roughness = matched.roughness as f32;
        }
        (material.lobe, material.curve) = (lobe, curve);
    }
}

impl Technique {
    pub fn as_is() -> Self {
        Self::default()
    }

    /// One setting of a kind.
    pub(super) fn of(group: &'static str, value: impl Into<String>) -> Self {
        Self(vec![Setting {
            group,
            value: value.into(),
        }])
    }

    /// The document rendered so.
    pub fn apply(&self, document: &Document) -> Document {
        let mut changed = document.clone();
        for Setting { group, value } in &self.0 {
            if let Some(group) = Group::by_name(group) {
                (group.apply)(&mut changed, value);
            }
        }
        changed
    }

    /// What it is called.
    pub fn label(&self) -> String {
        if self.0.is_empty() {
            return "Current settings".to_owned();
        }
        let label = |setting: &Setting| (Group::by_name(setting.group)?.label_of)(&setting.value);
        joined(self.0.iter().filter_map(label), ", ")
    }
}

/// The most accurate settings for a scene: exact equations, long paths, every effect that it calls for. The lobes are
/// the document's own: they are what is to be shown.
pub fn most_accurate(document: &Document) -> Document {
    let mut accurate = Technique::of("fresnel", "exact").apply(document);
    accurate.render.bounces = BOUNCES_MAX;
    accurate.render.effects = EffectSwitches::default();
    accurate
}

/// The same for all documents that converge to the same image: how it is reached and shown is left out.
pub fn converged(document: &Document) -> Document {
    let mut document = without_what_is_off(document).into_owned();
    let default = RenderSettings::default();
    document.render = RenderSettings {
        width: document.render.width,
        height: document.render.height,
        bounces: document.render.bounces,
        filter: document.render.filter,
        ..default
    };
    document.view = ViewSettings::default();
    document.bookmarks.clear();
    document.materials.iter_mut().for_each(|material| material.name.clear());
    document
}

/// A technique that is not understood.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TechniqueError {
    #[error("{0} is no kind of setting; there are {names}", names = joined(GROUPS.iter().map(|group| group.name), ", "))]
    Group(String),
    #[error("{group}={value} is no setting; give {expected}")]
    Value {
        group: &'static str,
        value: String,
        expected: String,
    },
}

impl FromStr for Setting {
    type Err = TechniqueError;

    fn from_str(text: &str) -> Result<Self, TechniqueError> {
        let (name, value) = text.split_once('=').unwrap_or((text, ""));
        let group = Group::by_name(name).ok_or_else(|| TechniqueError::Group(name.to_owned()))?;
        let (name, value) = (group.name, value.to_owned());
        match (group.label_of)(&value) {
            Some(_) => Ok(Self { group: name, value }),
            None => Err(TechniqueError::Value {
                group: name,
                value,
                expected: group.expected(),
            }),
        }
    }
}

impl fmt::Display for Technique {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return f.write_str(AS_IS);
        }
        let settings = self.0.iter().map(|Setting { group, value }| format!("{group}={value}"));
        f.write_str(&joined(settings, ","))
    }
}

impl FromStr for Technique {
    type Err = TechniqueError;

    fn from_str(text: &str) -> Result<Self, TechniqueError> {
        if text == AS_IS {
            return Ok(Self::as_is());
        }
        text.split(',')
            .map(|setting| setting.trim().parse())
            .collect::<Result<_, _>>()
            .map(Self)
    }
}

impl Serialize for Technique {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// The techniques that a text stands for: those of a group by its name, or the one that it describes.
pub fn techniques(text: &str, plan: &Plan) -> Result<Vec<Technique>, TechniqueError> {
    match Group::by_name(text) {
        Some(group) => Ok(group.members(plan)),
        None => Ok(vec![text.parse()?]),
    }
}
