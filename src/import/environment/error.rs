//! Errors of environments from files, in one line each.

use crate::scene::{Cancelled, environment::MapError};

#[derive(Debug, thiserror::Error)]
pub enum EnvironmentError {
    /// The file, the fault and the remedy.
    #[error("{0}")]
    Refused(String),
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The texels make no map.
    #[error(transparent)]
    Map(#[from] MapError),
}
