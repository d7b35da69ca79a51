//! The ledger: cost of each active effect and setting in time, noise and image change, on this scene and machine.
//!
//! The document is rendered with and without each, in interleaved trials, with the same random numbers; times are medians
//! over the trials.

use std::time::Duration;

use serde::Serialize;

use super::{MachineInfo, Steps, StudyError, Watch, median, quantile, warmed, without_target};
use crate::{
    analysis::halves::{Distance, Halves},
    analysis::noise::noise,
    document::{
        Document, PixelFilter, Strategy,
        effect::{Effect, Switch},
    },
    job::{effect::EffectId, plan::Plan},
    optics::{fresnel::Fresnel, lobe::Lobe, random::Sequence},
    plot::short,
    render::{EngineChoice, Session, StepDenoiser},
    study::technique::{Technique, converged},
};

/// Minimum samples per pixel of each render by default: two in either half.
const SAMPLES_MIN: f64 = 4.0;
/// Turns are added up to this many times as many until there are as many samples as asked for.
const TURNS_FACTOR: usize = 50;
/// Relative change of noise below which it is not reported in words: the estimate is no more precise.
const NOISE_RESOLVED: f64 = 0.05;
/// Relative change of time below which no number is reported.
const TIME_RESOLVED: f64 = 0.005;

/// Name of the line that holds the scene's kernel against the general one.
const KERNEL: &str = "kernel";

/// Options of a ledger.
#[derive(Clone, Debug, PartialEq)]
pub struct LedgerOptions {
    pub engine: EngineChoice,
    /// Turns of each pair.
    pub turns: usize,
    /// Length of a trial of either side.
    pub slice: Duration,
    /// Minimum samples per pixel of each render; more give more precise noise and image differences.
    pub samples_min: f64,
}

impl LedgerOptions {
    /// Two seconds for each entry.
    pub fn new(engine: EngineChoice) -> Self {
        Self {
            engine,
            turns: 9,
            slice: Duration::from_millis(110),
            samples_min: SAMPLES_MIN,
        }
    }

    /// Time that this many entries take at least, seconds.
    pub fn seconds(&self, entries: usize) -> f64 {
        (2 * entries * self.turns) as f64 * self.slice.as_secs_f64()
    }
}

/// Subject of an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum EntryKind {
    /// An effect, against the scene without it.
    Effect,
    /// A setting, against another value of it.
    Setting,
}

/// A line of the ledger.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LedgerEntry {
    /// Name of the effect or setting.
    pub name: &'static str,
    pub label: String,
    pub instead: String,
    pub kind: EntryKind,
    /// Milliseconds of one sample of every pixel, as it is.
    pub ms_with: f64,
    /// The same with the other.
    pub ms_without: f64,
    /// Time in milliseconds that it adds to one sample of all pixels; negative if it saves time.
    pub ms: f64,
    /// The quartiles of that over the turns.
    pub ms_quartiles: [f64; 2],
    /// Its share of the frame time.
    pub share_of_frame: f64,
    /// Relative change of variance at equal samples; negative if it lowers noise.
    pub noise_share: f64,
    /// Relative change of the image.
    pub picture_change: Distance,
    /// True if it cannot change the image, which then is not measured.
    pub is_picture_kept: bool,
    pub words: String,
}

impl LedgerEntry {
    /// Cost in time, in words.
    pub fn time_words(&self) -> String {
        let share = self.ms / self.ms_without;
        if share.abs() < TIME_RESOLVED || !self.is_time_resolved() {
            return "no measurable cost".to_owned();
        }
        let sign = if share > 0.0 { "+" } else { "−" };
        format!("{sign}{} % time", short(100.0 * share.abs()))
    }

    /// Half of the turns agree on whether it costs or saves time.
    fn is_time_resolved(&self) -> bool {
        let [low, high] = self.ms_quartiles;
        low.signum() == high.signum()
    }
}

/// Cost of all active effects and settings of a document.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ledger {
    /// Machine of the measurement.
    pub machine: MachineInfo,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Milliseconds of one sample of every pixel of the document.
    pub ms_per_sample: f64,
    /// Entries: effects in the order of the plan, then settings.
    pub entries: Vec<LedgerEntry>,
}

impl Ledger {
    /// The line of an effect.
    pub fn effect(&self, name: &str) -> Option<&LedgerEntry> {
        let is_it = |entry: &&LedgerEntry| entry.kind == EntryKind::Effect && entry.name == name;
        self.entries.iter().find(is_it)
    }

    /// Speed of the specialised kernel relative to the über-shader; `None` if not resolved.
    pub fn kernel_gain(&self) -> Option<f64> {
        let kernel = self.entries.iter().find(|entry| entry.name == KERNEL)?;
        kernel.is_time_resolved().then(|| kernel.ms_without / kernel.ms_with)
    }
}

/// Something to be held against the document.
struct Rival {
    name: &'static str,
    label: String,
    instead: String,
    kind: EntryKind,
    document: Document,
}

/// Measures a ledger. `watch` receives the progress and may stop it.
pub fn ledger(document: &Document, options: &LedgerOptions, watch: &mut Watch<'_>) -> Result<Ledger, StudyError> {
    let mut with = Session::open(options.engine)?;
    let mut without = Session::open_with(with.engine().kind.into(), with.assets().clone())?;
    let document = without_target(document);
    warmed(&mut with, &document)?;
    let plan = with.job().map_or_else(Plan::general, |job| job.plan.clone());
    let rivals = rivals(&document, &plan);
    let mut steps = Steps::new(watch, rivals.len() as f64);
    let mut entries = Vec::new();
    for rival in rivals {
        steps.report(rival.label.clone(), 0.0)?;
        entries.push(entry(&document, rival, [&mut with, &mut without], options, &mut steps)?);
        steps.finish(1.0);
    }
    let is_of_samples = |entry: &&LedgerEntry| entry.name != EffectId::Denoising.name();
    let times: Vec<f64> = entries
        .iter()
        .filter(is_of_samples)
        .map(|entry| entry.ms_with)
        .collect();
    Ok(Ledger {
        machine: MachineInfo::of(with.engine()),
        width: document.render.width,
        height: document.render.height,
        ms_per_sample: median(&times),
        entries,
    })
}

fn rivals(document: &Document, plan: &Plan) -> Vec<Rival> {
    let mut rivals = Vec::new();
    for (effect, decision) in plan.table() {
        if !decision.is_on || effect.is_needed() {
            continue;
        }
        let mut changed = document.clone();
        changed.render.effects.set(effect, Switch::Off);
        rivals.push(Rival {
            name: effect.name(),
            label: Effect::of(effect).label.to_owned(),
            instead: "without".to_owned(),
            kind: EntryKind::Effect,
            document: changed,
        });
    }
    rivals.extend(setting_rivals(document));
    rivals
}

/// What each setting in force is measured against.
fn setting_rivals(document: &Document) -> Vec<Rival> {
    let render = &document.render;
    let is_exact = |fresnel| matches!(fresnel, Fresnel::Dielectric | Fresnel::Conductor);
    let has_exact = document.materials.iter().any(|material| is_exact(material.fresnel));
    let [fresnel, rough_fresnel, approximation] = match has_exact {
        true => ["Exact Fresnel", "Schlick's", "schlick"],
        false => ["Schlick's Fresnel", "exact", "exact"],
    };
    let lobe = document
        .materials
        .first()
        .map_or(Lobe::Geometric, |material| material.lobe);
    let other_lobe = if lobe == Lobe::Ggx { Lobe::Geometric } else { Lobe::Ggx };
    let strategy = if render.strategy == Strategy::Lobe {
        Strategy::Mis
    } else {
        Strategy::Lobe
    };
    let (sequence, other_sequence) = match render.sequence {
        Sequence::Sobol => ("Sobol sequence", Sequence::Independent),
        Sequence::Independent => ("Uniform random numbers", Sequence::Sobol),
    };
    let fewer = if render.bounces > 4 { "4" } else { "1" };
    let rows = [
        ("fresnel", fresnel.to_owned(), rough_fresnel.to_owned(), approximation),
        (
            "lobe",
            format!("{} lobe", lobe.label()),
            format!("{} of the same look", other_lobe.label()),
            other_lobe.name(),
        ),
        (
            "strategy",
            format!("Light by {}", render.strategy.label().to_lowercase()),
            strategy.label().to_lowercase(),
            strategy.name(),
        ),
        (
            "sequence",
            sequence.to_owned(),
            other_sequence.name().to_owned(),
            other_sequence.name(),
        ),
        (
            "bounces",
            format!("{} bounces", render.bounces),
            fewer.to_owned(),
            fewer,
        ),
    ];
    let kind = EntryKind::Setting;
    let rival = |(name, label, instead, value): (&'static str, String, String, &str)| {
        let document = Technique::of(name, value).apply(document);
        Rival {
            name,
            label,
            instead,
            kind,
            document,
        }
    };
    let mut rivals: Vec<Rival> = rows.into_iter().map(rival).collect();
    let changed = |name, label: &str, instead: &str, change: fn(&mut Document)| {
        let mut document = document.clone();
        change(&mut document);
        Rival {
            name,
            label: label.to_owned(),
            instead: instead.to_owned(),
            kind,
            document,
        }
    };
    if render.filter == PixelFilter::Gaussian {
        let boxed = |document: &mut Document| document.render.filter = PixelFilter::Box;
        rivals.push(changed("filter", "Gaussian pixel filter", "box", boxed));
    }
    rivals.push(changed(KERNEL, "Specialised kernel", "the general one", |document| {
        let switches = &mut document.render.effects;
        for &effect in EffectId::ALL {
            if switches.get(effect) == Switch::Auto {
                switches.set(effect, Switch::On);
            }
        }
    }));
    rivals.retain(|rival| rival.document != *document);
    rivals
}

impl Rival {
    /// Its line; with no words yet.
    fn entry(self, [ms_with, ms_without]: [f64; 2], differences: &[f64], noise_share: f64) -> LedgerEntry {
        let ms = median(differences);
        LedgerEntry {
            name: self.name,
            label: self.label,
            instead: self.instead,
            kind: self.kind,
            ms_with,
            ms_without,
            ms,
            ms_quartiles: [quantile(differences, 0.25), quantile(differences, 0.75)],
            share_of_frame: ms / ms_with,
            noise_share,
            picture_change: Distance::default(),
            is_picture_kept: false,
            words: String::new(),
        }
    }
}

fn entry(
    document: &Document,
    rival: Rival,
    [with, without]: [&mut Session; 2],
    options: &LedgerOptions,
    steps: &mut Steps<'_, '_>,
) -> Result<LedgerEntry, StudyError> {
    if rival.name == EffectId::Denoising.name() {
        return denoising(document, rival, with, options);
    }
    warmed(with, document)?;
    warmed(without, &rival.document)?;
    let mut times = [const { Vec::new() }; 2];
    for turn in 0..options.turns * TURNS_FACTOR {
        let samples = [&*with, &*without].map(|session| session.progress().mean_samples);
        if turn >= options.turns && samples.iter().all(|samples| *samples >= options.samples_min) {
            break;
        }
        // Each side is first every other time.
        for side in [turn % 2, 1 - turn % 2] {
            let session = if side == 0 { &mut *with } else { &mut *without };
            times[side].push(1e3 * seconds_per_sample(session, options.slice)?);
        }
        steps.report(rival.label.clone(), turn as f64 / options.turns as f64)?;
    }
    let differences: Vec<f64> = std::iter::zip(&times[0], &times[1]).map(|(a, b)| a - b).collect();
    let [noise_with, noise_without] = [variance_of_a_sample(with)?, variance_of_a_sample(without)?];
    let noise_share = if noise_without > 0.0 {
        noise_with / noise_without - 1.0
    } else {
        0.0
    };
    let is_picture_kept = converged(document) == converged(&rival.document);
    let mut entry = rival.entry([median(&times[0]), median(&times[1])], &differences, noise_share);
    entry.is_picture_kept = is_picture_kept;
    if !is_picture_kept {
        entry.picture_change = Halves::of(without.film()?).distance(&Halves::of(with.film()?));
    }
    entry.words = words(&entry);
    Ok(entry)
}

/// The denoiser's entry, per image rather than per sample: time of one image, remaining share of the squared error, and
/// bias.
fn denoising(
    document: &Document,
    rival: Rival,
    session: &mut Session,
    options: &LedgerOptions,
) -> Result<LedgerEntry, StudyError> {
    let mut step_denoiser = StepDenoiser::new(document);
    warmed(session, document)?;
    let mut times = Vec::new();
    let (mut last, mut noise) = (None, 0.0);
    for _ in 0..options.turns {
        while session.progress().mean_samples < options.samples_min {
            session.step(options.slice)?;
        }
        last = step_denoiser.finish(session)?;
        times.extend(last.as_ref().map(|denoised| 1e3 * denoised.seconds));
        noise = crate::analysis::noise::noise(session.film()?).map_or(0.0, |noise| noise.relative);
    }
    let estimate = last.as_ref().and_then(|denoised| denoised.error).unwrap_or_default();
    let share = (estimate.value / noise).powi(2) - 1.0;
    let noise_share = if share.is_finite() { share } else { 0.0 };
    let mut entry = rival.entry([median(&times), 0.0], &times, noise_share);
    entry.picture_change = last.and_then(|denoised| denoised.bias).unwrap_or_default();
    entry.words = format!(
        "{} ms per image; of the squared error of {:.0} spp {} % is left; bias {} %",
        short(entry.ms),
        session.progress().mean_samples,
        short(100.0 * (1.0 + entry.noise_share)),
        short(100.0 * entry.picture_change.value),
    );
    Ok(entry)
}

/// Engine time of one sample of every pixel, over a slice.
fn seconds_per_sample(session: &mut Session, slice: Duration) -> Result<f64, StudyError> {
    let before = session.progress();
    let after = session.step(slice)?;
    let samples = after.mean_samples - before.mean_samples;
    Ok((after.engine_seconds - before.engine_seconds) / samples.max(1e-12))
}

/// Mean over the pixels of the variance of one sample's luminance, as the sequence gains.
fn variance_of_a_sample(session: &mut Session) -> Result<f64, StudyError> {
    let samples = session.progress().mean_samples;
    let found = noise(session.film()?);
    Ok(found.map_or(0.0, |noise| samples * (noise.relative * noise.mean_luminance).powi(2)))
}

/// An entry in words: "Exact Fresnel: +2 % time, changes the image by 0.3 %".
fn words(entry: &LedgerEntry) -> String {
    let mut parts = vec![entry.time_words()];
    if entry.noise_share.abs() >= NOISE_RESOLVED {
        let share = entry.noise_share;
        parts.push(if share > 1.0 {
            format!("{} × the noise", short(share + 1.0))
        } else if share > 0.0 {
            format!("adds {} % to the noise", short(100.0 * share))
        } else {
            format!("removes {} % of the noise", short(-100.0 * share))
        });
    }
    let change = &entry.picture_change;
    parts.push(if entry.is_picture_kept {
        "leaves the image as it is".to_owned()
    } else if change.is_resolved() {
        format!("changes the image by {} %", short(100.0 * change.value))
    } else {
        format!("changes the image by less than {} %", short(100.0 * change.high))
    });
    let against = match entry.kind {
        EntryKind::Effect => String::new(),
        EntryKind::Setting => format!(" (instead of {})", entry.instead),
    };
    format!("{}{against}: {}", entry.label, parts.join(", "))
}
