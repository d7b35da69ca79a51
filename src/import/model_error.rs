//! Errors of models, in one line each.

use std::io;
use std::path::PathBuf;

use crate::endings::MODELS;
use crate::scene::Cancelled;

/// Why a model could not be loaded.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The file itself cannot be read.
    #[error("{}: cannot read this model: {source}; check the path and its permissions", path.display())]
    Read {
        /// The model file.
        path: PathBuf,
        /// Error of the system.
        source: io::Error,
    },
    /// Neither GLB nor JSON.
    #[error("{}: not a glTF 2.0 file ({reason}); export the model as .glb or .gltf", path.display())]
    NotGltf {
        /// The model file.
        path: PathBuf,
        /// Reason of the reader, in words.
        reason: String,
    },
    /// The file ends too early.
    #[error("{}: cut short: {actual} bytes of {expected}; copy or download the file again", path.display())]
    Truncated {
        /// The model file.
        path: PathBuf,
        /// Bytes that its header promises.
        expected: u64,
        /// Bytes that are there.
        actual: u64,
    },
    /// Contents that break the rules of the format.
    #[error("{}: damaged: {reason}; export the model again", path.display())]
    Invalid {
        /// The model file.
        path: PathBuf,
        /// The violated rule.
        reason: String,
    },
    /// Nothing to render, because a referenced file is missing.
    #[error("{}: nothing to show; {reason}; put what is missing beside the model, or export as .glb", path.display())]
    Incomplete {
        /// The model file.
        path: PathBuf,
        /// The missing part.
        reason: String,
    },
    /// The file needs an unsupported extension.
    #[error("{}: needs the glTF extension {name}, which is not supported; {remedy}", path.display())]
    Extension {
        /// The model file.
        path: PathBuf,
        /// The extension.
        name: String,
        /// Remedy, as an instruction to the user.
        remedy: &'static str,
    },
    /// A referenced buffer or image is missing or unreadable.
    #[error("{}: cannot use {resource}: {reason}; put it beside the model or export as .glb", path.display())]
    Resource {
        /// The model file.
        path: PathBuf,
        /// The file or image referred to.
        resource: String,
        /// Fault of the resource.
        reason: String,
    },
    /// A folder or an archive without a model.
    #[error("{}: no model in it; models are {}", path.display(), MODELS.join(", "))]
    NoModelInside {
        /// The folder or archive.
        path: PathBuf,
    },
    /// Loading was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The scene has no triangles to render.
    #[error("{}: no triangles in its scene; export a mesh with faces", path.display())]
    NoTriangles {
        /// The model file.
        path: PathBuf,
    },
}
