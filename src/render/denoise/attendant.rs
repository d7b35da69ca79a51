//! The denoiser beside a session that is stepped to its end: by the command line, in turntables and studies.

use std::time::Duration;

use super::{Denoised, Denoiser};
use crate::document::{Denoise, Document};
use crate::render::session::{Progress, Session, SessionError};

/// By how much samples grow from one denoised picture to the next while its error is aimed at.
const GROWTH: f64 = 1.5;

/// Shortest step on the way there.
const STEP_MIN: Duration = Duration::from_millis(2);

/// Denoises what a session renders: at its end, and on the way where rendering stops at the error of what is shown.
pub struct Attendant {
    /// `None` where nothing is denoised, or nothing can be.
    denoiser: Option<Denoiser>,
    how: Denoise,
    /// Samples a pixel at which the error is looked at next.
    next_samples: f64,
    seconds: f64,
}

impl Attendant {
    /// The denoiser that a document asks for. Where there is none, a warning says why, once, and the samples are shown
    /// as they are.
    pub fn new(document: &Document) -> Self {
        let mut attendant = Self {
            denoiser: None,
            how: document.view.denoise,
            next_samples: 0.0,
            seconds: 0.0,
        };
        if attendant.how != Denoise::Off {
            match Denoiser::open() {
                Ok(denoiser) => attendant.denoiser = Some(denoiser),
                Err(error) => log::warn!("{error}; the picture is not denoised"),
            }
        }
        attendant
    }

    /// How long the next step may be, at most `usual`: where the error of the denoised picture is aimed at it is looked at
    /// often enough not to go far beyond.
    pub fn budget(&self, progress: &Progress, usual: Duration) -> Duration {
        if self.denoiser.is_none() || progress.noise_wanted.is_none() || !progress.aims_at_denoised {
            return usual;
        }
        let seconds = (GROWTH - 1.0) * progress.render_seconds;
        Duration::from_secs_f64(seconds.max(0.0)).clamp(STEP_MIN.min(usual), usual)
    }

    /// To be called after each step: tells the session how far the denoised picture is from the truth, where that is
    /// what it aims at.
    ///
    /// # Errors
    /// If the GPU fails.
    pub fn attend(&mut self, session: &mut Session, progress: &Progress) -> Result<(), SessionError> {
        let is_due = progress.noise_wanted.is_some()
            && progress.aims_at_denoised
            && progress.mean_samples >= self.next_samples.max(2.0)
            && !progress.is_done;
        if is_due && self.denoiser.is_some() {
            self.next_samples = GROWTH * progress.mean_samples;
            self.denoise(session)?;
        }
        Ok(())
    }

    /// The denoised picture, where there is one; its time includes that of those before it.
    ///
    /// # Errors
    /// If the GPU fails.
    pub fn finish(&mut self, session: &mut Session) -> Result<Option<Denoised>, SessionError> {
        self.next_samples = 0.0;
        let denoised = self.denoise(session)?;
        let seconds = std::mem::take(&mut self.seconds);
        Ok(denoised.map(|denoised| Denoised { seconds, ..denoised }))
    }

    fn denoise(&mut self, session: &mut Session) -> Result<Option<Denoised>, SessionError> {
        let Some(denoiser) = &mut self.denoiser else {
            return Ok(None);
        };
        match denoiser.denoise(&session.noisy()?, self.how) {
            Ok(denoised) => {
                self.seconds += denoised.seconds;
                if let Some(error) = denoised.error {
                    session.note_denoised(error);
                }
                Ok(Some(denoised))
            }
            Err(error) => {
                log::warn!("{error}; the picture is not denoised");
                self.denoiser = None;
                Ok(None)
            }
        }
    }
}
