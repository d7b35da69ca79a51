//! Errors of environments from files, in one line each.

use std::path::{Path, PathBuf};

use crate::budget::OverBudget;
use crate::scene::Cancelled;
use crate::scene::environment::{MapError, SOURCE_MAX_HEIGHT, SOURCE_MAX_WIDTH};

/// Errors of an environment. The message names the file, the fault and the remedy.
#[derive(Debug, thiserror::Error)]
pub enum EnvironmentError {
    /// The file system refused.
    #[error("cannot read the environment {}: {source}; check the path and its permissions", path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// An ending that is not known.
    #[error(
        "the environment {} is neither a .hdr nor an .exr, .ktx2, .dds, PNG, JPEG, TIFF or WebP file: convert it to one of them, \
         or use studio, sky or furnace",
        path.display()
    )]
    UnknownExtension { path: PathBuf },
    /// A folder without the faces of a cube.
    #[error(
        "the environment {} is a folder without six images whose names end in px, nx, py, ny, pz, nz (or right, left, \
         top, bottom, front, back): name a file in it",
        path.display()
    )]
    NoFaces { path: PathBuf },
    /// The content does not match the extension.
    #[error(
        "{} is not {expected} file although its name says so: its first bytes are different; check where it came from",
        path.display()
    )]
    WrongContent { path: PathBuf, expected: &'static str },
    /// The file ends too early.
    #[error("{} is cut short: {detail}; copy or download it again", path.display())]
    Truncated { path: PathBuf, detail: String },
    /// The decoder found a contradiction.
    #[error("{} is damaged: {detail}; copy or download it again, or re-save it", path.display())]
    Damaged { path: PathBuf, detail: String },
    /// A valid file with an unsupported feature.
    #[error("{} uses {feature}, which is not supported: {remedy}", path.display())]
    Unsupported {
        path: PathBuf,
        feature: String,
        remedy: &'static str,
    },
    /// Larger than the largest size.
    #[error(
        "{} is {width} × {height}, larger than the {} × {} that are read: scale it down",
        path.display(), SOURCE_MAX_WIDTH, SOURCE_MAX_HEIGHT
    )]
    TooLarge { path: PathBuf, width: u64, height: u64 },
    /// Larger than the memory budget.
    #[error("the environment {} is not loaded: {over}", path.display())]
    OverBudget { path: PathBuf, over: OverBudget },
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The texels make no map.
    #[error(transparent)]
    Map(#[from] MapError),
}

impl EnvironmentError {
    /// The decoder found a contradiction.
    pub(crate) fn damaged(path: &Path, detail: impl ToString) -> Self {
        let (path, detail) = (path.to_owned(), detail.to_string());
        Self::Damaged { path, detail }
    }

    /// The file ends too early.
    pub(crate) fn truncated(path: &Path, detail: impl ToString) -> Self {
        let (path, detail) = (path.to_owned(), detail.to_string());
        Self::Truncated { path, detail }
    }
}
