//! Words for people, and answers on standard output: the only place that prints.
//!
//! Words never decide what becomes of an image. Where nobody listens any more, or the disk that they go to is full, the
//! work goes on; [`finish`] reports at the end.

use std::fmt;
use std::io::{self, ErrorKind, Write as _};
use std::sync::{Mutex, PoisonError};

/// What became of standard output, where it failed.
static FAILED: Mutex<Option<io::Error>> = Mutex::new(None);

/// Says a line on standard error; where that is closed or full it is lost.
macro_rules! say {
    ($($words:tt)*) => {
        $crate::say::line(format_args!($($words)*))
    };
}

/// Prints a line on standard output.
macro_rules! put {
    ($($words:tt)*) => {
        $crate::say::print(format_args!("{}\n", format_args!($($words)*)))
    };
}

pub(crate) use {put, say};

/// Says a line on standard error; where that is closed or full it is lost.
pub fn line(words: fmt::Arguments<'_>) {
    // In one piece: several programs may write to the same place.
    let _ = io::stderr().write_all(format!("{words}\n").as_bytes());
}

/// Prints on standard output. What can't be printed is lost, and reported by [`finish`].
pub(crate) fn print(words: fmt::Arguments<'_>) {
    print_bytes(words.to_string().as_bytes());
}

/// Prints bytes on standard output, at once.
pub(crate) fn print_bytes(bytes: &[u8]) {
    let mut failed = FAILED.lock().unwrap_or_else(PoisonError::into_inner);
    if failed.is_none() {
        let mut output = io::stdout().lock();
        *failed = output.write_all(bytes).and_then(|()| output.flush()).err();
    }
}

/// How printing went, asked when the work is done. That the reader had enough is no error.
///
/// # Errors
/// What the system said, such as that a disk is full.
pub fn finish() -> io::Result<()> {
    match FAILED.lock().unwrap_or_else(PoisonError::into_inner).take() {
        Some(error) if error.kind() != ErrorKind::BrokenPipe => Err(error),
        _ => Ok(()),
    }
}
