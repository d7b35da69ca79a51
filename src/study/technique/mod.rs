//! Ways to render the same scene: a document with some of its settings changed, by name.
//!
//! A technique is written as its settings with commas between them: `strategy=lobe,bounces=4`; `as-is` changes nothing.
//! The name of a group alone, `strategy`, stands for all of its members.

mod exact;

use std::fmt;
use std::str::FromStr;

use serde::{Serialize, Serializer};

use crate::document::effect::{EFFECTS, Effect, EffectSwitches, Switch, without_what_is_off};
use crate::document::{Denoise, Document, RenderSettings, Strategy, ViewSettings};
use crate::job::effect::EffectId;
use crate::job::plan::Plan;
use crate::matching::{lobe_of_material, matched_lobe_and_curve};
use crate::optics::curve::Curve;
use crate::optics::lobe::Lobe;
use crate::optics::random::Sequence;

pub use exact::{with_exact_fresnel, with_schlick};

/// Bounces that are raced against each other.
const BOUNCES: [u32; 6] = [1, 2, 3, 4, 8, 16];
/// Longest path of the most accurate setting.
const BOUNCES_MAX: u32 = 64;
const AS_IS: &str = "as-is";

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Setting {
    /// Another reflecting lobe, its roughness such that the look is nearest.
    Lobe(Lobe),
    /// The geometric lobe with another curve, its roughness such that the look is nearest.
    Curve(Curve),
    /// GGX with or without the light that its facets scatter more than once, the looks of other lobes matched.
    Scattering(bool),
    /// How light is found.
    Strategy(Strategy),
    /// Which random numbers are drawn.
    Sequence(Sequence),
    /// Fresnel's equations, or Schlick's approximation with the same reflection along the normal.
    ExactFresnel(bool),
    Bounces(u32),
    /// Whether samples go where the error is.
    Adaptive(bool),
    /// How the image is denoised.
    Denoise(Denoise),
    /// An effect is removed, or its code runs whether it is needed or not.
    Effect(EffectId, Switch),
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
    members: fn(&Plan) -> Vec<Setting>,
}

impl Group {
    /// Its members, for a scene with this plan.
    pub fn members(&self, plan: &Plan) -> Vec<Technique> {
        (self.members)(plan)
            .into_iter()
            .map(|setting| Technique(vec![setting]))
            .collect()
    }
}

macro_rules! groups {
    ($($name:literal $label:literal $help:literal $members:expr;)*) => {
        pub static GROUPS: &[Group] = &[$(Group { name: $name, label: $label, help: $help, members: $members }),*];
    };
}

groups! {
    "strategy" "Light sampling" "By the lobe, by the light, or by both; all converge to the same image."
        |_| Strategy::ALL.iter().map(|s| Setting::Strategy(*s)).collect();
    "sequence" "Random numbers" "Sobol sequence or uniform random numbers; both converge to the same image."
        |_| Sequence::ALL.iter().map(|s| Setting::Sequence(*s)).collect();
    "adaptive" "Adaptive sampling" "Samples where the error is, or evenly; both converge to the same image."
        |_| [true, false].map(Setting::Adaptive).to_vec();
    "denoise" "Denoising" "Raw, or denoised in each available way; the remaining bias is measured."
        |_| Denoise::ALL.iter().map(|how| Setting::Denoise(*how)).collect();
    "bounces" "Bounces" "Longest path, from 1 to 16 reflections."
        |_| BOUNCES.map(Setting::Bounces).to_vec();
    "fresnel" "Fresnel term" "The exact equations or Schlick's approximation, equal along the normal."
        |_| [true, false].map(Setting::ExactFresnel).to_vec();
    "lobe" "Lobes" "Each reflecting lobe with the roughness at which it looks most like the material's own."
        |_| {
            let lobes = Lobe::ALL.iter().filter(|lobe| lobe.has_roughness());
            lobes.map(|lobe| Setting::Lobe(*lobe)).collect()
        };
    "curve" "Curves" "The geometric lobe's curves, each with the roughness at which it looks most like the material's own."
        |_| Curve::with_formulas().map(Setting::Curve).collect();
    "scattering" "Scattering between facets" "GGX with the light that meets more than one facet, or without, which loses it. Other lobes become GGX first."
        |_| [true, false].map(Setting::Scattering).to_vec();
    "effect" "Effects disabled" "The scene without one of the effects that it calls for."
        |plan| {
            let removable = plan.table().filter(|(effect, decision)| {
                // These are kinds of their own.
                let is_own_kind = matches!(*effect, EffectId::AdaptiveSampling | EffectId::Denoising);
                decision.is_on && !effect.is_needed() && !is_own_kind
            });
            removable
                .map(|(effect, _)| Setting::Effect(effect, Switch::Off))
                .collect()
        };
}

impl Setting {
    fn apply(self, document: &mut Document) {
        match self {
            Setting::Lobe(lobe) => change_lobes(document, lobe, Curve::Smooth),
            Setting::Curve(curve) => change_lobes(document, Lobe::Geometric, curve),
            Setting::Scattering(is_on) => {
                change_lobes(document, Lobe::Ggx, Curve::Smooth);
                document
                    .materials
                    .iter_mut()
                    .for_each(|material| material.multiple_scattering = is_on);
            }
            Setting::Strategy(strategy) => document.render.strategy = strategy,
            Setting::Sequence(sequence) => document.render.sequence = sequence,
            Setting::ExactFresnel(true) => document.materials.iter_mut().for_each(with_exact_fresnel),
            Setting::ExactFresnel(false) => document.materials.iter_mut().for_each(with_schlick),
            Setting::Bounces(bounces) => document.render.bounces = bounces,
            Setting::Adaptive(adaptive) => document.render.adaptive = Some(adaptive),
            Setting::Denoise(how) => document.view.denoise = how,
            Setting::Effect(effect, switch) => document.render.effects.set(effect, switch),
        }
    }

    fn label(self) -> String {
        match self {
            Setting::Lobe(lobe) => lobe.label().to_owned(),
            Setting::Curve(curve) => format!("Curve: {}", curve.label().to_lowercase()),
            Setting::Scattering(true) => "GGX, multiple scattering".to_owned(),
            Setting::Scattering(false) => "GGX, single scattering".to_owned(),
            Setting::Strategy(Strategy::Lobe) => "BSDF sampling only".to_owned(),
            Setting::Strategy(Strategy::Light) => "Light sampling only".to_owned(),
            Setting::Strategy(Strategy::Mis) => "BSDF and light sampling".to_owned(),
            Setting::Sequence(Sequence::Sobol) => "Sobol sequence".to_owned(),
            Setting::Sequence(Sequence::Independent) => "Uniform random numbers".to_owned(),
            Setting::ExactFresnel(true) => "Exact Fresnel".to_owned(),
            Setting::ExactFresnel(false) => "Schlick's Fresnel".to_owned(),
            Setting::Bounces(1) => "1 bounce".to_owned(),
            Setting::Bounces(bounces) => format!("{bounces} bounces"),
            Setting::Adaptive(true) => "Adaptive".to_owned(),
            Setting::Adaptive(false) => "Even".to_owned(),
            Setting::Denoise(how) => format!("Denoising: {}", how.label().to_lowercase()),
            Setting::Effect(effect, switch) => {
                let label = Effect::of(effect).label;
                match switch {
                    Switch::Off => format!("Without: {}", label.to_lowercase()),
                    Switch::On | Switch::Auto => format!("{label}: {}", switch.label()),
                }
            }
        }
    }
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

    pub fn of(setting: Setting) -> Self {
        Self(vec![setting])
    }

    /// The document rendered so.
    pub fn apply(&self, document: &Document) -> Document {
        let mut changed = document.clone();
        for setting in &self.0 {
            setting.apply(&mut changed);
        }
        changed
    }

    /// What it is called.
    pub fn label(&self) -> String {
        if self.0.is_empty() {
            return "Current settings".to_owned();
        }
        let labels: Vec<String> = self.0.iter().map(|setting| setting.label()).collect();
        labels.join(", ")
    }
}

/// The most accurate settings for a scene: exact equations, long paths, every effect that it calls for. The lobes are
/// the document's own: they are what is to be shown.
pub fn most_accurate(document: &Document) -> Document {
    let mut accurate = Technique(vec![Setting::ExactFresnel(true), Setting::Bounces(BOUNCES_MAX)]).apply(document);
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
    /// No group has this name.
    #[error("{0} is no kind of setting; there are {names}", names = group_names())]
    Group(String),
    /// The group has no such member.
    #[error("{group}={value} is no setting; {expected}")]
    Value {
        group: String,
        value: String,
        expected: String,
    },
}

fn group_names() -> String {
    let names: Vec<_> = GROUPS.iter().map(|group| group.name).collect();
    names.join(", ")
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Setting::Lobe(lobe) => write!(f, "lobe={}", lobe.name()),
            Setting::Curve(curve) => write!(f, "curve={}", curve.name()),
            Setting::Scattering(is_on) => write!(f, "scattering={}", if *is_on { "multiple" } else { "single" }),
            Setting::Strategy(strategy) => write!(f, "strategy={}", strategy.name()),
            Setting::Sequence(sequence) => write!(f, "sequence={}", sequence.name()),
            Setting::ExactFresnel(is_exact) => write!(f, "fresnel={}", if *is_exact { "exact" } else { "schlick" }),
            Setting::Bounces(bounces) => write!(f, "bounces={bounces}"),
            Setting::Adaptive(is_on) => write!(f, "adaptive={}", if *is_on { "on" } else { "off" }),
            Setting::Denoise(how) => write!(f, "denoise={}", how.name()),
            Setting::Effect(effect, switch) => write!(f, "effect={}{effect}", sign(*switch)),
        }
    }
}

fn sign(switch: Switch) -> &'static str {
    match switch {
        Switch::Off => "-",
        Switch::On => "+",
        Switch::Auto => "",
    }
}

impl FromStr for Setting {
    type Err = TechniqueError;

    fn from_str(text: &str) -> Result<Self, TechniqueError> {
        let (group, value) = text.split_once('=').unwrap_or((text, ""));
        let wrong = |expected: String| TechniqueError::Value {
            group: group.to_owned(),
            value: value.to_owned(),
            expected: format!("give {expected}"),
        };
        macro_rules! entry {
            ($registry:ident) => {{
                let all = $registry::ALL;
                let names = || {
                    all.iter()
                        .map(|entry| entry.name())
                        .collect::<Vec<_>>()
                        .join(", ")
                };
                let found = all.iter().copied().find(|entry| entry.name() == value);
                found.ok_or_else(|| wrong(names()))
            }};
        }
        match group {
            "lobe" => entry!(Lobe).map(Setting::Lobe),
            "curve" => match entry!(Curve)? {
                curve if curve.has_table() => {
                    Err(wrong("a curve with a name: a drawn one has no points here".to_owned()))
                }
                curve => Ok(Setting::Curve(curve)),
            },
            "scattering" => match value {
                "multiple" => Ok(Setting::Scattering(true)),
                "single" => Ok(Setting::Scattering(false)),
                _ => Err(wrong("multiple or single".to_owned())),
            },
            "strategy" => entry!(Strategy).map(Setting::Strategy),
            "sequence" => entry!(Sequence).map(Setting::Sequence),
            "fresnel" => match value {
                "exact" => Ok(Setting::ExactFresnel(true)),
                "schlick" => Ok(Setting::ExactFresnel(false)),
                _ => Err(wrong("exact or schlick".to_owned())),
            },
            "bounces" => match value.parse() {
                Ok(bounces @ 1..=BOUNCES_MAX) => Ok(Setting::Bounces(bounces)),
                _ => Err(wrong(format!("a number from 1 to {BOUNCES_MAX}"))),
            },
            "adaptive" => match value {
                "on" => Ok(Setting::Adaptive(true)),
                "off" => Ok(Setting::Adaptive(false)),
                _ => Err(wrong("on or off".to_owned())),
            },
            "denoise" => entry!(Denoise).map(Setting::Denoise),
            "effect" => effect(value).ok_or_else(|| wrong(effects_expected())),
            _ => Err(TechniqueError::Group(group.to_owned())),
        }
    }
}

fn effect(text: &str) -> Option<Setting> {
    let switch = match text.chars().next()? {
        '-' => Switch::Off,
        '+' => Switch::On,
        _ => return None,
    };
    let effect = text[1..].parse().ok()?;
    Effect::of(effect)
        .can_be(switch)
        .then_some(Setting::Effect(effect, switch))
}

fn effects_expected() -> String {
    let names = |switch: Switch| {
        let possible = EFFECTS.iter().filter(|effect| effect.can_be(switch));
        possible.map(Effect::name).collect::<Vec<_>>().join(", ")
    };
    format!(
        "+NAME of one of {}, or -NAME of one of {}",
        names(Switch::On),
        names(Switch::Off)
    )
}

impl fmt::Display for Technique {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut settings = self.0.iter();
        match settings.next() {
            None => return f.write_str(AS_IS),
            Some(first) => first.fmt(f)?,
        }
        settings.try_for_each(|setting| write!(f, ",{setting}"))
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
    match GROUPS.iter().find(|group| group.name == text) {
        Some(group) => Ok(group.members(plan)),
        None => Ok(vec![text.parse()?]),
    }
}

/// Whether a text is understood, in any scene.
pub fn check_techniques(text: &str) -> Result<(), TechniqueError> {
    techniques(text, &Plan::general()).map(|_| ())
}
