//! Why a session refuses a document or fails.

use crate::{compile::AssetError, gpu::GpuError};

/// Why a session refuses a document or fails.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The model or the environment can't be loaded.
    #[error(transparent)]
    Asset(#[from] AssetError),
    /// The GPU can't be used.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// It does not fit into memory; nothing was started.
    #[error("{0}")]
    TooLarge(String),
}

impl SessionError {
    /// Whether it was cancelled rather than failed.
    pub fn is_cancelled(&self) -> bool {
        matches!(self, Self::Asset(error) if error.is_cancelled())
    }
}
