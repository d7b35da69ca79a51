//! Why a session refuses a document or fails.

use super::memory;
use crate::compile::AssetError;
use crate::gpu::GpuError;
use crate::import::ModelError;
use crate::import::environment::EnvironmentError;

/// Why a session refuses a document or fails.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The model can't be loaded.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The environment can't be loaded.
    #[error(transparent)]
    Environment(#[from] EnvironmentError),
    /// The GPU can't be used.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The image does not fit into memory; nothing was started.
    #[error(transparent)]
    TooLarge(#[from] memory::TooLarge),
    /// The model's instances do not fit into memory one by one; nothing was started.
    #[error(transparent)]
    Instances(#[from] memory::InstancesTooLarge),
}

impl From<AssetError> for SessionError {
    fn from(error: AssetError) -> Self {
        match error {
            AssetError::Model(error) => Self::Model(error),
            AssetError::Environment(error) => Self::Environment(error),
        }
    }
}

impl SessionError {
    /// Whether it was cancelled rather than failed.
    pub fn is_cancelled(&self) -> bool {
        matches!(
            self,
            Self::Model(ModelError::Cancelled(_)) | Self::Environment(EnvironmentError::Cancelled(_))
        )
    }
}
