//! What is found out with the renderer. Studies of cost and accuracy: a race of techniques, a ledger of effects and settings,
//! and a benchmark, all by the engine's own clock, in interleaved trials. Proofs: checks and hard cases.
//! Questions: values of a material, and the account of a path.

pub mod benchmark;
pub mod check;
mod convergence;
pub mod evaluate;
pub mod explain;
pub mod hard;
pub mod ledger;
pub mod race;
mod references;
pub mod technique;

use std::{io, time::Duration};

use serde::Serialize;

use crate::{
    document::{Document, PixelFilter},
    optics::random::Sequence,
    render::{EngineInfo, Session, SessionError, output::OutputError},
    scene::{ModelSource, environment::EnvironmentSource},
    store::FileError,
};

pub use convergence::{ConvergencePoint, ConvergenceReport, DenoisedPoint, convergence};

/// Samples per pixel of a render that ends by time or noise.
const UNLIMITED: u32 = u32::MAX;

/// Errors of a study.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// Something can't be rendered.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// A file can't be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The image is (nearly) black, so that relative errors are undefined.
    #[error("the image is black: errors relative to its brightness mean nothing. Give the scene some light")]
    Black,
    /// The system's temporary folder cannot be written to.
    #[error("the temporary folder cannot be written to: {0}; make room in it, or name another one by TMPDIR")]
    Folder(#[from] io::Error),
    /// An image can't be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The study was stopped.
    #[error("the study was stopped")]
    Stopped,
}

impl From<crate::gpu::GpuError> for StudyError {
    fn from(error: crate::gpu::GpuError) -> Self {
        Self::Session(error.into())
    }
}

/// Progress of a study.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudyProgress {
    /// In [0, 1].
    pub share: f64,
    /// Current step.
    pub what: String,
}

/// Progress callback of a study; returning false stops it.
pub type Watch<'a> = dyn FnMut(StudyProgress) -> bool + 'a;

/// Progress reporter over pieces of work.
struct Steps<'a, 'b> {
    watch: &'a mut Watch<'b>,
    done: f64,
    total: f64,
}

impl<'a, 'b> Steps<'a, 'b> {
    fn new(watch: &'a mut Watch<'b>, total: f64) -> Self {
        Self {
            watch,
            done: 0.0,
            total,
        }
    }

    /// Reports the current step; `within` in [0, 1] is the finished share of the current piece of work.
    fn report(&mut self, what: impl Into<String>, within: f64) -> Result<(), StudyError> {
        let share = ((self.done + within) / self.total.max(1e-9)).clamp(0.0, 1.0);
        let progress = StudyProgress {
            share,
            what: what.into(),
        };
        if (self.watch)(progress) {
            Ok(())
        } else {
            Err(StudyError::Stopped)
        }
    }

    fn finish(&mut self, work: f64) {
        self.done += work;
    }
}

/// Machine of a measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MachineInfo {
    pub version: &'static str,
    /// `gpu` or `cpu`.
    pub engine: &'static str,
    /// Name of the adapter or CPU.
    pub adapter: String,
    /// Driver of the adapter; empty for the CPU.
    pub driver: String,
}

impl MachineInfo {
    fn of(info: &EngineInfo) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            engine: info.kind.name(),
            adapter: info.adapter.clone(),
            driver: info.driver.clone(),
        }
    }
}

/// The same document without a target and without a region.
fn without_target(document: &Document) -> Document {
    let mut document = document.clone();
    let render = &mut document.render;
    // A document that is adaptive because of its noise target stays adaptive.
    render.adaptive = Some(render.is_adaptive());
    (render.samples, render.time_s, render.noise) = (UNLIMITED, None, None);
    render.region = None;
    document
}

/// A small document with honest variances: box filter, independent samples.
fn small_document(model: ModelSource, light: EnvironmentSource, side: u32, samples: u32) -> Document {
    let mut document = Document {
        model,
        ..Document::default()
    };
    document.lighting.environment = light;
    (document.render.width, document.render.height) = (side, side);
    document.render.samples = samples;
    document.render.filter = PixelFilter::Box;
    document.render.sequence = Sequence::Independent;
    document
}

/// Warms a session up for a document and starts over with it.
fn warmed(session: &mut Session, document: &Document) -> Result<(), StudyError> {
    session.submit(document)?;
    session.step(Duration::from_millis(1))?;
    session.reset();
    session.submit(document)?;
    Ok(())
}

/// Median; NaN without values.
fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = share * (sorted.len().max(1) - 1) as f64;
    let (low, high) = (place.floor() as usize, place.ceil() as usize);
    match (sorted.get(low), sorted.get(high)) {
        (Some(a), Some(b)) => a + (b - a) * place.fract(),
        _ => f64::NAN,
    }
}
