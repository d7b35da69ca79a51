//! Whether this process is busy: engines are only measured while nothing else of ours uses the CPU.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

/// Work of this process.
static COMMON: Quiet = Quiet::new();

/// Work that is under way, counted.
#[derive(Debug, Default)]
pub struct Quiet {
    at_work: AtomicUsize,
    /// Number of times that work started.
    begun: AtomicU64,
}

/// Work that is under way until this is dropped.
#[derive(Debug)]
pub struct AtWork<'a>(&'a Quiet);

/// Marks this process as busy until the guard is dropped.
pub fn at_work() -> AtWork<'static> {
    COMMON.work()
}

/// The count of this process.
pub(super) fn common() -> &'static Quiet {
    &COMMON
}

impl Quiet {
    /// Idle.
    pub const fn new() -> Self {
        Self {
            at_work: AtomicUsize::new(0),
            begun: AtomicU64::new(0),
        }
    }

    /// Marks it as busy until the guard is dropped.
    pub fn work(&self) -> AtWork<'_> {
        self.begun.fetch_add(1, Ordering::SeqCst);
        self.at_work.fetch_add(1, Ordering::SeqCst);
        AtWork(self)
    }

    /// The number of the current idle period, which changes whenever work begins; `None` while work is in progress.
    pub fn span(&self) -> Option<u64> {
        let begun = self.begun.load(Ordering::SeqCst);
        (self.at_work.load(Ordering::SeqCst) == 0).then_some(begun)
    }
}

impl Drop for AtWork<'_> {
    fn drop(&mut self) {
        self.0.at_work.fetch_sub(1, Ordering::SeqCst);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quiet_time_ends_with_work_and_another_begins_after_it() {
        let quiet = Quiet::new();
        let first = quiet.span().expect("nothing is at work");
        let outer = quiet.work();
        drop(quiet.work());
        assert_eq!(quiet.span(), None, "the outer work goes on");
        drop(outer);
        assert!(quiet.span().is_some_and(|span| span != first));
    }
}
