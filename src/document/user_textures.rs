//! The images that a user has assigned to a material.

use std::path::{Path, PathBuf};

use crate::import::picture::is_shipped;
use crate::scene::texture::{TextureTarget, UserTexture};

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

    pub fn iter(&self) -> impl Iterator<Item = (TextureTarget, &UserTexture)> {
        let targets = TextureTarget::ALL.iter();
        targets.filter_map(|&target| Some((target, self.get(target)?)))
    }

    /// All of them, to be changed.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut UserTexture> {
        self.0.iter_mut().flatten().map(|texture| &mut **texture)
    }

    /// Their files, without the maps that are part of the program.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        let files = self.iter().map(|(_, texture)| &texture.file);
        files.filter(|file| !is_shipped(file))
    }

    /// Changes the names of their files.
    pub fn map_files(&mut self, map: impl Fn(&Path) -> PathBuf) {
        for texture in self.iter_mut().filter(|texture| !is_shipped(&texture.file)) {
            texture.file = map(&texture.file);
        }
    }
}
