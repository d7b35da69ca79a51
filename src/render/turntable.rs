//! Turntables: a session that renders one frame after the other into numbered files.

use std::path::{Path, PathBuf};
use std::time::Duration;

use super::denoise::Attendant;
use super::output::{self, OutputError, Rendered};
use super::session::{Session, SessionError};
use crate::document::Document;
use crate::document::turntable::{Turn, turned};
use crate::store::FileError;

/// Step of the session between two looks at whether to go on.
const STEP: Duration = Duration::from_millis(100);

/// What a turntable is.
#[derive(Clone, Debug, PartialEq)]
pub struct Turntable {
    /// Frame 0; the size and the samples of all.
    pub document: Document,
    /// What turns.
    pub turn: Turn,
    /// Frames of a whole turn, at least 1.
    pub frames: u32,
    /// The folder of the pictures.
    pub folder: PathBuf,
}

/// How far it has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TurntableProgress {
    /// Frames written.
    pub done: u32,
    /// Share of the frame in progress, 0 to 1.
    pub share: f64,
}

/// What it came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TurntableOutcome {
    /// Frames written.
    pub frames: u32,
    /// The engine's own time, seconds.
    pub render_seconds: f64,
    /// Samples left out because they were not finite.
    pub dropped: u64,
}

/// Why there are not all frames.
#[derive(Debug, thiserror::Error)]
pub enum TurntableError {
    /// The folder cannot be made.
    #[error(transparent)]
    Folder(#[from] FileError),
    /// The scene or the engine.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// A picture.
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// The file of a frame, counted from 1: `frame-0001.png`.
pub fn frame_path(folder: &Path, number: u32) -> PathBuf {
    folder.join(format!("frame-{number:04}.png"))
}

/// Renders the frames in order. `go_on` is told the progress after every step, and stops the whole by `false`: what was
/// written stays.
///
/// # Errors
/// [`TurntableError`] naming the file; frames before stay.
pub fn render(
    session: &mut Session,
    table: &Turntable,
    go_on: &mut dyn FnMut(TurntableProgress) -> bool,
) -> Result<TurntableOutcome, TurntableError> {
    std::fs::create_dir_all(&table.folder).map_err(|source| FileError::Write {
        path: table.folder.clone(),
        source,
    })?;
    let mut outcome = TurntableOutcome::default();
    let mut center_world = [0.0; 3];
    let mut attendant = Attendant::new(&table.document);
    for frame in 0..table.frames {
        let document = turned(&table.document, table.turn, frame, table.frames, center_world);
        session.submit(&document)?;
        if let (0, Some(job)) = (frame, session.job()) {
            // Frame 0 does not need it.
            center_world = job.geometry.center_world.to_array();
        }
        loop {
            session.step(attendant.budget(&session.progress(), STEP))?;
            attendant.attend(session, &session.progress())?;
            let progress = session.progress();
            let by_samples = f64::from(progress.samples_per_pixel) / f64::from(progress.samples_wanted.max(1));
            let by_time = document
                .render
                .time_s
                .map_or(0.0, |limit| progress.render_seconds / limit);
            let told = TurntableProgress {
                done: frame,
                share: by_samples.max(by_time).min(1.0),
            };
            if !go_on(told) {
                return Ok(outcome);
            }
            if progress.is_done {
                outcome.render_seconds += progress.render_seconds;
                break;
            }
        }
        outcome.dropped += session.film()?.dropped();
        let denoised = attendant.finish(session)?;
        let image = session.image()?;
        let rendered = Rendered {
            denoised: denoised.as_ref().map(|denoised| denoised.image.as_ref()),
            ..Rendered::from(&image)
        };
        output::write(&frame_path(&table.folder, frame + 1), rendered, &document)?;
        outcome.frames = frame + 1;
    }
    Ok(outcome)
}
