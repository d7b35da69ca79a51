//! The images that a user has assigned to a material.

use std::path::{Path, PathBuf};

use serde_json::{Map, Value as Json};

use super::parameter::{ParameterError, TEXTURE_PARAMETERS};
use super::{MaterialSettings, TextureUse};
use crate::scene::texture::{TextureAssignment, TextureProjection, TextureTarget, UserTexture};

/// Texture maps that the user assigned to a material, at most one per target.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UserTextures([Option<Box<UserTexture>>; TextureTarget::ALL.len()]);

impl UserTextures {
    /// The image for a target.
    pub fn get(&self, target: TextureTarget) -> Option<&UserTexture> {
        self.0[target as usize].as_deref()
    }

    /// The same to be changed.
    pub fn get_mut(&mut self, target: TextureTarget) -> Option<&mut UserTexture> {
        self.0[target as usize].as_deref_mut()
    }

    /// Puts an image on a target, or takes it off.
    pub fn set(&mut self, target: TextureTarget, texture: Option<UserTexture>) {
        self.0[target as usize] = texture.map(Box::new);
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = (TextureTarget, &UserTexture)> {
        let targets = TextureTarget::ALL.iter();
        targets.filter_map(|&target| Some((target, self.get(target)?)))
    }

    /// Changes the names of their files.
    pub fn map_files(&mut self, map: impl Fn(&Path) -> PathBuf) {
        for texture in self.0.iter_mut().flatten() {
            texture.file = map(&texture.file);
        }
    }
}

/// The key of a target's image in a material's file, and on the command line before that of a parameter:
/// `base.color_map.rotation`.
pub const fn map_key(target: TextureTarget) -> &'static str {
    match target {
        TextureTarget::BaseColor => "base.color_map",
        TextureTarget::Roughness => "specular.roughness_map",
        TextureTarget::Metalness => "base.metalness_map",
        TextureTarget::Normal => "geometry.normal_map",
        TextureTarget::Opacity => "geometry.opacity_map",
        TextureTarget::Emission => "emission.color_map",
        TextureTarget::Coat => "coat.weight_map",
    }
}

/// The target whose image has this key.
pub fn target_of_key(key: &str) -> Option<TextureTarget> {
    TextureTarget::ALL
        .iter()
        .copied()
        .find(|target| map_key(*target) == key)
}

impl MaterialSettings {
    /// Puts an image on a target, so that it is seen: what it multiplies becomes 1 where another value would hide it.
    pub fn put_texture(&mut self, target: TextureTarget, texture: UserTexture) {
        let is_new = self.user_textures.get(target).is_none();
        self.user_textures.set(target, Some(texture));
        *self.uses_texture_mut(target) = true;
        if !is_new {
            return;
        }
        match target {
            TextureTarget::BaseColor => self.base_color = [1.0; 3],
            TextureTarget::Roughness => self.roughness = 1.0,
            TextureTarget::Metalness => self.metalness = 1.0,
            TextureTarget::Opacity => self.opacity = 1.0,
            TextureTarget::Emission if self.emission_strength == 0.0 => {
                (self.emission_color, self.emission_strength) = ([1.0; 3], 1.0);
            }
            TextureTarget::Coat if self.coat_weight == 0.0 => self.coat_weight = 1.0,
            TextureTarget::Normal | TextureTarget::Emission | TextureTarget::Coat => {}
        }
    }

    /// Whether the texture on a target is looked up.
    pub fn uses_texture(&self, target: TextureTarget) -> bool {
        match target {
            TextureTarget::BaseColor => self.textures.color,
            TextureTarget::Roughness | TextureTarget::Metalness => self.textures.roughness,
            TextureTarget::Normal => self.textures.normal,
            TextureTarget::Opacity => self.textures.opacity,
            TextureTarget::Emission => self.textures.emission,
            TextureTarget::Coat => self.textures.coat,
        }
    }

    /// The model's textures in use: those without a user's texture in their place.
    pub fn uses_of_model(&self) -> TextureUse {
        let of_model = |target| self.uses_texture(target) && self.user_textures.get(target).is_none();
        TextureUse {
            color: of_model(TextureTarget::BaseColor),
            roughness: of_model(TextureTarget::Roughness) || of_model(TextureTarget::Metalness),
            normal: of_model(TextureTarget::Normal),
            emission: of_model(TextureTarget::Emission),
            opacity: of_model(TextureTarget::Opacity),
            coat: of_model(TextureTarget::Coat),
        }
    }

    /// Has its images lie by the first texture coordinates where they lay as on a box.
    pub fn without_boxes(&mut self) {
        for texture in self.user_textures.0.iter_mut().flatten() {
            if matches!(texture.projection, TextureProjection::Box | TextureProjection::Auto) {
                texture.projection = TextureProjection::First;
            }
        }
    }

    /// The switch of the texture on a target; roughness and metalness have one together.
    pub fn uses_texture_mut(&mut self, target: TextureTarget) -> &mut bool {
        match target {
            TextureTarget::BaseColor => &mut self.textures.color,
            TextureTarget::Roughness | TextureTarget::Metalness => &mut self.textures.roughness,
            TextureTarget::Normal => &mut self.textures.normal,
            TextureTarget::Opacity => &mut self.textures.opacity,
            TextureTarget::Emission => &mut self.textures.emission,
            TextureTarget::Coat => &mut self.textures.coat,
        }
    }
}

/// Users' textures of materials, by slot.
pub fn texture_assignments(materials: &[MaterialSettings]) -> Vec<TextureAssignment> {
    let of_slot = |(slot, material): (usize, &MaterialSettings)| {
        let assigned = material
            .user_textures
            .iter()
            .map(|(target, texture)| TextureAssignment {
                slot,
                target,
                texture: texture.clone(),
            });
        assigned.collect::<Vec<_>>()
    };
    materials.iter().enumerate().flat_map(of_slot).collect()
}

/// An image as a material's file has it: `{"file": …, "rotation": 45, …}`; what is left out has its default.
///
/// # Errors
/// A value that a parameter does not take; a file that is no text.
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
    /// A parameter's value.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// It is no object.
    #[error("a texture must be an object; write {{\"file\": \"wood.png\"}} or the like")]
    NoObject,
    /// It names no file.
    #[error("a texture must name its \"file\"")]
    NoFile,
}
