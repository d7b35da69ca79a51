//! Paths as text for JSON: as they are, or as `file:` addresses where they are not Unicode. No two paths share a text.

use std::{borrow::Cow, path::Path, path::PathBuf};

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_decode_str, percent_encode};
use serde::{Deserialize as _, Deserializer, Serializer};

/// The beginning of a file's address.
const SCHEME: &str = "file://";
/// Bytes that are encoded in an address.
const ENCODED: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'/')
    .remove(b'.')
    .remove(b'-')
    .remove(b'_')
    .remove(b'~');

/// The name of a file without its folder.
pub fn file_name(path: &Path) -> String {
    path.file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}

/// The path as text: itself if it is Unicode, otherwise the address of its absolute path.
pub fn path_text(path: &Path) -> Cow<'_, str> {
    match path.to_str() {
        Some(text) if !text.starts_with(SCHEME) => text.into(),
        _ => {
            let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
            format!(
                "{SCHEME}{}",
                percent_encode(whole.as_os_str().as_encoded_bytes(), ENCODED)
            )
            .into()
        }
    }
}

/// The path of a text: a file's address is decoded.
pub fn path_of_text(text: &str) -> PathBuf {
    match text.strip_prefix(SCHEME) {
        Some(encoded) => path_of_bytes(percent_decode_str(encoded).collect()),
        None => text.into(),
    }
}

/// The path of a system's own bytes.
#[cfg(unix)]
pub fn path_of_bytes(bytes: Vec<u8>) -> PathBuf {
    use std::os::unix::ffi::OsStringExt as _;
    std::ffi::OsString::from_vec(bytes).into()
}

/// The path of bytes in UTF-8.
#[cfg(not(unix))]
pub fn path_of_bytes(bytes: Vec<u8>) -> PathBuf {
    String::from_utf8_lossy(&bytes).into_owned().into()
}

/// Serializes a path as text.
pub fn serialize<S: Serializer>(path: &Path, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(&path_text(path))
}

/// Lists of paths as texts.
pub mod list {
    use super::*;

    /// Serializes paths as texts.
    pub fn serialize<S: Serializer>(paths: &[PathBuf], to: S) -> Result<S::Ok, S::Error> {
        to.collect_seq(paths.iter().map(|path| path_text(path)))
    }

    /// The paths of texts.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<PathBuf>, D::Error> {
        Ok(Vec::<String>::deserialize(from)?
            .iter()
            .map(|text| path_of_text(text))
            .collect())
    }
}
