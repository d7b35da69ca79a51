//! What is being done to open something, for those who wait for it: they may read it, and call it off.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};

/// Tells what is being done and hears whether it is still wanted. Clones are the same one.
#[derive(Clone, Debug, Default)]
pub struct Loading(Arc<State>);

#[derive(Debug, Default)]
struct State {
    doing: Mutex<String>,
    is_cancelled: AtomicBool,
}

/// Nobody wants it any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("opening was cancelled; what was there before stays")]
pub struct Cancelled;

impl Loading {
    /// Something else is begun: a wish to cancel from before is over.
    pub fn begin(&self) {
        self.0.is_cancelled.store(false, Relaxed);
        self.say(String::new());
    }

    /// Says what is done next.
    ///
    /// # Errors
    /// [`Cancelled`] where it is not wanted.
    pub fn step(&self, doing: impl Into<String>) -> Result<(), Cancelled> {
        self.say(doing.into());
        self.check()
    }

    /// Whether it is still wanted.
    ///
    /// # Errors
    /// [`Cancelled`] where it is not.
    pub fn check(&self) -> Result<(), Cancelled> {
        match self.0.is_cancelled.load(Relaxed) {
            true => Err(Cancelled),
            false => Ok(()),
        }
    }

    /// Calls off what is being done: it ends at its next step.
    pub fn cancel(&self) {
        self.0.is_cancelled.store(true, Relaxed);
    }

    /// What is being done; nothing where that was not said.
    pub fn doing(&self) -> String {
        self.0.doing.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn say(&self, doing: String) {
        *self.0.doing.lock().unwrap_or_else(PoisonError::into_inner) = doing;
    }
}
