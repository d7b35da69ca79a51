//! Signals that ask a render to end: SIGINT, SIGTERM and, on Unix, SIGHUP. At the first one it ends with what there is; a
//! second one ends the program at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};

use signal_hook::{consts::SIGINT, consts::SIGTERM, flag};

/// The signals, with their names.
const SIGNALS: &[(i32, &str)] = &[
    (SIGINT, "SIGINT"),
    (SIGTERM, "SIGTERM"),
    #[cfg(unix)]
    (signal_hook::consts::SIGHUP, "SIGHUP"),
];

/// A render that ended because a signal asked for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("ended early by {name}")]
pub struct EndedBySignal {
    number: i32,
    name: &'static str,
}

impl EndedBySignal {
    /// The exit code that a shell gives a program which the signal ended: 130 for SIGINT, 143 for SIGTERM, 129 for SIGHUP.
    pub fn exit_code(self) -> u8 {
        128 + self.number as u8
    }
}

/// A watch for signals, from when it is begun until the program ends. Until then they end the program as usual.
pub struct Signals(Arc<AtomicUsize>);

impl Signals {
    /// Begins to watch. A signal that the caller has the program ignore, as `nohup` does, stays ignored.
    ///
    /// # Errors
    /// Where the system refuses.
    pub fn watch() -> std::io::Result<Self> {
        let (latest, is_second) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicBool::new(false)));
        for (number, _) in SIGNALS.iter().filter(|(number, _)| !is_ignored(*number)) {
            // In this order: the first signal finds the flag down, and raises it.
            flag::register_conditional_shutdown(*number, 128 + number, is_second.clone())?;
            flag::register(*number, is_second.clone())?;
            flag::register_usize(*number, latest.clone(), *number as usize)?;
        }
        Ok(Self(latest))
    }

    /// What asked the render to end, if anything did.
    pub fn received(&self) -> Option<EndedBySignal> {
        let latest = self.0.load(Relaxed);
        let mut signals = SIGNALS.iter();
        signals
            .find(|(number, _)| *number as usize == latest)
            .map(|(number, name)| EndedBySignal { number: *number, name })
    }
}

#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let mut action = std::mem::MaybeUninit::<libc::sigaction>::uninit();
    // SAFETY: without a new action the call only writes the one in force, which is read where it succeeded.
    unsafe {
        libc::sigaction(signal, std::ptr::null(), action.as_mut_ptr()) == 0
            && action.assume_init().sa_sigaction == libc::SIG_IGN
    }
}

#[cfg(not(unix))]
fn is_ignored(_signal: i32) -> bool {
    false
}
