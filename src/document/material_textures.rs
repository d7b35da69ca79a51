//! The images of a material in use: the user's, and the model's.

use super::{CoatLobe, MaterialSettings, PARAMETERS, TextureUse};
use crate::scene::texture::{TextureProjection, TextureTarget as On, UserTexture};

impl MaterialSettings {
    /// Puts an image on a target, so that it is seen: what it multiplies becomes 1 where another value would hide it.
    pub fn put_texture(&mut self, target: On, texture: UserTexture) {
        let is_new = self.user_textures.get(target).is_none();
        self.user_textures.set(target, Some(texture));
        self.textures[target] = true;
        if !is_new {
            return;
        }
        if target == On::CoatRoughness {
            self.coat_lobe = CoatLobe::Ggx;
        }
        if target == On::Emission && self.emission_strength == 0.0 {
            (self.emission_color, self.emission_strength) = ([1.0; 3], 1.0);
        }
        let key = target.map_key().trim_end_matches("_map");
        let layer = key.split('.').next().unwrap_or_default();
        let is_factor = !key.ends_with(".weight") && !matches!(target, On::Emission | On::FilmThickness);
        for parameter in PARAMETERS.iter() {
            let is_weight = parameter.key.strip_suffix(".weight") == Some(layer);
            let is_hiding = is_weight && parameter.rgb(self) == Some([0.0; 3]);
            let is_own = parameter.key == key;
            if (is_factor && is_own) || (is_hiding && (is_own || !matches!(layer, "base" | "specular"))) {
                parameter.put_rgb(self, [1.0; 3]);
            }
        }
    }

    /// The model's textures in use: those without a user's texture in their place.
    pub fn uses_of_model(&self) -> TextureUse {
        let mut uses = TextureUse::default();
        for &target in On::ALL {
            uses[target] |= self.textures[target] && self.user_textures.get(target).is_none();
        }
        uses
    }

    /// Has its images lie by the first texture coordinates where they lay as on a box.
    pub fn without_boxes(&mut self) {
        for texture in self.user_textures.iter_mut() {
            if matches!(texture.projection, TextureProjection::Box | TextureProjection::Auto) {
                texture.projection = TextureProjection::First;
            }
        }
    }
}
