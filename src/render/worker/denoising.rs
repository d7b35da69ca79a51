//! The denoiser's thread. It takes the latest render to denoise and returns the result to the worker.

use std::sync::{Arc, atomic::AtomicBool, atomic::Ordering::Relaxed};

use crate::{
    document::{Denoise, DenoiseWhen, Document},
    panics::caught,
    render::{
        background::{Background, Responder},
        denoise::{Denoised, Denoiser, LibraryError, Noisy},
        frame::Frame,
        progress::Progress,
    },
};

/// Factor by which samples grow from one denoised image to the next.
const GROWTH: u32 = 2;
/// Render time in seconds up to which images are denoised as one.
const AS_ONE_S: f64 = 0.5;
/// Time of a first image's samples, relative to that of its denoising.
const FIRST_SHARE: f64 = 0.6;
/// Render time in seconds up to which denoising is not limited, and its share of the time from then on.
const EARLY_S: f64 = 1.0;
const TIME_SHARE: f64 = 0.2;

/// A render to denoise.
struct Request {
    noisy: Noisy,
    /// The frame that `noisy` was copied with.
    frame: Frame,
    mode: Denoise,
    /// Its time does not count against [`TIME_SHARE`].
    is_early: bool,
    /// Set once the result is no longer needed.
    cancel: Arc<AtomicBool>,
}

/// The result of a request.
pub struct Outcome {
    /// The denoised image, or the error message.
    pub denoised: Result<Denoised, String>,
    /// The frame that was denoised, as it was.
    pub frame: Frame,
    is_early: bool,
    cancel: Arc<AtomicBool>,
}

/// The worker's handle of the denoiser's thread: sends requests and collects results.
pub struct Denoising {
    thread: Background<Request, Outcome>,
    /// Whether the latest request has no result yet.
    is_pending: bool,
    /// Samples per pixel of the latest request of this render; 0 before the first.
    requested_samples: u32,
    /// Cancels the requests of this render.
    cancel: Arc<AtomicBool>,
    /// Time in seconds of this render's requests after [`EARLY_S`].
    late_seconds: f64,
    /// Time of the latest result, in seconds.
    latest_seconds: f64,
    /// Least time in seconds for each pixel of an image denoised as one; `None` before the first.
    as_one_seconds: Option<f64>,
    /// Whether an image of this render has an error estimate.
    has_error: bool,
    /// Error message, if nothing can be denoised.
    failure: Option<String>,
}

impl Denoising {
    /// Starts the thread, which calls `wake` after each result.
    pub fn spawn(wake: impl Fn() + Send + 'static) -> Self {
        let mut denoiser = None;
        let thread = Background::spawn("denoise", wake, move |request, responder| {
            answer(&mut denoiser, request, responder);
        });
        Self {
            failure: thread.failure(),
            thread,
            is_pending: false,
            requested_samples: 0,
            cancel: Arc::default(),
            late_seconds: 0.0,
            latest_seconds: 0.0,
            as_one_seconds: None,
            has_error: false,
        }
    }

    /// Starts another render: cancels the requests of the one before.
    pub fn reset(&mut self) {
        std::mem::take(&mut self.cancel).store(true, Relaxed);
        self.is_pending = false;
        self.requested_samples = 0;
        self.late_seconds = 0.0;
        self.has_error = false;
    }

    /// Whether the document's render is shown denoised at this progress.
    pub fn shows(&self, document: &Document, progress: &Progress) -> bool {
        let is_time = document.view.denoise_when == DenoiseWhen::Rendering || progress.is_done;
        document.view.denoise != Denoise::Off && self.failure.is_none() && is_time
    }

    /// Whether a request is exempt from the time share: early in a render, and the first one with an error estimate.
    fn is_early(&self, progress: &Progress) -> bool {
        progress.render_seconds < EARLY_S || !self.has_error
    }

    /// Whether the next request is denoised as one and fast: better and sooner than two halves, but without an error.
    pub fn is_as_one(&self, progress: &Progress) -> bool {
        !progress.is_done && (self.requested_samples == 0 || progress.render_seconds < AS_ONE_S)
    }

    /// Whether a request is due. The first one is at once, or if it `may_wait` after [`FIRST_SHARE`] of the time that
    /// denoising will take: more samples are worth more than an earlier image. Then at twice the samples of the one before
    /// within the time share, and the last one.
    pub fn is_due(&self, progress: &Progress, pixels: f64, may_wait: bool) -> bool {
        let samples = progress.samples_per_pixel;
        if samples <= self.requested_samples {
            return false;
        }
        if self.requested_samples == 0 && !progress.is_done {
            let wait = FIRST_SHARE * self.as_one_seconds.filter(|_| may_wait).unwrap_or(0.0) * pixels;
            return progress.render_seconds >= wait.min(AS_ONE_S);
        }
        let spent_and_next = self.late_seconds + self.latest_seconds;
        let is_cheap = self.is_early(progress) || spent_and_next <= TIME_SHARE * (progress.render_seconds - EARLY_S);
        progress.is_done || (!self.is_pending && is_cheap && samples >= GROWTH * self.requested_samples)
    }

    /// Whether a request has no result yet.
    pub fn is_pending(&self) -> bool {
        self.is_pending
    }

    /// Whether there is a result to collect.
    pub fn has_outcome(&self) -> bool {
        self.thread.has_answer()
    }

    /// Requests a denoised image. Replaces a request that has not been started.
    pub fn request(&mut self, noisy: Noisy, frame: Frame, mode: Denoise, progress: &Progress) {
        let is_early = self.is_early(progress);
        self.is_pending = true;
        self.requested_samples = frame.samples_per_pixel;
        let request = Request {
            noisy,
            frame,
            mode,
            is_early,
            cancel: self.cancel.clone(),
        };
        self.thread.ask(request);
    }

    /// Takes the latest result, if it is of the current render. After a failure nothing is denoised any more.
    pub fn collect(&mut self) -> Option<Outcome> {
        let outcome = self.thread.take()?;
        if let Err(why) = &outcome.denoised {
            self.failure = Some(why.clone());
        }
        // Of an earlier render.
        if outcome.cancel.load(Relaxed) {
            return None;
        }
        self.is_pending &= outcome.frame.samples_per_pixel != self.requested_samples;
        if let Ok(denoised) = &outcome.denoised {
            self.latest_seconds = denoised.seconds;
            self.has_error |= denoised.error.is_some();
            if denoised.error.is_none() {
                let seconds = denoised.seconds / denoised.image.pixels.len() as f64;
                self.as_one_seconds = Some(self.as_one_seconds.map_or(seconds, |least| least.min(seconds)));
            }
            if !outcome.is_early {
                self.late_seconds += denoised.seconds;
            }
        }
        Some(outcome)
    }
}

impl Drop for Denoising {
    /// Ends the thread without waiting for it, as it may be in the middle of a request.
    fn drop(&mut self) {
        self.cancel.store(true, Relaxed);
    }
}

fn answer(denoiser: &mut Option<Denoiser>, request: Request, responder: &Responder<'_, Outcome>) {
    let denoised = match caught(|| denoise(denoiser, &request)) {
        Ok(Err(LibraryError::Cancelled)) => return,
        Ok(done) => done.map_err(crate::in_words),
        Err(panic) => Err(panic),
    };
    responder.publish(Outcome {
        denoised,
        frame: request.frame,
        is_early: request.is_early,
        cancel: request.cancel,
    });
}

fn denoise(denoiser: &mut Option<Denoiser>, request: &Request) -> Result<Denoised, LibraryError> {
    let opened = match denoiser.take() {
        Some(opened) => opened,
        None => Denoiser::open()?,
    };
    let denoiser = denoiser.insert(opened);
    let denoised = denoiser.denoise_cancellable(&request.noisy, request.mode, &request.cancel);
    if !request.is_early {
        denoiser.release_large();
    }
    denoised
}
