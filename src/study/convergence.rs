//! Error against time of one document.

use std::time::Duration;

use serde::Serialize;

use super::{MachineInfo, Steps, StudyError, Watch, references::Effort, references::reference, warmed};
use crate::{
    analysis::halves::Distance,
    document::Document,
    render::{EngineChoice, Session, StepDenoiser, StopReason},
};

/// Precision of the reference relative to the render, if time permits.
const REFERENCE_GAIN: f64 = 4.0;
/// Factor by which samples grow between denoised images.
const DENOISED_GROWTH: f64 = 1.5;
/// Render time between two checks for a stop.
const STEP: Duration = Duration::from_millis(100);

/// The error at some time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ConvergencePoint {
    /// The engine's own time, seconds.
    pub seconds: f64,
    /// Samples per pixel until then, in the mean.
    pub samples_per_pixel: f64,
    /// Estimated relative error.
    pub noise: f64,
    /// The lower end of its 95 % band.
    pub noise_low: f64,
    /// Upper end of its 95 % interval.
    pub noise_high: f64,
    /// Relative error by the samples' spread, as if independent.
    pub noise_from_spread: f64,
}

/// Error of the denoised image at some time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DenoisedPoint {
    /// Engine time so far plus the time of denoising this image, in seconds.
    pub seconds: f64,
    /// Samples per pixel until then, in the mean.
    pub samples_per_pixel: f64,
    /// Estimated relative error, bias included.
    pub error: f64,
    /// The lower end of its 95 % band.
    pub error_low: f64,
    /// Upper end of its 95 % interval.
    pub error_high: f64,
}

/// Error over time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConvergenceReport {
    /// MachineInfo of the measurement.
    pub machine: MachineInfo,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    pub stopped_by: Option<StopReason>,
    /// The errors seen, oldest first.
    pub points: Vec<ConvergencePoint>,
    /// Points of the denoised image, if denoised.
    pub denoised: Vec<DenoisedPoint>,
    /// Slope of the error over the time, both as logarithms: −0.5 for independent samples. `None` with fewer than two
    /// points.
    pub slope: Option<f64>,
    /// The error at the end against a reference.
    pub true_error: Distance,
}

/// Renders a document until its own target is reached, and records its error.
pub fn convergence(
    document: &Document,
    engine: EngineChoice,
    reference_seconds: f64,
    watch: &mut Watch<'_>,
) -> Result<ConvergenceReport, StudyError> {
    let mut steps = Steps::new(watch, 2.0);
    let mut session = Session::open(engine)?;
    warmed(&mut session, document)?;
    let mut step_denoiser = StepDenoiser::new(document);
    let (mut denoised, mut next_samples) = (Vec::new(), 2.0);
    let progress = loop {
        session.step(STEP)?;
        let seen = session.progress();
        if seen.mean_samples >= next_samples || seen.is_done {
            next_samples = DENOISED_GROWTH * seen.mean_samples;
            denoised.extend(denoised_point(&mut step_denoiser, &mut session)?);
        }
        let progress = session.progress();
        steps.report("Rendering", progress.share_done(document.render.time_s))?;
        if progress.is_done {
            break progress;
        }
    };
    steps.finish(1.0);
    let point = |seen: &crate::render::Measurement| ConvergencePoint {
        seconds: seen.engine_seconds,
        samples_per_pixel: seen.samples_per_pixel,
        noise: seen.noise.relative,
        noise_low: seen.noise.low,
        noise_high: seen.noise.high,
        noise_from_spread: seen.noise.from_spread,
    };
    let points: Vec<ConvergencePoint> = session.history().iter().map(point).collect();
    let luminances = session.film()?.luminance();
    let noise = progress.noise.map_or(1.0, |noise| noise.relative);
    let effort = Effort {
        noise: noise / REFERENCE_GAIN,
        seconds: reference_seconds,
    };
    let mut other = Session::open_with(session.engine().kind.into(), session.assets().clone())?;
    let mut on_progress = |share: f64| steps.report("Reference", share);
    let reference = reference(&mut other, document, effort, &mut on_progress)?;
    Ok(ConvergenceReport {
        machine: MachineInfo::of(session.engine()),
        width: document.render.width,
        height: document.render.height,
        stopped_by: progress.stopped_by,
        slope: slope(&points),
        points,
        denoised,
        true_error: reference.halves.error_of(&luminances),
    })
}

fn denoised_point(
    step_denoiser: &mut StepDenoiser,
    session: &mut Session,
) -> Result<Option<DenoisedPoint>, StudyError> {
    let progress = session.progress();
    let Some(denoised) = step_denoiser.finish(session)? else {
        return Ok(None);
    };
    Ok(denoised.error.map(|estimate| DenoisedPoint {
        seconds: progress.engine_seconds + denoised.seconds,
        samples_per_pixel: progress.mean_samples,
        error: estimate.value,
        error_low: estimate.low,
        error_high: estimate.high,
    }))
}

/// Least squares over the logarithms.
fn slope(points: &[ConvergencePoint]) -> Option<f64> {
    let seen = points.iter().filter(|point| point.noise > 0.0 && point.seconds > 0.0);
    let places: Vec<[f64; 2]> = seen.map(|point| [point.seconds.ln(), point.noise.ln()]).collect();
    let count = places.len() as f64;
    let mean = |axis: usize| places.iter().map(|place| place[axis]).sum::<f64>() / count;
    let (x, y) = (mean(0), mean(1));
    let covariance: f64 = places.iter().map(|place| (place[0] - x) * (place[1] - y)).sum();
    let variance: f64 = places.iter().map(|place| (place[0] - x).powi(2)).sum();
    (variance > 0.0).then(|| covariance / variance)
}
