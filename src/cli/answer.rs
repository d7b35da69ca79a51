//! Where a command's answer goes: a file, or standard output for the program that called.

use std::borrow::Cow;
use std::ffi::OsString;
use std::fmt;
use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use serde::Serialize;

use crate::console::output;
use crate::scene::path_text::path_text;
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

/// Values that are printed as they become known: a line of JSON each. A file has all lines so far, and never a part of one; pipes
/// and devices are written into.
pub(super) struct Lines {
    to: Destination,
    place: LinesPlace,
}

enum LinesPlace {
    Output,
    /// A pipe or a device.
    Special(File),
    /// A file, which is replaced as images are, with what is in it.
    File(String),
}

impl Lines {
    /// Opens the destination; an existing file is replaced by the first line.
    ///
    /// # Errors
    /// If it cannot be written there.
    pub(super) fn open(destination: &Destination) -> anyhow::Result<Self> {
        destination.check_writable()?;
        let place = match destination {
            Destination::Output => LinesPlace::Output,
            Destination::File(path) if is_special(path) => LinesPlace::Special(opened(path)?),
            Destination::File(_) => LinesPlace::File(String::new()),
        };
        let to = destination.clone();
        Ok(Self { to, place })
    }

    /// Writes a line, at once.
    ///
    /// # Errors
    /// If it cannot be written there.
    pub(super) fn write(&mut self, value: &impl Serialize) -> anyhow::Result<()> {
        self.text(&serde_json::to_string(value)?)
    }

    fn text(&mut self, text: &str) -> anyhow::Result<()> {
        match (&mut self.place, &self.to) {
            (LinesPlace::File(lines), Destination::File(path)) => {
                *lines += &format!("{text}\n");
                Ok(save_atomically(path, lines.as_bytes())?)
            }
            (LinesPlace::Special(file), to) => {
                let written = file.write_all(format!("{text}\n").as_bytes());
                written.with_context(|| format!("{to}: the answer could not be written; is there room?"))
            }
            _ => {
                output!("{text}");
                Ok(())
            }
        }
    }
}

/// A pipe or a device, opened to be written into.
fn opened(path: &Path) -> anyhow::Result<File> {
    let opened = OpenOptions::new().write(true).open(path);
    opened.with_context(|| format!("{}: cannot be written; check the folder", path.display()))
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

/// Names of files as JSON can have them.
pub(super) fn file_names<'a>(files: impl IntoIterator<Item = &'a PathBuf>) -> Vec<Cow<'a, str>> {
    files.into_iter().map(|file| path_text(file)).collect()
}

/// Whether this is a pipe or a device, into which is written.
fn is_special(path: &Path) -> bool {
    path.metadata().is_ok_and(|found| !found.is_file() && !found.is_dir())
}
