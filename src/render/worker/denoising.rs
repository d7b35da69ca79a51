//! The denoiser's thread behind the worker's: takes what has been rendered, the latest wins, and gives pictures back.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Condvar, Mutex};

use super::lock;
use crate::document::{Denoise, DenoiseWhen, Document};
use crate::panics::caught;
use crate::render::denoise::{Denoised, Denoiser, LibraryError, Noisy};
use crate::render::progress::Progress;
use crate::render::quiet::at_work;

/// By how much samples grow from one denoised picture to the next.
const GROWTH: u32 = 2;
/// Age of a picture, in seconds of rendering, up to which denoising may take all the time that it likes, and its share from
/// then on.
const YOUNG_S: f64 = 1.0;
const SHARE: f64 = 0.2;

/// A picture to be denoised.
struct Request {
    noisy: Noisy,
    how: Denoise,
    stage: u64,
    samples_per_pixel: u32,
    /// Its time does not count against the share.
    is_early: bool,
    /// Becomes true once the picture is no longer wanted.
    stops: Arc<AtomicBool>,
}

/// What came of it.
pub(super) struct Outcome {
    /// The picture, or why there is none.
    pub(super) denoised: Result<Denoised, String>,
    /// The samples that it was made of.
    pub(super) noisy: Noisy,
    /// How many a pixel.
    pub(super) samples_per_pixel: u32,
    stage: u64,
    is_early: bool,
}

#[derive(Default)]
struct Desk {
    request: Option<Request>,
    outcome: Option<Outcome>,
    quits: bool,
}

/// Denoises beside the worker, which asks for pictures and collects them.
pub(super) struct Denoising {
    desk: Arc<(Mutex<Desk>, Condvar)>,
    /// Counts the pictures begun: requests for earlier ones are no longer wanted.
    stage: u64,
    /// Samples of the picture that was asked for last, of those that are not back yet.
    pending_samples: Option<u32>,
    /// Samples of the latest picture that was asked for in this stage; 0 before the first.
    asked_samples: u32,
    /// Gives up what was asked for in this stage.
    stops: Arc<AtomicBool>,
    /// What the stage's pictures took that were asked for after [`YOUNG_S`], seconds.
    late_seconds: f64,
    /// What the latest took, seconds.
    latest_seconds: f64,
    /// Why nothing can be denoised.
    failure: Option<String>,
}

impl Denoising {
    /// Starts the thread; `wake` is called when there is something to collect.
    pub(super) fn spawn(wake: impl Fn() + Send + 'static) -> Self {
        let desk = Arc::new((Mutex::new(Desk::default()), Condvar::new()));
        let of_thread = desk.clone();
        let thread = std::thread::Builder::new().name("denoise".to_owned());
        let spawned = thread.spawn(move || work(&of_thread, &wake));
        Self {
            desk,
            stage: 0,
            pending_samples: None,
            asked_samples: 0,
            stops: Arc::default(),
            late_seconds: 0.0,
            latest_seconds: 0.0,
            failure: spawned.err().map(|error| error.to_string()),
        }
    }

    /// Another picture is begun: what is under way is of the one before, and given up.
    pub(super) fn begin(&mut self) {
        self.stage += 1;
        std::mem::take(&mut self.stops).store(true, Relaxed);
        self.pending_samples = None;
        self.asked_samples = 0;
        self.late_seconds = 0.0;
        lock(&self.desk.0).request = None;
    }

    /// Whether pictures of this document are shown denoised at this point of their render.
    pub(super) fn shows(&self, document: &Document, progress: &Progress) -> bool {
        let is_time = document.view.denoise_when == DenoiseWhen::Rendering || progress.is_done;
        document.view.denoise != Denoise::Off && self.failure.is_none() && is_time
    }

    /// Whether a denoised picture may cost what it likes: of a young render, and the first of two halves, by which alone it
    /// can be told how wrong it is.
    fn is_early(&self, progress: &Progress) -> bool {
        progress.render_seconds < YOUNG_S || self.asked_samples < 2
    }

    /// Whether a denoised picture is due: the first, then at twice the samples of the one before as long as that takes no
    /// more than its share of the time, and the last.
    pub(super) fn is_due(&self, progress: &Progress) -> bool {
        let samples = progress.samples_per_pixel;
        if samples <= self.asked_samples {
            return false;
        }
        let spent_and_next = self.late_seconds + self.latest_seconds;
        let is_cheap = self.is_early(progress) || spent_and_next <= SHARE * (progress.render_seconds - YOUNG_S);
        let is_free = self.pending_samples.is_none();
        progress.is_done || self.asked_samples == 0 || (is_free && is_cheap && samples >= GROWTH * self.asked_samples)
    }

    /// Whether a picture is under way.
    pub(super) fn is_pending(&self) -> bool {
        self.pending_samples.is_some()
    }

    /// Whether there is something to collect.
    pub(super) fn has_news(&self) -> bool {
        lock(&self.desk.0).outcome.is_some()
    }

    /// Asks for a denoised picture, instead of any that is waiting.
    pub(super) fn ask(&mut self, noisy: Noisy, how: Denoise, progress: &Progress) {
        let samples_per_pixel = progress.samples_per_pixel;
        let is_early = self.is_early(progress);
        self.pending_samples = Some(samples_per_pixel);
        self.asked_samples = samples_per_pixel;
        lock(&self.desk.0).request = Some(Request {
            noisy,
            how,
            stage: self.stage,
            samples_per_pixel,
            is_early,
            stops: self.stops.clone(),
        });
        self.desk.1.notify_one();
    }

    /// The latest picture, where one of what is being rendered has been made. After a failure nothing is denoised any
    /// more.
    pub(super) fn collect(&mut self) -> Option<Outcome> {
        let outcome = lock(&self.desk.0).outcome.take()?;
        if let Err(why) = &outcome.denoised {
            self.failure = Some(why.clone());
        }
        if outcome.stage != self.stage {
            return None;
        }
        if self.pending_samples == Some(outcome.samples_per_pixel) {
            self.pending_samples = None;
        }
        if let Ok(denoised) = &outcome.denoised {
            self.latest_seconds = denoised.seconds;
            if !outcome.is_early {
                self.late_seconds += denoised.seconds;
            }
        }
        Some(outcome)
    }
}

impl Drop for Denoising {
    /// Tells the thread to end; it is not waited for, as it may be in the middle of a picture.
    fn drop(&mut self) {
        self.stops.store(true, Relaxed);
        lock(&self.desk.0).quits = true;
        self.desk.1.notify_one();
    }
}

/// The thread's body.
fn work((desk, asked): &(Mutex<Desk>, Condvar), wake: &dyn Fn()) {
    let mut denoiser = None;
    loop {
        let mut desk_now = lock(desk);
        let request = loop {
            if desk_now.quits {
                return;
            }
            match desk_now.request.take() {
                Some(request) => break request,
                None => {
                    desk_now = asked.wait(desk_now).unwrap_or_else(std::sync::PoisonError::into_inner);
                }
            }
        };
        drop(desk_now);
        let _at_work = at_work();
        let denoised = match caught(|| denoise(&mut denoiser, &request)) {
            Ok(Err(LibraryError::Stopped)) => continue,
            Ok(done) => done.map_err(|error| error.to_string()),
            Err(panic) => Err(panic),
        };
        lock(desk).outcome = Some(Outcome {
            denoised,
            noisy: request.noisy,
            samples_per_pixel: request.samples_per_pixel,
            stage: request.stage,
            is_early: request.is_early,
        });
        wake();
    }
}

fn denoise(denoiser: &mut Option<Denoiser>, request: &Request) -> Result<Denoised, LibraryError> {
    let opened = match denoiser.take() {
        Some(opened) => opened,
        None => Denoiser::open()?,
    };
    let denoiser = denoiser.insert(opened);
    denoiser.denoise_unless(&request.noisy, request.how, &request.stops)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn progress(samples_per_pixel: u32, render_seconds: f64) -> Progress {
        Progress {
            samples_per_pixel,
            render_seconds,
            ..Progress::default()
        }
    }

    /// By the first picture of two halves alone it can be told how wrong it is: it comes whatever it costs. Those after it
    /// keep to their share of the time.
    #[test]
    fn the_first_picture_of_two_halves_is_due_whatever_it_costs() {
        let mut denoising = Denoising::spawn(|| {});
        assert!(denoising.is_due(&progress(1, 20.0)), "the first");
        denoising.asked_samples = 1;
        denoising.pending_samples = Some(1);
        assert!(!denoising.is_due(&progress(2, 20.0)), "one at a time");
        denoising.pending_samples = None;
        denoising.latest_seconds = 100.0;
        assert!(denoising.is_due(&progress(2, 20.0)), "the first of two halves");
        denoising.asked_samples = 2;
        assert!(
            !denoising.is_due(&progress(4, 500.0)),
            "100 s are more than a fifth of 499 s"
        );
        assert!(denoising.is_due(&progress(4, 502.0)));
        denoising.late_seconds = 100.0;
        assert!(!denoising.is_due(&progress(4, 502.0)), "another has been made");
        assert!(denoising.is_due(&progress(4, 1002.0)));
        assert!(!denoising.is_due(&progress(3, 1002.0)), "too little has come");
        let last = Progress {
            is_done: true,
            ..progress(3, 2.0)
        };
        assert!(denoising.is_due(&last), "the last");
    }
}
