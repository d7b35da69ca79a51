//! Progress and cancellation of loading, and the files that it was refused.

use crate::panics::lock;
use std::{
    io,
    io::Read,
    path::Path,
    path::PathBuf,
    sync::{Arc, Mutex, atomic::AtomicBool, atomic::Ordering::Relaxed},
};

/// Progress and cancellation of one task; clones share them.
#[derive(Clone, Debug, Default)]
pub struct Loading(Arc<LoadingState>);

#[derive(Debug, Default)]
struct LoadingState {
    doing: Mutex<String>,
    is_cancelled: AtomicBool,
    /// Files that were named and not allowed, since they were last asked for.
    refused: Mutex<Vec<PathBuf>>,
}

/// Nobody wants it any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("opening was cancelled; what was there before stays")]
pub struct Cancelled;

impl Loading {
    /// Something else is begun: an earlier request to cancel is over.
    pub fn begin(&self) {
        self.0.is_cancelled.store(false, Relaxed);
        self.publish(String::new());
    }

    /// Reports the next step.
    pub fn step(&self, doing: impl Into<String>) -> Result<(), Cancelled> {
        self.publish(doing.into());
        self.check()
    }

    /// Checks for cancellation.
    pub fn check(&self) -> Result<(), Cancelled> {
        match self.0.is_cancelled.load(Relaxed) {
            true => Err(Cancelled),
            false => Ok(()),
        }
    }

    /// Cancels the task at its next step.
    pub fn cancel(&self) {
        self.0.is_cancelled.store(true, Relaxed);
    }

    /// The current step; empty if none.
    pub fn doing(&self) -> String {
        lock(&self.0.doing).clone()
    }

    /// Keeps the name of a file that was not allowed, once.
    pub fn refuse(&self, file: &Path) {
        let mut refused = lock(&self.0.refused);
        if !refused.iter().any(|known| known == file) {
            refused.push(file.to_owned());
        }
    }

    /// The files that were refused since this was last asked: of these loads alone, not of others beside them.
    pub fn take_refused(&self) -> Vec<PathBuf> {
        std::mem::take(&mut lock(&self.0.refused))
    }

    /// The items until cancelled: for long loops whose result is discarded then.
    pub fn while_wanted<I: Iterator>(&self, items: I) -> impl Iterator<Item = I::Item> {
        const BETWEEN: usize = 1 << 12;
        items
            .enumerate()
            .take_while(|(place, _)| place % BETWEEN != 0 || self.check().is_ok())
            .map(|(_, item)| item)
    }

    /// The source, failing once cancelled: it ends long reads and parsers.
    pub fn watched<R: Read>(&self, source: R) -> Watched<'_, R> {
        let loading = self;
        Watched { loading, source }
    }

    fn publish(&self, doing: String) {
        *lock(&self.0.doing) = doing;
    }
}

/// A source that fails once cancelled.
pub struct Watched<'a, R> {
    loading: &'a Loading,
    source: R,
}

impl<R: Read> Read for Watched<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.loading.check().map_err(io::Error::other)?;
        self.source.read(buffer)
    }
}
