//! Images of the user's in a material's file.

use std::path::PathBuf;

use serde_json::{Map, Value as Json};

use super::parameter::{ParameterError, TEXTURE_PARAMETERS};
use crate::scene::texture::UserTexture;

/// An image as a material's file has it: `{"file": …, "rotation": 45, …}`; what is left out has its default.
pub fn texture_from_json(json: Json) -> Result<UserTexture, TextureError> {
    let Json::Object(mut values) = json else {
        return Err(TextureError::NoObject);
    };
    let Some(Json::String(file)) = values.shift_remove("file") else {
        return Err(TextureError::NoFile);
    };
    let mut texture = UserTexture::of(PathBuf::from(file));
    for parameter in TEXTURE_PARAMETERS.iter() {
        if let Some(json) = values.shift_remove(parameter.key) {
            parameter.set(&mut texture, parameter.value_from_json(&json)?)?;
        }
    }
    Ok(texture)
}

/// An image for a material's file; see [`texture_from_json`].
pub fn texture_to_json(texture: &UserTexture) -> Json {
    let mut values = Map::new();
    // With the separators that every system reads.
    let file = texture.file.to_string_lossy().replace('\\', "/");
    values.insert("file".to_owned(), Json::from(file));
    for parameter in TEXTURE_PARAMETERS.iter() {
        let value = parameter.get(texture);
        if value != parameter.default_value() {
            values.insert(parameter.key.to_owned(), parameter.json_from_value(&value));
        }
    }
    Json::Object(values)
}

/// Why an image in a material's file can't be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TextureError {
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// It is no object.
    #[error("a texture must be an object; write {{\"file\": \"wood.png\"}} or the like")]
    NoObject,
    /// It names no file.
    #[error("a texture must name its \"file\"")]
    NoFile,
}
