//! Messages on standard error and answers on standard output: the only place that prints.
//!
//! Printing never decides what becomes of an image. If a stream is closed, or its disk full, the work goes on; [`finish`]
//! reports it at the end.

use crate::panics::lock;
use std::{fmt, io, io::ErrorKind, io::Write as _, sync::Mutex};

/// What became of standard output, where it failed.
static FAILED: Mutex<Option<io::Error>> = Mutex::new(None);

/// Prints a line on standard error; if that is closed or full, the line is lost.
macro_rules! message {
    ($($words:tt)*) => {
        $crate::console::message_line(format_args!($($words)*))
    };
}

/// Prints a line on standard output.
macro_rules! output {
    ($($words:tt)*) => {
        $crate::console::print(format_args!("{}\n", format_args!($($words)*)))
    };
}

pub(crate) use {message, output};

/// Prints a line on standard error; if that is closed or full, the line is lost.
pub fn message_line(words: fmt::Arguments<'_>) {
    // In one piece: several programs may write to the same place.
    let _ = io::stderr().write_all(format!("{words}\n").as_bytes());
}

/// Prints on standard output. What can't be printed is lost, and reported by [`finish`].
pub(crate) fn print(words: fmt::Arguments<'_>) {
    print_bytes(words.to_string().as_bytes());
}

/// Prints bytes on standard output, at once.
pub(crate) fn print_bytes(bytes: &[u8]) {
    let mut failed = lock(&FAILED);
    if failed.is_none() {
        let mut output = io::stdout().lock();
        *failed = output.write_all(bytes).and_then(|()| output.flush()).err();
    }
}

/// How printing went, asked when the work is done. That the reader had enough is no error.
pub fn finish() -> io::Result<()> {
    match lock(&FAILED).take() {
        Some(error) if error.kind() != ErrorKind::BrokenPipe => Err(error),
        _ => Ok(()),
    }
}
