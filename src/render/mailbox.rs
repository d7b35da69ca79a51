//! What threads hand to one another: contents behind a lock, and a sleep until they change.

use std::ops::ControlFlow;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crate::panics::lock;

/// Longest sleep without a change.
pub(super) const IDLE: Duration = Duration::from_secs(3600);

/// Contents that one thread waits for and others change. Where they are the latest request, it replaces the one before.
#[derive(Debug, Default)]
pub(super) struct Mailbox<T> {
    contents: Mutex<T>,
    changed: Condvar,
}

impl<T> Mailbox<T> {
    /// The contents, locked; nobody is woken.
    pub(super) fn look(&self) -> MutexGuard<'_, T> {
        lock(&self.contents)
    }

    /// Changes the contents and wakes the thread that waits for them. The lock is held meanwhile, and the thread holds it
    /// while it decides to sleep, so no change is slept through.
    pub(super) fn change<R>(&self, change: impl FnOnce(&mut T) -> R) -> R {
        let mut contents = self.look();
        self.changed.notify_all();
        change(&mut contents)
    }

    /// Sleeps until `take` breaks with what it took. It is asked at once, after each change, and once the time that it
    /// continues with has passed.
    pub(super) fn wait<R>(&self, mut take: impl FnMut(&mut T) -> ControlFlow<R, Duration>) -> R {
        let mut contents = self.look();
        loop {
            match take(&mut contents) {
                ControlFlow::Break(taken) => return taken,
                ControlFlow::Continue(time) => {
                    let woken = self.changed.wait_timeout(contents, time);
                    contents = woken.unwrap_or_else(PoisonError::into_inner).0;
                }
            }
        }
    }
}
