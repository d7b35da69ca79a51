//! Where a command's answer goes: a file, or standard output for the program that called.

use std::{borrow::Cow, ffi::OsString, fs::File, fs::OpenOptions, io::Write as _, path::Path, path::PathBuf};

use anyhow::Context;
use clap::Args;
use serde::Serialize;

use crate::{console::output, scene::path_text::path_text, store::replace::save_atomically};

/// Where an answer goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Destination {
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
    pub fn check_writable(&self) -> anyhow::Result<()> {
        match self {
            Self::File(path) if !is_special(path) => super::parse::check_writable(path),
            _ => Ok(()),
        }
    }
}

/// The option of the commands that answer.
#[derive(Clone, Debug, Default, Args)]
pub struct Answer {
    /// Write the answer as JSON: to a file, or to standard output in place of the words (-).
    #[arg(long, value_name = "FILE|-")]
    json: Option<Destination>,
}

impl Answer {
    /// Whether words have a place on standard output.
    pub fn has_words(&self) -> bool {
        self.json != Some(Destination::Output)
    }

    /// Whether the answer can be written, asked before the work.
    ///
    /// # Errors
    /// What the system says.
    pub fn check_writable(&self) -> anyhow::Result<()> {
        self.json.as_ref().map_or(Ok(()), Destination::check_writable)
    }

    /// Writes the answer where it is asked for.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, answer: &impl Serialize) -> anyhow::Result<()> {
        self.json
            .as_ref()
            .map_or(Ok(()), |destination| write_json(destination, answer))
    }
}

/// Values that are printed as they become known: a line of JSON each. A file has all lines so far, and never a part of one; pipes
/// and devices are written into.
pub enum Lines {
    Output,
    /// A pipe or a device.
    Device(File, PathBuf),
    /// What is in a file, which is replaced as images are.
    File(String, PathBuf),
}

impl Lines {
    /// Opens the destination; an existing file is replaced by the first line.
    pub fn open(destination: &Destination) -> anyhow::Result<Self> {
        destination.check_writable()?;
        Ok(match destination {
            Destination::Output => Self::Output,
            Destination::File(path) if is_special(path) => {
                let opened = OpenOptions::new().write(true).open(path);
                let wrong = || format!("{}: cannot be written; check the folder", path.display());
                Self::Device(opened.with_context(wrong)?, path.clone())
            }
            Destination::File(path) => Self::File(String::new(), path.clone()),
        })
    }

    /// Writes a line, at once.
    pub fn write(&mut self, value: &impl Serialize) -> anyhow::Result<()> {
        self.text(&serde_json::to_string(value)?)
    }

    fn text(&mut self, text: &str) -> anyhow::Result<()> {
        match self {
            Self::Output => output!("{text}"),
            Self::Device(file, path) => writeln!(file, "{text}")
                .with_context(|| format!("{}: the answer could not be written; is there room?", path.display()))?,
            Self::File(lines, path) => {
                *lines += &format!("{text}\n");
                save_atomically(path, lines.as_bytes())?;
            }
        }
        Ok(())
    }
}

/// Writes a value as JSON.
pub fn write_json(destination: &Destination, value: &impl Serialize) -> anyhow::Result<()> {
    Lines::open(destination)?.text(&serde_json::to_string_pretty(value)?)
}

/// Names of files as JSON can have them.
pub fn file_names<'a>(files: impl IntoIterator<Item = &'a PathBuf>) -> Vec<Cow<'a, str>> {
    files.into_iter().map(|file| path_text(file)).collect()
}

/// Whether this is a pipe or a device, into which is written.
fn is_special(path: &Path) -> bool {
    path.metadata().is_ok_and(|found| !found.is_file() && !found.is_dir())
}
