//! Work beside the window whose latest request wins: plots, fits, checks.

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// How long to wait before looking whether work that is held may go on.
const HOLD_STEP: Duration = Duration::from_millis(25);

/// Answers queries on a thread of its own. A query that has not been begun when the next one comes is forgotten.
pub struct Background<Q, A> {
    shared: Arc<Shared<Q, A>>,
}

struct Shared<Q, A> {
    orders: Mutex<Orders<Q>>,
    ordered: Condvar,
    answer: Mutex<Option<A>>,
}

struct Orders<Q> {
    query: Option<Q>,
    is_busy: bool,
    quit: bool,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What the work reports to.
pub struct Desk<'a, Q, A> {
    shared: &'a Shared<Q, A>,
    repaint: &'a dyn Fn(),
}

impl<Q, A> Desk<'_, Q, A> {
    /// Shows an answer, which may be followed by a better one.
    pub fn publish(&self, answer: A) {
        *lock(&self.shared.answer) = Some(answer);
        (self.repaint)();
    }

    /// Waits while `hold` is set; false where nobody waits for the answer any more.
    pub fn may_go_on(&self, hold: &AtomicBool) -> bool {
        while hold.load(Ordering::Relaxed) && !self.is_superseded() {
            std::thread::sleep(HOLD_STEP);
        }
        !self.is_superseded()
    }

    /// Whether nobody waits for the answer any more.
    pub fn is_superseded(&self) -> bool {
        let orders = lock(&self.shared.orders);
        orders.quit || orders.query.is_some()
    }
}

impl<Q: Send + 'static, A: Clone + Send + 'static> Background<Q, A> {
    /// Starts the thread, which gives way to the window. `repaint` is called when there is something new to show.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn spawn(
        name: &str,
        repaint: impl Fn() + Send + 'static,
        mut work: impl FnMut(Q, &Desk<'_, Q, A>) + Send + 'static,
    ) -> io::Result<Self> {
        let shared = Arc::new(Shared {
            orders: Mutex::new(Orders {
                query: None,
                is_busy: false,
                quit: false,
            }),
            ordered: Condvar::new(),
            answer: Mutex::new(None),
        });
        let of_thread = shared.clone();
        std::thread::Builder::new().name(name.to_owned()).spawn(move || {
            super::priority::lower_thread_priority();
            while let Some(query) = next(&of_thread) {
                let desk = Desk {
                    shared: &of_thread,
                    repaint: &repaint,
                };
                work(query, &desk);
                repaint();
            }
        })?;
        Ok(Self { shared })
    }

    /// Asks.
    pub fn ask(&self, query: Q) {
        lock(&self.shared.orders).query = Some(query);
        self.shared.ordered.notify_one();
    }

    /// The latest answer.
    pub fn latest(&self) -> Option<A> {
        lock(&self.shared.answer).clone()
    }

    /// The first answer that is good enough, for a test to wait for.
    #[cfg(test)]
    pub fn wait_for(&self, is_enough: impl Fn(&A) -> bool) -> A {
        let begun = std::time::Instant::now();
        loop {
            if let Some(answer) = self.latest().filter(&is_enough) {
                return answer;
            }
            assert!(begun.elapsed() < Duration::from_secs(60), "no answer came");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Whether something asked for is still to come.
    pub fn is_busy(&self) -> bool {
        let orders = lock(&self.shared.orders);
        orders.is_busy || orders.query.is_some()
    }
}

impl<Q, A> Drop for Background<Q, A> {
    fn drop(&mut self) {
        lock(&self.shared.orders).quit = true;
        self.shared.ordered.notify_one();
    }
}

/// Waits for a query; `None` when it is time to go.
fn next<Q, A>(shared: &Shared<Q, A>) -> Option<Q> {
    let mut orders = lock(&shared.orders);
    orders.is_busy = false;
    loop {
        if orders.quit {
            return None;
        }
        if let Some(query) = orders.query.take() {
            orders.is_busy = true;
            return Some(query);
        }
        orders = shared.ordered.wait(orders).unwrap_or_else(PoisonError::into_inner);
    }
}
