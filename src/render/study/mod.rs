//! What accuracy costs: techniques raced against each other, a ledger of effects and settings, and how time grows with
//! the size of things. Everything is measured on the engine that renders, by its own clock, in turns.

mod convergence;
pub mod ledger;
pub mod race;
pub mod references;
pub mod sampling;
pub mod scaling;

use std::time::Duration;

use serde::Serialize;

use super::engine::EngineInfo;
use super::error::SessionError;
use super::session::Session;
use crate::document::Document;
use crate::store::FileError;

pub use convergence::{ConvergencePoint, ConvergenceReport, DenoisedPoint, convergence};

/// Samples a pixel where time or noise ends a render.
const UNLIMITED: u32 = u32::MAX;

/// Why a study came to nothing.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// Something can't be rendered.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// A file can't be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The picture is black, or nearly: there is nothing to be relative to.
    #[error("the picture is black: errors relative to its brightness mean nothing. Give the scene some light")]
    Black,
    /// It was stopped by the one who asked for it.
    #[error("the study was stopped")]
    Stopped,
}

impl From<crate::gpu::GpuError> for StudyError {
    fn from(error: crate::gpu::GpuError) -> Self {
        Self::Session(error.into())
    }
}

/// How far a study has come.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudyProgress {
    /// In [0, 1].
    pub share: f64,
    /// What is being done.
    pub what: String,
}

/// Is told how far a study has come, and says whether it is to go on.
pub type Watch<'a> = dyn FnMut(StudyProgress) -> bool + 'a;

/// The share that has been done, told after each piece of work.
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

    /// Says what is being done, `within` of a piece of work having been done of it.
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

/// Where numbers were measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Machine {
    /// The program's version.
    pub version: &'static str,
    /// `gpu` or `cpu`.
    pub engine: &'static str,
    /// The adapter's or processor's name.
    pub adapter: String,
    /// The adapter's driver; empty for the processor.
    pub driver: String,
}

impl Machine {
    fn of(info: &EngineInfo) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            engine: info.kind.name(),
            adapter: info.adapter.clone(),
            driver: info.driver.clone(),
        }
    }
}

/// The same document without an aim: it is rendered until something else ends it, and whole.
fn without_aim(document: &Document) -> Document {
    let mut document = document.clone();
    let render = &mut document.render;
    // What is adaptive because of a noise to reach stays so.
    render.adaptive = Some(render.is_adaptive());
    (render.samples, render.time_s, render.noise) = (UNLIMITED, None, None);
    render.region = None;
    document
}

/// An open session that has compiled what a document needs and starts over with it.
fn warmed(session: &mut Session, document: &Document) -> Result<(), StudyError> {
    session.submit(document)?;
    session.step(Duration::from_millis(1))?;
    session.forget();
    session.submit(document)?;
    Ok(())
}

/// The middle value; NaN where there is none.
fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// The value below which a share of the values lies.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_lie_between_the_values() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&[1.0, 2.0]), 1.5);
        assert_eq!(quantile(&[0.0, 1.0, 2.0, 3.0, 4.0], 0.25), 1.0);
        assert!(median(&[]).is_nan());
    }
}
