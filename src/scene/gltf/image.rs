//! The pictures of a file or beside it.

use super::container::Document;
use crate::scene::model::ModelError;
use crate::scene::picture::{Decoded, decode_bytes};

/// What to call a picture: its name, its file or its number.
pub(super) fn name(document: &Document, index: usize) -> String {
    let image = document.root.images.get(index);
    let external = image
        .and_then(|image| image.uri.as_deref())
        .filter(|uri| !uri.starts_with("data:"));
    image
        .and_then(|image| image.name.clone().filter(|name| !name.is_empty()))
        .or(external.map(str::to_owned))
        .unwrap_or_else(|| format!("image {index}"))
}

/// Decodes a picture.
///
/// # Errors
/// Why it cannot be had, in a few words.
pub(super) fn decode(document: &Document, index: usize) -> Result<Decoded, String> {
    let image = document.root.images.get(index).ok_or("it is out of bounds")?;
    let name = name(document, index);
    let owned;
    let view;
    let bytes: &[u8] = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => {
            owned = document.read_uri(&name, uri).map_err(|error| match error {
                ModelError::Resource { reason, .. } => reason,
                other => other.to_string(),
            })?;
            &owned
        }
        (None, Some(index)) => {
            view = document.view(index.value()).map_err(|error| error.to_string())?;
            &view
        }
        (None, None) => return Err("it has no data".to_owned()),
    };
    decode_bytes(name, bytes)
}
