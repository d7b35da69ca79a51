//! The denoiser beside a session that is stepped to its end: by the command line, in turntables and studies.

use super::{denoise::Denoised, denoise::Denoiser, error::SessionError, progress::Progress, session::Session};
use crate::document::{Denoise, Document};

/// Factor by which samples grow between denoised images, while their error is the goal.
const GROWTH: f64 = 1.5;

/// Denoises a session's render: at its end, and repeatedly if its error is the stop criterion.
pub struct StepDenoiser {
    /// `None` without denoising.
    denoiser: Option<Denoiser>,
    how: Denoise,
    /// Samples per pixel at which the error is looked at next.
    next_samples: f64,
    seconds: f64,
}

impl StepDenoiser {
    /// The denoiser that a document requests. If there is none, it warns once, and the samples are shown.
    pub fn new(document: &Document) -> Self {
        let mut step_denoiser = Self {
            denoiser: None,
            how: document.view.denoise,
            next_samples: 0.0,
            seconds: 0.0,
        };
        if step_denoiser.how != Denoise::Off {
            match Denoiser::open() {
                Ok(denoiser) => step_denoiser.denoiser = Some(denoiser),
                Err(error) => log::warn!("{error}; the image is not denoised"),
            }
        }
        step_denoiser
    }

    /// Call after each step. At the end of a round, it reports the denoised image's error to the session, if that is the
    /// goal.
    pub fn attend(&mut self, session: &mut Session, progress: &Progress) -> Result<(), SessionError> {
        let is_due = progress.noise_wanted.is_some()
            && progress.targets_denoised
            && progress.mean_samples >= self.next_samples.max(2.0)
            && session.is_between_rounds()
            && !progress.is_done;
        if is_due && self.denoiser.is_some() {
            self.next_samples = GROWTH * progress.mean_samples;
            self.denoise(session)?;
        }
        Ok(())
    }

    /// The denoised image, if requested; its time includes earlier ones.
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
                    session.denoised = Some(error);
                }
                Ok(Some(denoised))
            }
            Err(error) => {
                log::warn!("{error}; the image is not denoised");
                self.denoiser = None;
                Ok(None)
            }
        }
    }
}
