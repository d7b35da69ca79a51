//! Panics that are caught: what they said, and which of them are known and no news.

use std::any::Any;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, MutexGuard, PoisonError};

thread_local! {
    static IS_CONTAINED: Cell<bool> = const { Cell::new(false) };
}

/// Locks, after a panic too: what stands behind our locks is whole at any time, as each write is an assignment or a push.
pub fn lock<T: ?Sized>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Runs work that should not panic; where it does, what the panic said.
///
/// # Errors
/// The panic's message.
pub fn caught<R>(work: impl FnOnce() -> R) -> Result<R, String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| message(&*panic))
}

/// Runs a library's code that gives up by a panic on some inputs: `None` then. Such a panic is not reported.
pub fn contained<R>(work: impl FnOnce() -> R) -> Option<R> {
    let was_contained = IS_CONTAINED.replace(true);
    let result = catch_unwind(AssertUnwindSafe(work));
    IS_CONTAINED.set(was_contained);
    result.ok()
}

/// Whether a panic of this thread would be one that [`contained`] expects.
pub fn is_contained() -> bool {
    IS_CONTAINED.get()
}

/// What a panic said.
pub fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "for an unknown reason".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panics_are_caught_with_their_message_and_contained_ones_are_known() {
        assert_eq!(caught(|| 3), Ok(3));
        let why = caught(|| -> u32 { panic!("number {} on purpose", 7) });
        assert_eq!(why, Err("number 7 on purpose".to_owned()));
        let mut was_known = false;
        let gave_up = contained(|| {
            was_known = is_contained();
            panic!("on purpose");
        });
        assert!(gave_up.is_none() && was_known && !is_contained());
    }
}
