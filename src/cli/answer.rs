//! Where a command's answer goes: a file, or standard output for the program that called.

use std::ffi::OsString;
use std::fmt;
use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use serde::Serialize;

use crate::say::put;
use crate::store::replace::save_atomically;

/// Where an answer goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Destination {
    /// Standard output, written `-`.
    Output,
    /// A file.
    File(PathBuf),
}

impl From<OsString> for Destination {
    fn from(name: OsString) -> Self {
        if name == "-" {
            Self::Output
        } else {
            Self::File(name.into())
        }
    }
}

impl Destination {
    /// Whether it can be written there, asked before the work.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn check_writable(&self) -> anyhow::Result<()> {
        match self {
            Self::File(path) if !is_special(path) => super::parse::check_writable(path),
            _ => Ok(()),
        }
    }

    /// The file, opened to be written into; an existing one is overwritten. None for standard output.
    fn open(&self) -> anyhow::Result<Option<File>> {
        let open = |path: &PathBuf| {
            File::create(path).with_context(|| format!("{}: cannot be written; check the folder", path.display()))
        };
        match self {
            Self::Output => Ok(None),
            Self::File(path) => open(path).map(Some),
        }
    }
}

impl fmt::Display for Destination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Output => f.write_str("standard output"),
            Self::File(path) => path.display().fmt(f),
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

/// Values that are printed as they become known: a line of JSON each.
pub(super) struct Lines {
    to: Destination,
    file: Option<File>,
}

impl Lines {
    /// Opens the destination; an existing file is overwritten.
    ///
    /// # Errors
    /// If it cannot be written there.
    pub(super) fn open(destination: &Destination) -> anyhow::Result<Self> {
        Ok(Self {
            to: destination.clone(),
            file: destination.open()?,
        })
    }

    /// Writes a line, at once.
    ///
    /// # Errors
    /// If it cannot be written there.
    pub(super) fn write(&mut self, value: &impl Serialize) -> anyhow::Result<()> {
        self.text(&serde_json::to_string(value)?)
    }

    fn text(&mut self, text: &str) -> anyhow::Result<()> {
        let Some(file) = &mut self.file else {
            put!("{text}");
            return Ok(());
        };
        let written = file.write_all(format!("{text}\n").as_bytes());
        written.with_context(|| format!("{}: the answer could not be written; is there room?", self.to))
    }
}

/// Writes a value as JSON. A file has the old answer or the new, never a part; pipes and devices are written into.
///
/// # Errors
/// If it cannot be written there.
pub(super) fn write_json(destination: &Destination, value: &impl Serialize) -> anyhow::Result<()> {
    let text = serde_json::to_string_pretty(value)?;
    match destination {
        Destination::File(path) if !is_special(path) => Ok(save_atomically(path, (text + "\n").as_bytes())?),
        _ => Lines::open(destination)?.text(&text),
    }
}

/// Whether this is a pipe or a device, into which is written.
fn is_special(path: &Path) -> bool {
    path.metadata().is_ok_and(|found| !found.is_file() && !found.is_dir())
}
