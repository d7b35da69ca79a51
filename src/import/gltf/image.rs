//! Images inside a file or beside it.

use std::borrow::Cow;

use super::container::Document;
use crate::model_error::ModelError;
use crate::picture::Encoded;

/// Name of an image: its name, its file or its index.
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

/// An encoded image.
pub(super) fn encoded(document: &Document, index: usize) -> Result<Encoded<'_>, String> {
    let image = document.root.images.get(index).ok_or("it is out of bounds")?;
    let name = name(document, index);
    let bytes = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => Cow::Owned(document.read_uri(&name, uri).map_err(|error| match error {
            ModelError::Resource { reason, .. } => reason,
            other => other.to_string(),
        })?),
        (None, Some(index)) => document.view(index.value()).map_err(|error| error.to_string())?,
        (None, None) => return Err("it has no data".to_owned()),
    };
    Ok(Encoded { name, bytes })
}
