//! A document rendered to its end by a session that is stepped: on the command line, in turntables and in the queue.

use std::time::Duration;

use super::{
    denoise::Denoised, engine::EngineChoice, error::SessionError, progress::Progress, session::Session,
    step_denoiser::StepDenoiser,
};
use crate::document::Document;

/// Session step between two checks for a stop.
const STEP: Duration = Duration::from_millis(100);

/// Result of a render.
pub struct Ended {
    /// Progress; incomplete if stopped.
    pub progress: Progress,
    /// The denoised image, if requested and available.
    pub denoised: Option<Denoised>,
}

/// Submits a document to a session. After a lost GPU device it continues with another one; after any other GPU failure on
/// the CPU, unless the GPU was requested by name.
pub fn submit(session: &mut Session, engine: EngineChoice, document: &Document) -> Result<(), SessionError> {
    or_fall_back(session.submit(document).map(|_| ()), session, engine, document)
}

/// Renders the submitted document to its end, falling back as [`submit`] does, and denoises it if requested. `on_progress`
/// receives the progress after every step and stops the render by returning `false`.
pub fn step_to_end(
    session: &mut Session,
    engine: EngineChoice,
    document: &Document,
    step_denoiser: &mut StepDenoiser,
    on_progress: &mut dyn FnMut(&Progress) -> bool,
) -> Result<Ended, SessionError> {
    loop {
        // Reads the GPU's sums back: if that fails, the render can still be repeated.
        let stepped = session.step(STEP).and_then(|progress| {
            if progress.is_done {
                session.film()?;
            }
            Ok(())
        });
        or_fall_back(stepped, session, engine, document)?;
        step_denoiser.attend(session, &session.progress())?;
        let progress = session.progress();
        let is_stopped = !on_progress(&progress);
        if progress.is_done {
            let denoised = step_denoiser.finish(session)?;
            let progress = session.progress();
            return Ok(Ended { progress, denoised });
        }
        if is_stopped {
            let denoised = None;
            return Ok(Ended { progress, denoised });
        }
    }
}

fn or_fall_back(
    outcome: Result<(), SessionError>,
    session: &mut Session,
    engine: EngineChoice,
    document: &Document,
) -> Result<(), SessionError> {
    match outcome {
        Err(SessionError::Gpu(error)) if engine == EngineChoice::Auto || error.is_lost() => {
            log::warn!("{}", session.recover(&error));
            or_fall_back(session.submit(document).map(|_| ()), session, engine, document)
        }
        outcome => outcome,
    }
}
