//! Why files cannot be read or written, and what to do.

use std::{io, path::Path, path::PathBuf};

/// Files larger than this many bytes are taken for something else.
pub const SIZE_MAX: u64 = 16 << 20;

/// Why a material or project file cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The system can't read it.
    #[error("{path}: cannot be read: {source}; check the path and its permissions")]
    Read { path: PathBuf, source: io::Error },
    /// Too large to be one.
    #[error("{path}: too large for a material or project (over {} MiB); choose another file", SIZE_MAX >> 20)]
    TooLarge { path: PathBuf },
    /// Not JSON, or cut short.
    #[error("{path}: not valid JSON: {reason}; correct it there or save the file again")]
    NotJson { path: PathBuf, reason: String },
    /// JSON of something else.
    #[error("{path}: not a Glossmith {expected}: it has no \"{mark}\" number; choose a file saved as {expected}")]
    WrongKind {
        path: PathBuf,
        expected: &'static str,
        mark: &'static str,
    },
    /// An image that was not saved by Glossmith, or whose text another program left out.
    #[error("{path}: an image without a Glossmith document inside; open one that was saved here")]
    NoDocument { path: PathBuf },
    /// Contents out of range, with what would be right.
    #[error("{path}: {reason}")]
    Content { path: PathBuf, reason: String },
    /// It names files that lie elsewhere.
    #[error(
        "{path}: names files outside of its surroundings, which are read only where that is allowed: {}; where you trust it, allow them (--allow-outside)",
        list(files)
    )]
    Outside { path: PathBuf, files: Vec<PathBuf> },
    /// No such preset, no such file.
    #[error("no material is called {name} and there is no such file; {hint}")]
    UnknownMaterial { name: String, hint: String },
    /// The file cannot be written.
    #[error("{path}: cannot be saved: {source}; check the folder's permissions and free space")]
    Write { path: PathBuf, source: io::Error },
}

impl FileError {
    /// The error of a file that the system does not read.
    pub(super) fn reading(path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        |source| Self::Read { path, source }
    }

    /// Contents out of range, with what would be right.
    pub(super) fn content(path: &Path, reason: impl ToString) -> Self {
        let (path, reason) = (path.to_owned(), reason.to_string());
        Self::Content { path, reason }
    }

    /// The error of a file that the system does not write.
    pub(super) fn writing(path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        |source| Self::Write { path, source }
    }
}

fn list(files: &[PathBuf]) -> String {
    crate::named::joined(files.iter().map(|file| file.display()), ", ")
}
