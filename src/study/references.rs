//! Converged reference renders.

use std::time::Duration;

use super::{StudyError, UNLIMITED};
use crate::{analysis::halves::Halves, document::Document, render::Session, study::technique::converged};

/// Changes the random numbers of a reference: no technique's own are these.
const SEED: u32 = 0x5eed_0f0f;
/// Render time between two checks for a stop.
const STEP: Duration = Duration::from_millis(100);

/// A reference render of the requested precision.
pub struct Reference {
    /// Halves of its samples.
    pub halves: Halves,
    /// Estimated relative error.
    pub noise: f64,
}

/// Requested precision of references.
#[derive(Clone, Copy)]
pub struct Effort {
    /// Relative error to reach.
    pub noise: f64,
    /// Time limit in seconds.
    pub seconds: f64,
}

/// What a document converges to. `on_progress` is asked now and then, with the share of the time that has gone by.
///
/// # Errors
/// What the session can't render, and [`StudyError::Stopped`].
pub fn reference(
    session: &mut Session,
    document: &Document,
    effort: Effort,
    on_progress: &mut dyn FnMut(f64) -> Result<(), StudyError>,
) -> Result<Reference, StudyError> {
    let mut document = converged(document);
    document.render.seed = SEED;
    document.render.samples = UNLIMITED;
    document.render.noise = Some(effort.noise);
    document.render.time_s = Some(effort.seconds);
    document.render.adaptive = Some(false);
    session.reset();
    session.submit(&document)?;
    loop {
        let progress = session.step(STEP)?;
        on_progress((progress.render_seconds / effort.seconds).min(1.0))?;
        // Both halves of every pixel need some samples.
        if progress.is_done && progress.mean_samples >= 4.0 {
            break;
        }
        if progress.is_done {
            document.render.time_s = Some(2.0 * progress.render_seconds.max(effort.seconds));
            session.submit(&document)?;
        }
    }
    let progress = session.progress();
    let noise = progress.noise.map_or(f64::INFINITY, |noise| noise.relative);
    let film = session.film()?;
    let halves = Halves::of(film);
    let is_lit = halves.mean_luminance() > 1e-9;
    session.reset();
    if is_lit {
        Ok(Reference { halves, noise })
    } else {
        Err(StudyError::Black)
    }
}
