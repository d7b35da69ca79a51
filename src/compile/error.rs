//! Why a document's assets can't be had.

use crate::import::{ModelError, environment::EnvironmentError};

/// Why a document's assets can't be had.
#[derive(Debug, thiserror::Error)]
pub enum AssetError {
    /// The model can't be loaded.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The environment can't be loaded.
    #[error(transparent)]
    Environment(#[from] EnvironmentError),
}

impl AssetError {
    /// Whether it was cancelled rather than failed.
    pub fn is_cancelled(&self) -> bool {
        matches!(
            self,
            Self::Model(ModelError::Cancelled(_)) | Self::Environment(EnvironmentError::Cancelled(_))
        )
    }
}
