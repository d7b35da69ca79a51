//! The race: techniques on the same view, interleaved in time.
//!
//! Each has its own session of the same engine and renders in time slices by turns, so that disturbances affect all; the
//! engine's own clock counts. Two errors are distinguished. *Noise* is the distance of an image from the technique's own
//! limit; it falls with time. *Bias* is the distance of that limit from the most accurate setting's; it stays.

use std::{sync::Arc, time::Duration};

use serde::Serialize;

use super::{
    MachineInfo, Steps, StudyError, Watch,
    references::{Effort, Reference, reference},
    warmed, without_target,
};
use crate::{
    analysis::halves::Distance,
    document::Document,
    job::film::Image,
    render::{Assets, EngineChoice, Session, StepDenoiser, denoise::Denoised},
    study::technique::{Technique, converged, most_accurate},
};

/// Precision of references relative to the target noise, if time permits.
const REFERENCE_GAIN: f64 = 8.0;
/// Minimum samples of the render of equal error: one in either half.
const SAMPLES_MIN: f64 = 2.0;

/// Options of a race.
#[derive(Clone, Debug, PartialEq)]
pub struct RaceOptions {
    /// The engine, the same for all.
    pub engine: EngineChoice,
    /// Techniques that take part; the current document always does.
    pub techniques: Vec<Technique>,
    /// Engine time that each has, seconds.
    pub seconds: f64,
    /// The noise at which times are compared: 0.02 is 2 %.
    pub noise: f64,
    /// Length of a time slice.
    pub slice: Duration,
    /// Longest time for one reference, seconds.
    pub reference_seconds: f64,
}

impl RaceOptions {
    /// Ten seconds for each, to 2 %.
    pub fn new(engine: EngineChoice, techniques: Vec<Technique>) -> Self {
        Self {
            engine,
            techniques,
            seconds: 10.0,
            noise: 0.02,
            slice: Duration::from_millis(250),
            reference_seconds: 60.0,
        }
    }
}

/// Result of a race.
#[derive(Clone, Debug, Serialize)]
pub struct Race {
    /// Machine of the race.
    pub machine: MachineInfo,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Engine time that each had, seconds.
    pub seconds: f64,
    /// The noise at which times are compared.
    pub noise: f64,
    /// Noise of the renders of equal error: the largest after equal time.
    pub equal_error: f64,
    /// Techniques in the given order, the current document first.
    pub runners: Vec<Runner>,
}

/// A technique in a race.
#[derive(Clone, Debug, Serialize)]
pub struct Runner {
    /// The technique, as it is written.
    pub technique: Technique,
    /// Label in tables and charts.
    pub label: String,
    /// Engine time that it had in fact, seconds.
    pub seconds: f64,
    /// Samples per pixel after it, in the mean.
    pub samples_per_pixel: f64,
    /// Estimated relative error, without a reference.
    #[serde(rename = "told_noise")]
    pub estimated_noise: f64,
    /// Relative error against its own reference.
    pub error: Distance,
    /// Engine time in seconds to the race's noise: the error falls with the root of time. (A denoised image's error falls
    /// more slowly: its time is overestimated if the noise was reached in the race, else underestimated.)
    pub time_to_noise: f64,
    /// The noise was not reached in the race: the time is extrapolated.
    pub is_extrapolated: bool,
    /// Relative distance of its limit from the most accurate setting's; for a denoised render, the denoiser's bias at the
    /// race's end.
    pub bias: Distance,
    /// True if its limit is the most accurate setting's by construction: the bias is 0 and not measured.
    pub is_unbiased: bool,
    /// Estimated relative error of its own reference.
    pub reference_noise: f64,
    /// No other one is both less biased and faster.
    pub is_on_front: bool,
    /// The image after equal time.
    #[serde(skip)]
    pub equal_time: Image,
    /// The image at the time of equal error.
    #[serde(skip)]
    pub equal_error: Image,
    /// The time that this took, seconds.
    pub equal_error_seconds: f64,
}

impl Runner {
    /// Whether of the bias only an upper limit is known.
    pub fn is_limit(&self) -> bool {
        !self.is_unbiased && !self.bias.is_resolved()
    }

    /// The bias, or 0 if not significant.
    pub fn resolved_bias(&self) -> f64 {
        if self.is_unbiased || !self.bias.is_resolved() {
            0.0
        } else {
            self.bias.value
        }
    }

    /// Bias in a logarithmic chart: at least the smallest resolvable one.
    pub fn charted_bias(&self, least: f64) -> f64 {
        let value = if self.is_limit() {
            self.bias.high
        } else {
            self.bias.value
        };
        value.max(least)
    }
}

impl Race {
    /// Lower end of the chart's bias axis: half the smallest resolvable bias.
    pub fn least_bias(&self) -> f64 {
        let resolved = self.runners.iter().filter(|runner| !runner.is_unbiased);
        let least = resolved
            .map(|runner| runner.charted_bias(0.0))
            .filter(|bias| *bias > 0.0);
        (0.5 * least.fold(f64::INFINITY, f64::min)).clamp(1e-5, 0.01)
    }
}

/// A technique during a race.
struct Lane {
    technique: Technique,
    document: Document,
    session: Session,
    step_denoiser: StepDenoiser,
}

impl Lane {
    /// Its displayed image, and the denoised one, if any.
    fn picture(&mut self) -> Result<(Arc<Image>, Option<Denoised>), StudyError> {
        let denoised = self.step_denoiser.finish(&mut self.session)?;
        let image = match &denoised {
            Some(denoised) => denoised.image.clone(),
            None => Arc::new(self.session.image()?),
        };
        Ok((image, denoised))
    }
}

/// Runs a race. `watch` receives the progress and may stop it.
pub fn race(document: &Document, options: &RaceOptions, watch: &mut Watch<'_>) -> Result<Race, StudyError> {
    let assets = Assets::default();
    let mut lanes = lanes(document, options, &assets)?;
    let mut steps = Steps::new(watch, (4 * lanes.len() + 2) as f64);
    let references = references_of(document, &mut lanes, options, &mut steps)?;
    run(&mut lanes, options, &mut steps)?;
    let mut runners = Vec::new();
    for (lane, own) in lanes.iter_mut().zip(&references.own) {
        runners.push(runner(lane, *own, &references.made, options)?);
    }
    let equal_error = runners.iter().map(|runner| runner.error.value).fold(0.0, f64::max);
    for (lane, runner) in lanes.iter_mut().zip(&mut runners) {
        let what = format!("Equal error: {}", runner.label);
        let share = (runner.error.value / equal_error.max(f64::MIN_POSITIVE)).powi(2);
        let samples = (runner.samples_per_pixel * share).max(SAMPLES_MIN);
        rerun(lane, samples, &mut |done| steps.report(what.clone(), done))?;
        let (image, denoised) = lane.picture()?;
        let denoise_seconds = denoised.map_or(0.0, |denoised| denoised.seconds);
        runner.equal_error = Image::clone(&image);
        runner.equal_error_seconds = lane.session.progress().engine_seconds + denoise_seconds;
        steps.finish(1.0);
    }
    mark_front(&mut runners);
    Ok(Race {
        machine: MachineInfo::of(lanes[0].session.engine()),
        width: document.render.width,
        height: document.render.height,
        seconds: options.seconds,
        noise: options.noise,
        equal_error,
        runners,
    })
}

/// The document as it is, and each technique that makes a difference to it or to another one.
fn lanes(document: &Document, options: &RaceOptions, assets: &Assets) -> Result<Vec<Lane>, StudyError> {
    let mut engine = options.engine;
    let mut lanes: Vec<Lane> = Vec::new();
    for technique in std::iter::once(&Technique::as_is()).chain(&options.techniques) {
        let changed = without_target(&technique.apply(document));
        if lanes.iter().any(|lane| lane.document == changed) {
            continue;
        }
        let session = Session::open_with(engine, assets.clone())?;
        // All on the same engine.
        engine = session.engine().kind.into();
        lanes.push(Lane {
            technique: technique.clone(),
            step_denoiser: StepDenoiser::new(&changed),
            document: changed,
            session,
        });
    }
    Ok(lanes)
}

/// What documents converge to, and which of these are the lanes' own; the first is the most accurate setting's.
struct References {
    made: Vec<(Document, Reference)>,
    own: Vec<usize>,
}

/// References of the most accurate setting and of each lane, each made once.
fn references_of(
    document: &Document,
    lanes: &mut [Lane],
    options: &RaceOptions,
    steps: &mut Steps<'_, '_>,
) -> Result<References, StudyError> {
    let effort = Effort {
        noise: options.noise / REFERENCE_GAIN,
        seconds: options.reference_seconds,
    };
    let mut made: Vec<(Document, Reference)> = Vec::new();
    let mut make = |session: &mut Session, document: &Document, what: &str| {
        let key = converged(document);
        let known = made.iter().position(|(known, _)| *known == key);
        if known.is_none() {
            let what = format!("Reference: {what}");
            let mut on_progress = |share: f64| steps.report(what.clone(), 2.0 * share);
            on_progress(0.0)?;
            made.push((key, reference(session, document, effort, &mut on_progress)?));
        }
        steps.finish(2.0);
        Ok::<_, StudyError>(known.unwrap_or(made.len() - 1))
    };
    // There is a lane for the document as it is.
    make(&mut lanes[0].session, &most_accurate(document), "most accurate")?;
    let own = lanes
        .iter_mut()
        .map(|lane| make(&mut lane.session, &lane.document, &lane.technique.label()));
    let own = own.collect::<Result<_, _>>()?;
    Ok(References { made, own })
}

/// Lets all of them take turns rendering until each has used its time.
fn run(lanes: &mut [Lane], options: &RaceOptions, steps: &mut Steps<'_, '_>) -> Result<(), StudyError> {
    for lane in lanes.iter_mut() {
        steps.report(format!("Preparing: {}", lane.technique.label()), 0.0)?;
        warmed(&mut lane.session, &lane.document)?;
    }
    let count = lanes.len();
    for round in 0.. {
        let mut is_done = true;
        for place in 0..count {
            // Everyone is first at some time.
            let lane = &mut lanes[(place + round) % count];
            let left = options.seconds - lane.session.progress().engine_seconds;
            if left <= 0.0 && lane.session.progress().mean_samples >= SAMPLES_MIN {
                continue;
            }
            is_done = false;
            let slice = options.slice.min(Duration::from_secs_f64(left.max(0.001)));
            lane.session.step(slice)?;
            // After each turn, not after each round: who stops it does not wait for the others' turns.
            steps.report(format!("Round {}", round + 1), share_of_all(lanes, options.seconds))?;
        }
        if is_done {
            break;
        }
    }
    steps.finish(count as f64);
    Ok(())
}

/// The sum of the shares of their time that all of them have had.
fn share_of_all(lanes: &[Lane], seconds: f64) -> f64 {
    let shares = lanes
        .iter()
        .map(|lane| lane.session.progress().engine_seconds / seconds);
    shares.map(|share| share.min(1.0)).sum()
}

fn runner(
    lane: &mut Lane,
    own: usize,
    references: &[(Document, Reference)],
    options: &RaceOptions,
) -> Result<Runner, StudyError> {
    let (_, reference) = &references[own];
    let progress = lane.session.progress();
    let estimate = crate::analysis::noise::noise(lane.session.film()?);
    let (equal_time, denoised) = lane.picture()?;
    let error = reference.halves.error_of(&equal_time.luminance());
    let denoised_bias = denoised.as_ref().and_then(|denoised| denoised.bias);
    let is_unbiased = own == 0 && denoised.is_none();
    let bias = match denoised_bias {
        _ if is_unbiased => Distance::default(),
        Some(bias) => bias,
        None => reference.halves.distance(&references[0].1.halves),
    };
    let denoised_error = denoised.as_ref().and_then(|denoised| denoised.error);
    let seconds = progress.engine_seconds + denoised.as_ref().map_or(0.0, |denoised| denoised.seconds);
    Ok(Runner {
        label: lane.technique.label(),
        technique: lane.technique.clone(),
        seconds,
        samples_per_pixel: progress.mean_samples,
        estimated_noise: denoised_error.map_or(estimate.map_or(0.0, |noise| noise.relative), |error| error.value),
        error,
        time_to_noise: seconds * (error.value / options.noise).powi(2),
        is_extrapolated: error.value > options.noise,
        bias,
        is_unbiased,
        reference_noise: reference.noise,
        is_on_front: false,
        equal_time: Image::clone(&equal_time),
        equal_error: Image::default(),
        equal_error_seconds: 0.0,
    })
}

/// Renders again up to `samples` per pixel on average; `report` receives the finished share.
fn rerun(
    lane: &mut Lane,
    samples: f64,
    report: &mut dyn FnMut(f64) -> Result<(), StudyError>,
) -> Result<(), StudyError> {
    let mut document = lane.document.clone();
    if !document.render.is_adaptive() {
        document.render.samples = samples.round() as u32;
    }
    lane.session.reset();
    lane.session.submit(&document)?;
    let mut step = Duration::from_millis(1);
    loop {
        let progress = lane.session.step(step)?;
        report((progress.mean_samples / samples).min(1.0))?;
        if progress.is_done || progress.mean_samples >= samples {
            return Ok(());
        }
        // Short steps, so that the last one overshoots little.
        let left = progress.engine_seconds * (samples / progress.mean_samples.max(1e-9) - 1.0);
        step = Duration::from_secs_f64(left.clamp(0.001, 0.2));
    }
}

/// Marks those that no other one betters in both time and bias.
fn mark_front(runners: &mut [Runner]) {
    let places: Vec<[f64; 2]> = runners
        .iter()
        .map(|runner| [runner.time_to_noise, runner.resolved_bias()])
        .collect();
    for (runner, place) in runners.iter_mut().zip(&places) {
        let is_better = |other: &[f64; 2]| other[0] <= place[0] && other[1] <= place[1] && other != place;
        runner.is_on_front = !places.iter().any(is_better);
    }
}
