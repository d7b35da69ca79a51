//! The images of a material in use: the user's, and the model's.

use super::{CoatLobe, MaterialSettings, TextureUse};
use crate::scene::texture::{TextureAssignment, TextureProjection, TextureTarget, UserTexture};

/// A target's place in a material.
struct Place {
    /// See [`map_key`].
    key: &'static str,
    /// The switch of its texture; roughness and metalness have one together.
    switch: fn(&mut TextureUse) -> &mut bool,
    /// Changes a value that would hide the texture.
    reveal: fn(&mut MaterialSettings),
}

impl Place {
    const fn new(
        key: &'static str,
        switch: fn(&mut TextureUse) -> &mut bool,
        reveal: fn(&mut MaterialSettings),
    ) -> Self {
        Self { key, switch, reveal }
    }

    /// The place of a target.
    const fn of(target: TextureTarget) -> &'static Self {
        &PLACES[target as usize]
    }
}

/// Gives a material a coat if it has none.
fn show_coat(material: &mut MaterialSettings) {
    if material.coat_weight == 0.0 {
        material.coat_weight = 1.0;
    }
}

/// Gives a material fuzz if it has none.
fn show_fuzz(material: &mut MaterialSettings) {
    if material.fuzz_weight == 0.0 {
        material.fuzz_weight = 1.0;
    }
}

/// The places of all targets, in their order.
const PLACES: &[Place; TextureTarget::ALL.len()] = &[
    Place::new(
        "base.color_map",
        |uses| &mut uses.color,
        |material| material.base_color = [1.0; 3],
    ),
    Place::new(
        "specular.roughness_map",
        |uses| &mut uses.roughness,
        |material| material.roughness = 1.0,
    ),
    Place::new(
        "base.metalness_map",
        |uses| &mut uses.roughness,
        |material| material.metalness = 1.0,
    ),
    Place::new("geometry.normal_map", |uses| &mut uses.normal, |_| {}),
    Place::new(
        "geometry.opacity_map",
        |uses| &mut uses.opacity,
        |material| material.opacity = 1.0,
    ),
    Place::new(
        "emission.color_map",
        |uses| &mut uses.emission,
        |material| {
            if material.emission_strength == 0.0 {
                (material.emission_color, material.emission_strength) = ([1.0; 3], 1.0);
            }
        },
    ),
    Place::new("coat.weight_map", |uses| &mut uses.coat, show_coat),
    Place::new(
        "coat.roughness_map",
        |uses| &mut uses.coat_roughness,
        |material| {
            show_coat(material);
            (material.coat_lobe, material.coat_roughness) = (CoatLobe::Ggx, 1.0);
        },
    ),
    Place::new(
        "coat.color_map",
        |uses| &mut uses.coat_color,
        |material| {
            show_coat(material);
            material.coat_color = [1.0; 3];
        },
    ),
    Place::new("coat.normal_map", |uses| &mut uses.coat_normal, show_coat),
    Place::new(
        "thin_film.weight_map",
        |uses| &mut uses.film,
        |material| {
            if material.film_weight == 0.0 {
                material.film_weight = 1.0;
            }
        },
    ),
    Place::new("thin_film.thickness_map", |uses| &mut uses.film_thickness, |_| {}),
    Place::new("fuzz.weight_map", |uses| &mut uses.fuzz, show_fuzz),
    Place::new(
        "fuzz.color_map",
        |uses| &mut uses.fuzz_color,
        |material| {
            show_fuzz(material);
            material.fuzz_color = [1.0; 3];
        },
    ),
    Place::new(
        "fuzz.roughness_map",
        |uses| &mut uses.fuzz_roughness,
        |material| {
            show_fuzz(material);
            material.fuzz_roughness = 1.0;
        },
    ),
];

/// The key of a target's image in a material's file, and on the command line before that of a parameter:
/// `base.color_map.rotation`.
pub const fn map_key(target: TextureTarget) -> &'static str {
    Place::of(target).key
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
        if is_new {
            (Place::of(target).reveal)(self);
        }
    }

    /// Whether the texture on a target is looked up.
    pub fn uses_texture(&self, target: TextureTarget) -> bool {
        let mut uses = self.textures;
        *(Place::of(target).switch)(&mut uses)
    }

    /// The switch of the texture on a target; roughness and metalness have one together.
    pub fn uses_texture_mut(&mut self, target: TextureTarget) -> &mut bool {
        (Place::of(target).switch)(&mut self.textures)
    }

    /// The model's textures in use: those without a user's texture in their place.
    pub fn uses_of_model(&self) -> TextureUse {
        let mut uses = TextureUse::default();
        for &target in TextureTarget::ALL {
            let is_of_model = self.uses_texture(target) && self.user_textures.get(target).is_none();
            *(Place::of(target).switch)(&mut uses) |= is_of_model;
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
