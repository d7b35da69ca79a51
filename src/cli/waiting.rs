//! What is being loaded, shown on a terminal while one waits.

use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::scene::Loading;

/// From one look at what is being done to the next.
const INTERVAL: Duration = Duration::from_millis(100);

/// A line that shows what is being loaded, until this value is dropped. Nothing where stderr is no terminal.
pub(super) struct Waiting {
    is_over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Waiting {
    /// Begins to report.
    pub(super) fn on(loading: &Loading) -> Self {
        let is_over = Arc::new(AtomicBool::new(false));
        let (loading, its_end) = (loading.clone(), is_over.clone());
        let report = move || {
            let style =
                ProgressStyle::with_template("{spinner} {msg}").unwrap_or_else(|_| ProgressStyle::default_bar());
            let line = ProgressBar::new_spinner().with_style(style);
            while !its_end.load(Relaxed) {
                line.set_message(loading.doing());
                line.tick();
                std::thread::sleep(INTERVAL);
            }
            line.finish_and_clear();
        };
        let is_seen = std::io::stderr().is_terminal();
        let thread = is_seen.then(|| std::thread::Builder::new().name("waiting".to_owned()).spawn(report));
        Self {
            is_over,
            // Without a thread nothing is reported.
            thread: thread.and_then(Result::ok),
        }
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        self.is_over.store(true, Relaxed);
        if let Some(thread) = self.thread.take() {
            // It has nothing to give back.
            let _ = thread.join();
        }
    }
}
