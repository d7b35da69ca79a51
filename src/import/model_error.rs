//! Errors of models, in one line each.

use std::io;
use std::path::{Path, PathBuf};

use crate::endings::MODELS;
use crate::scene::Cancelled;

/// Why a model could not be loaded.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The file itself cannot be read.
    #[error("{}: cannot read this model: {source}; check the path and its permissions", path.display())]
    Read { path: PathBuf, source: io::Error },
    /// Neither GLB nor JSON.
    #[error("{}: not a glTF 2.0 file ({reason}); export the model as .glb or .gltf", path.display())]
    NotGltf { path: PathBuf, reason: String },
    /// The file ends too early.
    #[error("{}: cut short: {actual} bytes of {expected}; copy or download the file again", path.display())]
    Truncated { path: PathBuf, expected: u64, actual: u64 },
    /// Contents that break the rules of the format.
    #[error("{}: damaged: {reason}; export the model again", path.display())]
    Invalid { path: PathBuf, reason: String },
    /// Nothing to render, because a referenced file is missing.
    #[error("{}: nothing to show; {reason}; put what is missing beside the model, or export as .glb", path.display())]
    Incomplete { path: PathBuf, reason: String },
    /// The file needs an unsupported extension.
    #[error("{}: needs the glTF extension {name}, which is not supported; {remedy}", path.display())]
    Extension {
        path: PathBuf,
        name: String,
        remedy: &'static str,
    },
    /// A referenced buffer or image is missing or unreadable.
    #[error("{}: cannot use {resource}: {reason}; put it beside the model or export as .glb", path.display())]
    Resource {
        path: PathBuf,
        resource: String,
        reason: String,
    },
    /// A folder or an archive without a model.
    #[error("{}: no model in it; models are {}", path.display(), MODELS.join(", "))]
    NoModelInside { path: PathBuf },
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The scene has no triangles to render.
    #[error("{}: no triangles in its scene; export a mesh with faces", path.display())]
    NoTriangles { path: PathBuf },
}

impl ModelError {
    /// Contents that break the rules of the format.
    pub(crate) fn invalid(path: &Path, reason: impl ToString) -> Self {
        let (path, reason) = (path.to_owned(), reason.to_string());
        Self::Invalid { path, reason }
    }
}
