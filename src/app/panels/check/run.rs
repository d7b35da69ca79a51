//! A run beside the window that leaves the viewport its time, and can be stopped.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use super::*;
use crate::app::kit::start_stop::{Pressed, start_or_stop};
use crate::app::kit::words::time_left;
use crate::app::services::beside::started;
use crate::render::background::Background;
use crate::render::priority::work_apart;

/// Publishes how it stands until it is done, or until the flag is set.
type Work<S> = Box<dyn FnOnce(Arc<AtomicBool>, &dyn Fn(S)) + Send>;

pub struct Run<S> {
    worker: Option<Background<Work<S>, S>>,
    stop: Arc<AtomicBool>,
    begun: Instant,
    /// It was stopped, after so much was found.
    stopped: Option<Option<S>>,
}

impl<S> Default for Run<S> {
    fn default() -> Self {
        Self {
            worker: None,
            stop: Arc::default(),
            begun: Instant::now(),
            stopped: None,
        }
    }
}

impl<S> Drop for Run<S> {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

impl<S: Clone + Send + 'static> Run<S> {
    /// The button that starts or stops it, and how it stands.
    pub fn show(&mut self, ui: &mut Ui, label: &str, work: impl FnOnce() -> Work<S>) -> Option<S> {
        let worker = started(&mut self.worker, ui.ctx(), |repaint| {
            let stop = self.stop.clone();
            Background::spawn("check", repaint, move |work: Work<S>, responder| {
                work_apart();
                work(stop.clone(), &|standing| responder.publish(standing));
            })
        });
        let Some(worker) = worker else {
            widgets::note(ui, "Cannot start a thread to check.");
            return None;
        };
        let row = ui.horizontal(|ui| start_or_stop(ui, label, worker.is_busy(), true, |button| button));
        widgets::comes_and_goes(ui, |ui| widgets::failure(ui, worker.failure()));
        let standing = worker.latest();
        match row.inner {
            Pressed::Start => {
                self.stopped = None;
                self.begun = Instant::now();
                worker.ask(work());
            }
            Pressed::Stop => {
                // It ends at once as far as the window is concerned: its thread ends at its next look, and is not waited
                // for, as a driver that compiles can't be interrupted.
                self.stop.store(true, Ordering::Relaxed);
                self.stop = Arc::default();
                self.worker = None;
                self.stopped = Some(standing.clone());
            }
            Pressed::Nothing => {}
        }
        widgets::comes_and_goes(ui, |ui| {
            if self.stopped.is_some() {
                widgets::note(ui, "Stopped.");
            }
        });
        self.stopped.clone().unwrap_or(standing)
    }

    pub fn is_stopped(&self) -> bool {
        self.stopped.is_some()
    }

    /// What is left where a share is done, with what stands before it.
    pub fn left(&self, before: &str, share: f64) -> String {
        let left = time_left(share, self.begun.elapsed().as_secs_f64());
        left.map_or_else(String::new, |left| format!("{before}{left}"))
    }
}
