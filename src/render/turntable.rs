//! Turntables: a session that renders one frame after the other, into numbered files, a video, or both.

use std::path::{Path, PathBuf};

use super::{
    display::display,
    engine::EngineChoice,
    session::Session,
    step_denoiser::StepDenoiser,
    to_end::{step_to_end, submit},
};
use crate::{
    document::Document,
    document::turntable::{Turn, turned},
    store::{FileError, replace::check_saving, video::Video},
};

/// Frames a second of a video at first.
pub const FPS: f64 = 24.0;

#[derive(Clone, Debug, PartialEq)]
pub struct Turntable {
    /// Frame 0; the size and the samples of all.
    pub document: Document,
    pub turn: Turn,
    /// Frames of a whole turn, at least 1.
    pub frames: u32,
    /// Folder of the frames, if requested.
    pub folder: Option<PathBuf>,
    /// File of the video, if requested.
    pub video: Option<PathBuf>,
    /// Frames a second of the video.
    pub fps: f64,
    /// Whether a stopped turntable keeps a video of its finished frames.
    pub keeps_part: bool,
}

/// Progress of a turntable.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TurntableProgress {
    /// Frames written.
    pub done: u32,
    /// Share of the frame in progress, 0 to 1.
    pub share: f64,
}

/// Result of a turntable.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TurntableOutcome {
    pub frames: u32,
    /// The engine's own time, seconds.
    pub render_seconds: f64,
    /// Samples left out because they were not finite.
    pub dropped: u64,
}

/// The file of a frame, counted from 1: `frame-0001.png`.
pub fn frame_path(folder: &Path, number: u32) -> PathBuf {
    folder.join(format!("frame-{number:04}.png"))
}

impl Turntable {
    /// Creates the folder and the video: errors occur before rendering.
    fn begin(&self) -> anyhow::Result<Option<Video>> {
        if let Some(folder) = &self.folder {
            std::fs::create_dir_all(folder).map_err(|source| FileError::Write {
                path: folder.clone(),
                source,
            })?;
        }
        let Some(path) = &self.video else { return Ok(None) };
        check_saving(path)?;
        let render = &self.document.render;
        Ok(Some(Video::begin(path, [render.width, render.height], self.fps)?))
    }
}

/// Renders the frames in order, falling back to another engine as [`submit`] does. `on_progress` receives the progress after
/// every step, and stops the whole by `false`: written frames stay; for a video see [`Turntable::keeps_part`].
///
/// # Errors
///
/// They name the file; earlier frames stay.
pub fn render(
    session: &mut Session,
    engine: EngineChoice,
    table: &Turntable,
    on_progress: &mut dyn FnMut(TurntableProgress) -> bool,
) -> anyhow::Result<TurntableOutcome> {
    let mut video = table.begin()?;
    let mut outcome = TurntableOutcome::default();
    let mut center_world = [0.0; 3];
    let mut step_denoiser = StepDenoiser::new(&table.document);
    for frame in 0..table.frames {
        let document = turned(&table.document, table.turn, frame, table.frames, center_world);
        submit(session, engine, &document)?;
        if let (0, Some(job)) = (frame, session.job()) {
            // Frame 0 does not need it.
            center_world = job.geometry.center_world.to_array();
        }
        let mut is_stopped = false;
        let ended = step_to_end(session, engine, &document, &mut step_denoiser, &mut |progress| {
            let share = progress.share_done(document.render.time_s);
            is_stopped = !on_progress(TurntableProgress { done: frame, share });
            !is_stopped
        })?;
        if !ended.progress.is_done {
            break;
        }
        outcome.render_seconds += ended.progress.render_seconds;
        outcome.dropped += session.film()?.dropped();
        let denoised = ended.denoised.as_ref().map(|denoised| denoised.image.as_ref());
        if let Some(folder) = &table.folder {
            session.write_image(&frame_path(folder, frame + 1), denoised, &document)?;
        }
        if let Some(video) = &mut video {
            let shown = match denoised {
                Some(image) => display(image, &document.view),
                None => display(&session.image()?, &document.view),
            };
            video.add(&shown)?;
        }
        outcome.frames = frame + 1;
        // A frame of a single step may be done in the last step.
        if is_stopped {
            break;
        }
    }
    let keeps_video = outcome.frames == table.frames || (table.keeps_part && outcome.frames > 0);
    video.filter(|_| keeps_video).map_or(Ok(()), Video::finish)?;
    Ok(outcome)
}
