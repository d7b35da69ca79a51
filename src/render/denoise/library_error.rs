//! Errors of the denoiser's library, with what their messages name.

use std::path::PathBuf;

/// Environment variable with the folder of the library.
pub const FOLDER_VARIABLE: &str = "GLOSSMITH_OIDN";

/// The oldest supported version (major, minor): earlier ones lack a quality.
pub(super) const MIN_VERSION: [i32; 2] = [2, 3];

#[cfg(target_os = "windows")]
pub(super) const NAME: &str = "OpenImageDenoise.dll";
#[cfg(target_os = "macos")]
pub(super) const NAME: &str = "libOpenImageDenoise.2.dylib";
#[cfg(not(any(target_os = "windows", target_os = "macos")))]
pub(super) const NAME: &str = "libOpenImageDenoise.so.2";

/// Why there is no denoiser.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LibraryError {
    /// The library was not found.
    #[error(
        "the denoiser Open Image Denoise 2 was not found: run `scripts/setup denoiser`, or name the folder of {NAME} by \
         {FOLDER_VARIABLE}"
    )]
    Missing,
    /// The user's folder does not have the library.
    #[error("{}: there is no {NAME} in this folder, which {FOLDER_VARIABLE} names", .0.display())]
    NotInFolder(PathBuf),
    /// The file cannot be loaded.
    #[error("{}: can't be loaded as the denoiser ({reason}); install it again by `scripts/setup denoiser`", path.display())]
    Broken { path: PathBuf, reason: String },
    /// The version is too old.
    #[error("{}: Open Image Denoise {found} is too old, {}.{} or newer is needed", path.display(), MIN_VERSION[0], MIN_VERSION[1])]
    TooOld { path: PathBuf, found: String },
    /// The library refuses to work here.
    #[error("the denoiser can't be used here: {0}")]
    Device(String),
    /// The request was cancelled.
    #[error("denoising was stopped")]
    Cancelled,
}
