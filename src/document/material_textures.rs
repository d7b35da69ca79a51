//! The images of a material in use: the user's, and the model's.

use super::{CoatLobe, MaterialSettings, TextureUse};
use crate::optics::target::TARGETS;
use crate::scene::texture::{TextureAssignment, TextureProjection, TextureTarget as On, UserTexture};

/// See [`map_key`].
const KEYS: &[&str; TARGETS] = &[
    "base.color_map",
    "specular.roughness_map",
    "base.metalness_map",
    "geometry.normal_map",
    "geometry.opacity_map",
    "emission.color_map",
    "coat.weight_map",
    "coat.roughness_map",
    "coat.color_map",
    "coat.normal_map",
    "thin_film.weight_map",
    "thin_film.thickness_map",
    "fuzz.weight_map",
    "fuzz.color_map",
    "fuzz.roughness_map",
];

/// The key of a target's image in a material's file, and on the command line before that of a parameter:
/// `base.color_map.rotation`.
pub const fn map_key(target: On) -> &'static str {
    KEYS[target as usize]
}

/// The target whose image has this key.
pub fn target_of_key(key: &str) -> Option<On> {
    On::ALL.iter().copied().find(|target| map_key(*target) == key)
}

impl MaterialSettings {
    /// Puts an image on a target, so that it is seen: what it multiplies becomes 1 where another value would hide it.
    pub fn put_texture(&mut self, target: On, texture: UserTexture) {
        let is_new = self.user_textures.get(target).is_none();
        self.user_textures.set(target, Some(texture));
        self.textures[target] = true;
        if !is_new {
            return;
        }
        match target {
            On::BaseColor => self.base_color = [1.0; 3],
            On::Roughness => self.roughness = 1.0,
            On::Metalness => self.metalness = 1.0,
            On::Opacity => self.opacity = 1.0,
            On::Emission if self.emission_strength == 0.0 => {
                (self.emission_color, self.emission_strength) = ([1.0; 3], 1.0);
            }
            On::CoatRoughness => (self.coat_lobe, self.coat_roughness) = (CoatLobe::Ggx, 1.0),
            On::CoatColor => self.coat_color = [1.0; 3],
            On::FuzzColor => self.fuzz_color = [1.0; 3],
            On::FuzzRoughness => self.fuzz_roughness = 1.0,
            _ => {}
        }
        let weight = match target {
            On::Coat | On::CoatRoughness | On::CoatColor | On::CoatNormal => &mut self.coat_weight,
            On::Fuzz | On::FuzzColor | On::FuzzRoughness => &mut self.fuzz_weight,
            On::Film => &mut self.film_weight,
            _ => return,
        };
        if *weight == 0.0 {
            *weight = 1.0;
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
