//! Errors of models, in one line each.

use std::{fmt::Display, path::Path};

use crate::scene::Cancelled;

/// Why a model could not be loaded.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The file, the fault and the remedy.
    #[error("{0}")]
    Refused(String),
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ModelError {
    /// An error that says this of the file.
    pub(crate) fn refused(path: &Path, what: impl Display) -> Self {
        Self::Refused(format!("{}: {what}", path.display()))
    }

    /// Contents that break the rules of the format.
    pub(crate) fn invalid(path: &Path, reason: impl Display) -> Self {
        Self::refused(path, format_args!("damaged: {reason}; export the model again"))
    }

    /// The scene has no triangles to render.
    pub(crate) fn no_triangles(path: &Path) -> Self {
        Self::refused(path, "no triangles in its scene; export a mesh with faces")
    }
}
