//! Work beside the window whose latest request wins: plots, fits, checks.

use std::io;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use super::mailbox::{IDLE, Mailbox};
use crate::panics::{caught, lock};

/// Interval at which held work checks whether to continue.
const HOLD_STEP: Duration = Duration::from_millis(25);

/// Answers queries on a thread of its own. A query that has not been started is replaced by the next one.
pub struct Background<Q, A> {
    shared: Arc<Shared<Q, A>>,
}

struct Shared<Q, A> {
    orders: Mailbox<Orders<Q>>,
    answer: Mutex<Option<A>>,
    failure: Mutex<Option<String>>,
}

struct Orders<Q> {
    query: Option<Q>,
    is_busy: bool,
    quit: bool,
}

impl<Q> Default for Orders<Q> {
    fn default() -> Self {
        Self {
            query: None,
            is_busy: false,
            quit: false,
        }
    }
}

/// Handle through which the work reports.
pub struct Responder<'a, Q, A> {
    shared: &'a Shared<Q, A>,
    repaint: &'a dyn Fn(),
}

impl<Q, A> Responder<'_, Q, A> {
    /// Shows an answer, which may be followed by a better one.
    pub fn publish(&self, answer: A) {
        *lock(&self.shared.answer) = Some(answer);
        (self.repaint)();
    }

    /// Waits while `hold` is set. Returns false once superseded.
    pub fn wait_while_held(&self, hold: &AtomicBool) -> bool {
        while hold.load(Ordering::Relaxed) && !self.is_superseded() {
            std::thread::sleep(HOLD_STEP);
        }
        !self.is_superseded()
    }

    /// Whether a newer query has superseded this one.
    pub fn is_superseded(&self) -> bool {
        let orders = self.shared.orders.look();
        orders.quit || orders.query.is_some()
    }
}

impl<Q: Send + 'static, A: Send + 'static> Background<Q, A> {
    /// Starts the thread, which gives way to the window. `repaint` is called when there is something new to show.
    pub fn spawn(
        name: &str,
        repaint: impl Fn() + Send + 'static,
        mut work: impl FnMut(Q, &Responder<'_, Q, A>) + Send + 'static,
    ) -> io::Result<Self> {
        let shared = Arc::new(Shared {
            orders: Mailbox::default(),
            answer: Mutex::default(),
            failure: Mutex::default(),
        });
        let of_thread = shared.clone();
        std::thread::Builder::new().name(name.to_owned()).spawn(move || {
            super::priority::lower_thread_priority();
            while let Some(query) = next(&of_thread) {
                let responder = Responder {
                    shared: &of_thread,
                    repaint: &repaint,
                };
                *lock(&of_thread.failure) = None;
                if let Err(why) = caught(|| work(query, &responder)) {
                    *lock(&of_thread.failure) = Some(format!("an internal error: {why}"));
                }
                // Free again before the window looks.
                of_thread.orders.look().is_busy = false;
                repaint();
            }
        })?;
        Ok(Self { shared })
    }

    pub fn ask(&self, query: Q) {
        self.shared.orders.change(|orders| orders.query = Some(query));
    }

    /// Withdraws a query that has not been started.
    pub(super) fn withdraw(&self) {
        self.shared.orders.look().query = None;
    }

    pub fn latest(&self) -> Option<A>
    where
        A: Clone,
    {
        lock(&self.shared.answer).clone()
    }

    /// Whether there is an answer.
    pub(super) fn has_answer(&self) -> bool {
        lock(&self.shared.answer).is_some()
    }

    /// The latest answer, taken away.
    pub(super) fn take(&self) -> Option<A> {
        lock(&self.shared.answer).take()
    }

    /// The panic's message of the latest query, if the work panicked; the thread continues.
    pub fn failure(&self) -> Option<String> {
        lock(&self.shared.failure).clone()
    }

    /// Whether something asked for is still to come.
    pub fn is_busy(&self) -> bool {
        let orders = self.shared.orders.look();
        orders.is_busy || orders.query.is_some()
    }
}

impl<Q, A> Drop for Background<Q, A> {
    fn drop(&mut self) {
        self.shared.orders.change(|orders| orders.quit = true);
    }
}

/// Waits for a query; `None` when it is time to go.
fn next<Q, A>(shared: &Shared<Q, A>) -> Option<Q> {
    shared.orders.wait(|orders| match orders.query.take() {
        _ if orders.quit => ControlFlow::Break(None),
        None => ControlFlow::Continue(IDLE),
        query => {
            orders.is_busy = true;
            ControlFlow::Break(query)
        }
    })
}
