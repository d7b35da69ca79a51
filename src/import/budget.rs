//! Memory budget of one import: files, archives and images together.

use std::io::{self, ErrorKind};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use crate::free_memory::{LIMIT_VARIABLE, of_import};

/// Bytes used and allowed of one import; clones share them.
#[derive(Clone, Debug)]
pub struct Budget(Arc<State>);

#[derive(Debug)]
struct State {
    allowed: u64,
    taken: AtomicU64,
}

/// An import exceeds its budget.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "it takes {} MiB, and {} are left of the {} MiB that everything of one import may take; make it smaller or leave others \
     out, or allow more by {LIMIT_VARIABLE}=MIB",
    needed.div_ceil(1 << 20), left >> 20, allowed >> 20
)]
pub struct OverBudget {
    needed: u64,
    left: u64,
    allowed: u64,
}

impl From<OverBudget> for io::Error {
    fn from(over: OverBudget) -> Self {
        Self::new(ErrorKind::FileTooLarge, over)
    }
}

impl Budget {
    /// A budget of `allowed` bytes, unused.
    pub fn new(allowed: u64) -> Self {
        let taken = AtomicU64::new(0);
        Self(Arc::new(State { allowed, taken }))
    }

    /// The budget of an import that begins now: what the user allows, or a share of the free memory.
    pub fn of_import() -> Self {
        Self::new(of_import())
    }

    /// The bytes that are left.
    pub fn left(&self) -> u64 {
        self.0.allowed.saturating_sub(self.0.taken.load(Relaxed))
    }

    /// Checks that `needed` bytes are left, for temporary use.
    pub fn check(&self, needed: u64) -> Result<(), OverBudget> {
        let (left, allowed) = (self.left(), self.0.allowed);
        let over = OverBudget { needed, left, allowed };
        if needed <= left { Ok(()) } else { Err(over) }
    }

    /// Takes `needed` bytes permanently. Called in the order of the files and images, whichever is read first: what is left
    /// out must not depend on timing.
    ///
    /// # Errors
    ///
    /// [`OverBudget`]; nothing is taken then.
    pub fn take(&self, needed: u64) -> Result<(), OverBudget> {
        self.check(needed)?;
        self.0.taken.fetch_add(needed, Relaxed);
        Ok(())
    }
}
