//! Errors of environment maps, in one line each.

/// Errors of an environment map.
#[derive(Debug, thiserror::Error)]
pub enum MapError {
    /// An empty name.
    #[error("no environment was named: give studio, sky, furnace, or an image file")]
    NoName,
    /// A file, which is not computed but read.
    #[error("the environment {0} is a file: read it")]
    IsFile(String),
    /// No pixels.
    #[error("the environment {name} has no pixels: it needs at least one; save it again at its full size")]
    Empty { name: String },
    /// A sky that cannot be.
    #[error("{0}")]
    SkyParameter(String),
}
