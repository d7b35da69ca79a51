//! Where a command's answer goes: a file, or standard output for the program that called.

use std::convert::Infallible;
use std::io::Write as _;
use std::path::PathBuf;
use std::str::FromStr;

use anyhow::Context;
use serde::Serialize;

/// Where an answer goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Destination {
    /// Standard output, written `-`.
    Output,
    /// A file.
    File(PathBuf),
}

impl FromStr for Destination {
    type Err = Infallible;
    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(if text == "-" {
            Self::Output
        } else {
            Self::File(PathBuf::from(text))
        })
    }
}

/// Writes a value as JSON.
///
/// # Errors
/// If it cannot be written there.
pub(super) fn write_json(destination: &Destination, value: &impl Serialize) -> anyhow::Result<()> {
    let text = serde_json::to_string_pretty(value)? + "\n";
    match destination {
        Destination::Output => {
            let mut output = std::io::stdout().lock();
            let written = output.write_all(text.as_bytes()).and_then(|()| output.flush());
            written.context("standard output: the answer could not be written")
        }
        Destination::File(path) => std::fs::write(path, text).with_context(|| {
            format!(
                "{}: could not be written; check the folder and its permissions",
                path.display()
            )
        }),
    }
}
