//! Errors of the denoiser's library, with what their messages name.

use std::path::PathBuf;

/// Environment variable with the folder of the library.
pub const FOLDER_VARIABLE: &str = "GLOSSMITH_OIDN";

/// The oldest supported version (major, minor): earlier ones lack a quality.
pub const MIN_VERSION: [i32; 2] = [2, 3];

#[cfg(target_os = "windows")]
pub const NAME: &str = "OpenImageDenoise.dll";
#[cfg(target_os = "macos")]
pub const NAME: &str = "libOpenImageDenoise.2.dylib";
#[cfg(not(any(target_os = "windows", target_os = "macos")))]
pub const NAME: &str = "libOpenImageDenoise.so.2";

/// Why there is no denoiser.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LibraryError {
    /// The library was not found.
    #[error(
        "the denoiser Open Image Denoise 2 was not found: run `scripts/setup denoiser`, or name the folder of {NAME} by \
         {FOLDER_VARIABLE}"
    )]
    Missing,
    /// What is there cannot be used as the library.
    #[error("{path}: {reason}")]
    Unusable { path: PathBuf, reason: String },
    /// The library refuses to work here.
    #[error("the denoiser can't be used here: {0}")]
    Device(String),
    /// The request was cancelled.
    #[error("denoising was stopped")]
    Cancelled,
}
