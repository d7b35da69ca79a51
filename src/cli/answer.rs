//! Where a command's answer goes: a file, or standard output for the program that called.

use std::convert::Infallible;
use std::io::Write as _;
use std::path::PathBuf;
use std::str::FromStr;

use anyhow::Context;
use clap::Args;
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

impl Destination {
    /// Whether it can be written there, asked before the work.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn check_writable(&self) -> anyhow::Result<()> {
        match self {
            Self::Output => Ok(()),
            Self::File(path) => super::parse::check_writable(path),
        }
    }
}

/// The option of the commands that answer.
#[derive(Clone, Debug, Default, Args)]
pub(super) struct Answer {
    /// Write the answer as JSON: to a file, or to standard output in place of the words (-).
    #[arg(long, value_name = "FILE|-")]
    json: Option<Destination>,
}

impl Answer {
    /// Whether words have a place on standard output.
    pub(super) fn has_words(&self) -> bool {
        self.json != Some(Destination::Output)
    }

    /// Whether the answer can be written, asked before the work.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn check_writable(&self) -> anyhow::Result<()> {
        self.json.as_ref().map_or(Ok(()), Destination::check_writable)
    }

    /// Writes the answer where it is asked for.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn write(&self, answer: &impl Serialize) -> anyhow::Result<()> {
        self.json
            .as_ref()
            .map_or(Ok(()), |destination| write_json(destination, answer))
    }
}

/// Values that are told while others are still to come: a line of JSON each.
pub(super) struct Lines(Box<dyn std::io::Write>);

impl Lines {
    /// Where they go; a file is begun anew.
    ///
    /// # Errors
    /// If it cannot be written there.
    pub(super) fn open(destination: &Destination) -> anyhow::Result<Self> {
        Ok(Self(match destination {
            Destination::Output => Box::new(std::io::stdout()),
            Destination::File(path) => Box::new(
                std::fs::File::create(path)
                    .with_context(|| format!("{}: cannot be written; check the folder", path.display()))?,
            ),
        }))
    }

    /// Writes a line, at once.
    ///
    /// # Errors
    /// If it cannot be written there.
    pub(super) fn write(&mut self, value: &impl Serialize) -> anyhow::Result<()> {
        let text = serde_json::to_string(value)? + "\n";
        let written = self.0.write_all(text.as_bytes()).and_then(|()| self.0.flush());
        written.context("the answer could not be written; is there room?")
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
