//! Resolutions of a submission: first a reduced one that is fast, then in steps up to the full one.

use std::{sync::Arc, time::Duration, time::Instant};

use super::{Pace, Submission};
use crate::document::Document;

/// Divisors between the first image and the full resolution, each left out unless the next takes so long that waiting is
/// felt.
const STEPS: [u32; 2] = [4, 2];
const STEP_FELT: Duration = Duration::from_millis(400);
/// Time from the last change to the full resolution.
const SETTLE: Duration = Duration::from_millis(150);
/// Estimated time of a first sample below which no reduced image is needed. Set-up and the single sample delay the image to
/// two to three times the estimate.
const FIRST_IMAGE_TARGET: Duration = Duration::from_millis(20);
/// Time after which an unfinished image of a moving view gives way to the next.
const STALE: Duration = Duration::from_millis(250);
/// Divisors of width and height.
const REDUCTIONS: [u32; 6] = [1, 2, 3, 4, 6, 8];
/// Assumed speed of an unmeasured engine, in pixel samples per second.
const FIRST_GUESS: f64 = 5e5;
/// Assumed share of the measured speed in another kernel, because compiling takes part of the CPU and paths may be longer.
const UNKNOWN_KERNEL: f64 = 0.3;
/// Images with a smaller side are not reduced further: nothing could be recognised.
const SIDE_MIN_PX: u32 = 96;

/// A submission being shown: first at a reduced resolution, in the end in full.
#[derive(Clone, Debug)]
pub struct Stage {
    pub submission: Submission,
    /// When it was taken.
    taken_at: Instant,
    /// Divisor of width and height.
    pub reduction: u32,
    /// True once an image has been published.
    pub is_shown: bool,
    /// True once one of this resolution has.
    pub is_seen: bool,
    /// True if the full resolution failed: the reduced one stays.
    pub is_final: bool,
}

impl Stage {
    /// The first stage of a submission for an engine of a given speed in pixel samples per second; 0 is unknown.
    pub fn first(submission: Submission, samples_per_second: f64) -> Self {
        let render = &submission.document.render;
        let most = REDUCTIONS
            .into_iter()
            .take_while(|n| *n == 1 || render.width.min(render.height) / n >= SIDE_MIN_PX);
        let is_quick = |n: u32| first_sample(&submission, n, samples_per_second) <= FIRST_IMAGE_TARGET;
        let mut reduction = 1;
        for candidate in most {
            reduction = candidate;
            if is_quick(candidate) {
                break;
            }
        }
        Self {
            submission,
            taken_at: Instant::now(),
            reduction,
            is_shown: false,
            is_seen: false,
            is_final: false,
        }
    }

    /// The next stage of the same submission: as large as is there without a wait that is felt.
    pub fn next(&self, samples_per_second: f64) -> Self {
        let is_slow = |n: u32| first_sample(&self.submission, n, samples_per_second) > STEP_FELT;
        let steps = STEPS.into_iter().filter(|n| *n < self.reduction);
        Self {
            reduction: steps.into_iter().find(|n| is_slow(n / 2)).unwrap_or(1),
            is_seen: false,
            ..self.clone()
        }
    }

    /// The same for a kernel without a measured speed.
    pub fn cautious(submission: Submission, samples_per_second: f64) -> Self {
        Self::first(submission, UNKNOWN_KERNEL * samples_per_second)
    }

    /// The document at the stage's resolution.
    pub fn document(&self) -> Arc<Document> {
        if self.reduction == 1 {
            return self.submission.document.clone();
        }
        let mut document = Document::clone(&self.submission.document);
        document.render.width = document.render.width.div_ceil(self.reduction);
        document.render.height = document.render.height.div_ceil(self.reduction);
        Arc::new(document)
    }

    /// Whether the next resolution is due: at once after the image, or after a pause if more changes are expected.
    pub fn is_settled(&self) -> bool {
        let is_still = self.submission.pace == Pace::Still;
        self.may_settle() && (is_still || self.submission.at.elapsed() >= SETTLE)
    }

    fn may_settle(&self) -> bool {
        self.reduction > 1 && self.is_seen && !self.is_final
    }

    /// Whether another submission may replace this one. A moving one is shown first: otherwise a steady stream of changes
    /// would never show anything.
    pub fn may_be_replaced(&self) -> bool {
        self.is_shown || self.submission.pace == Pace::Still || self.taken_at.elapsed() >= STALE
    }

    /// Time until it may settle or be replaced.
    pub fn wait_left(&self) -> Duration {
        let rest = self
            .may_settle()
            .then(|| SETTLE.saturating_sub(self.submission.at.elapsed()));
        let until_stale = (!self.may_be_replaced()).then(|| STALE.saturating_sub(self.taken_at.elapsed()));
        rest.into_iter().chain(until_stale).min().unwrap_or(Duration::MAX)
    }
}

/// Estimated time of a sample of every pixel at a reduction, at a speed in pixel samples per second; 0 is unknown.
fn first_sample(submission: &Submission, reduction: u32, samples_per_second: f64) -> Duration {
    let speed = if samples_per_second > 0.0 {
        samples_per_second
    } else {
        FIRST_GUESS
    };
    Duration::from_secs_f64(pixels(submission, reduction) / speed)
}

/// Pixels of a submission's image at a reduction.
pub fn pixels(submission: &Submission, reduction: u32) -> f64 {
    let render = &submission.document.render;
    f64::from(render.width) * f64::from(render.height) / f64::from(reduction * reduction)
}
