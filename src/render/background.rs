//! Work beside the window whose latest request wins: plots, fits, checks.

use std::{
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed},
        mpsc::{Sender, channel},
    },
    time::Duration,
};

use crate::panics::{caught, lock};

/// Interval at which held work checks whether to continue.
const HOLD_STEP: Duration = Duration::from_millis(25);

/// Answers queries on a thread of its own. A query that has not been started is replaced by the next one.
pub struct Background<Q, A> {
    queries: Sender<(usize, Q)>,
    shared: Arc<Shared<A>>,
}

struct Shared<A> {
    /// Numbers of the latest query, and of the latest that the thread is done with.
    asked: AtomicUsize,
    done: AtomicUsize,
    answer: Mutex<Option<A>>,
    failure: Mutex<Option<String>>,
}

/// Handle through which the work on a query reports.
pub struct Responder<'a, A> {
    shared: &'a Shared<A>,
    query: usize,
    repaint: &'a dyn Fn(),
}

impl<A> Responder<'_, A> {
    /// Shows an answer, which may be followed by a better one.
    pub fn publish(&self, answer: A) {
        *lock(&self.shared.answer) = Some(answer);
        (self.repaint)();
    }

    /// Waits while `hold` is set. Returns false once superseded.
    pub fn wait_while_held(&self, hold: &AtomicBool) -> bool {
        while hold.load(Relaxed) && !self.is_superseded() {
            std::thread::sleep(HOLD_STEP);
        }
        !self.is_superseded()
    }

    /// Whether there is a newer query, or nobody who waits for an answer.
    pub fn is_superseded(&self) -> bool {
        self.shared.asked.load(Relaxed) != self.query
    }
}

impl<Q: Send + 'static, A: Send + 'static> Background<Q, A> {
    /// Starts the thread, which gives way to the window. `repaint` is called when there is something new to show.
    pub fn spawn(
        name: &str,
        repaint: impl Fn() + Send + 'static,
        mut work: impl FnMut(Q, &Responder<'_, A>) + Send + 'static,
    ) -> Self {
        let (queries, asked) = channel();
        let shared = Arc::new(Shared {
            asked: AtomicUsize::new(0),
            done: AtomicUsize::new(0),
            answer: Mutex::default(),
            failure: Mutex::default(),
        });
        let of_thread = shared.clone();
        let spawned = std::thread::Builder::new().name(name.to_owned()).spawn(move || {
            super::priority::lower_thread_priority();
            for (number, query) in asked {
                let responder = Responder {
                    shared: &of_thread,
                    query: number,
                    repaint: &repaint,
                };
                if responder.is_superseded() {
                    continue;
                }
                *lock(&of_thread.failure) = None;
                if let Err(why) = caught(|| work(query, &responder)) {
                    *lock(&of_thread.failure) = Some(format!("an internal error: {why}"));
                }
                // Free again before the window looks.
                of_thread.done.store(number, Relaxed);
                repaint();
            }
        });
        *lock(&shared.failure) = spawned.err().map(|error| format!("cannot start a thread: {error}"));
        Self { queries, shared }
    }

    pub fn ask(&self, query: Q) {
        let number = self.shared.asked.fetch_add(1, Relaxed) + 1;
        if self.queries.send((number, query)).is_err() {
            // There is no thread, which the failure says.
            self.shared.done.store(number, Relaxed);
        }
    }

    pub fn latest(&self) -> Option<A>
    where
        A: Clone,
    {
        lock(&self.shared.answer).clone()
    }

    /// Whether there is an answer.
    pub fn has_answer(&self) -> bool {
        lock(&self.shared.answer).is_some()
    }

    /// The latest answer, taken away.
    pub fn take(&self) -> Option<A> {
        lock(&self.shared.answer).take()
    }

    /// The panic's message of the latest query, if the work panicked; the thread continues.
    pub fn failure(&self) -> Option<String> {
        lock(&self.shared.failure).clone()
    }

    /// Whether something asked for is still to come.
    pub fn is_busy(&self) -> bool {
        self.shared.done.load(Relaxed) != self.shared.asked.load(Relaxed)
    }
}

impl<Q, A> Drop for Background<Q, A> {
    /// Supersedes what is under way; the thread ends after it.
    fn drop(&mut self) {
        self.shared.asked.fetch_add(1, Relaxed);
    }
}
