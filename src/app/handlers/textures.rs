//! Images that are assigned to materials.

use std::path::PathBuf;

use crate::app::App;
use crate::scene::texture::{TextureTarget, UserTexture, set};

impl App {
    /// Puts images on the selected materials, in one edit.
    pub fn put_textures(&mut self, textures: &[(TextureTarget, UserTexture)]) {
        let Some((_, first)) = textures.first() else { return };
        let name = first
            .file
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let label = match textures.len() {
            1 => format!("Put {name} on the material"),
            count => format!("Put {count} textures on the material"),
        };
        for slot in self.shared.selection.slots() {
            let material = self.document.material_mut(slot);
            for (target, texture) in textures {
                // What is in the image's place keeps the way in which it lies there.
                let known = material.user_textures.get(*target).filter(|_| textures.len() == 1);
                let texture = known.map_or_else(
                    || texture.clone(),
                    |known| UserTexture {
                        file: texture.file.clone(),
                        ..known.clone()
                    },
                );
                material.put_texture(*target, texture);
            }
        }
        self.edits.note(label, "");
        self.edits.seal();
    }

    /// Puts images on what their names say; those that are left over. One by itself whose name says nothing is a base colour.
    pub fn put_pictures(&mut self, pictures: &[PathBuf]) -> Vec<PathBuf> {
        let (found, left) = set::recognised(pictures);
        if let (true, [picture]) = (found.is_empty(), pictures) {
            self.put_textures(&[(TextureTarget::BaseColor, UserTexture::of(picture.clone()))]);
            return Vec::new();
        }
        self.put_textures(&found);
        left
    }
}
