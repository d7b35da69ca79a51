//! Texture uses of slots: the model's maps, and users' maps in their place.

use std::path::PathBuf;

use super::user::{TextureProjection, TextureTarget, UserTexture};
use super::{CHANNEL_SHIFT, IS_BOX, IS_NEAREST, IS_SECOND_SET, IS_SRGB, TURNS_NORMALS, WRAP_SHIFT};
use super::{WRAP_CLAMP, WRAP_MIRRORED, WRAP_REPEAT};
use crate::scene::model::{AlphaMode, Filter, Slot, TextureRef, Wrap};

/// A user's map assigned to a slot.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureAssignment {
    /// The number of the slot.
    pub slot: usize,
    /// Parameter that the map multiplies.
    pub target: TextureTarget,
    /// The texture map.
    pub texture: UserTexture,
}

impl TextureAssignment {
    /// The map's file, and whether it is read as colours.
    pub fn picture(&self) -> (PathBuf, bool) {
        (self.texture.file.clone(), self.texture.is_srgb(self.target))
    }

    /// Whether green is read upside down.
    pub fn is_flipped(&self) -> bool {
        self.target == TextureTarget::Normal && self.texture.inverted
    }
}

/// One use of a texture map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Use {
    /// Index among the packed maps.
    pub picture: usize,
    /// Material parameter that it varies.
    pub target: TextureTarget,
    /// True if its green channel points down.
    pub is_flipped: bool,
    /// Rows of (u, v, 1).
    pub picture_from_uv: [f32; 6],
    /// [`TextureRecord::flags`](super::TextureRecord::flags), but for the channels' width.
    pub flags: u32,
    /// Factor of the value, …
    pub scale: f32,
    /// … and summand.
    pub offset: f32,
}

/// The uses of a slot, by target.
pub(super) type SlotUses = [Option<Use>; TextureTarget::ALL.len()];

/// A slot's uses of its model's maps.
pub(super) fn of_slot(slot: &Slot, is_translucent: impl Fn(usize) -> bool) -> SlotUses {
    let base_color = slot.base_color_texture;
    let opacity = base_color.filter(|place| slot.alpha_mode != AlphaMode::Opaque && is_translucent(place.texture));
    let uses = |target| {
        let reference = match target {
            TextureTarget::BaseColor => base_color,
            TextureTarget::Roughness | TextureTarget::Metalness => slot.metallic_roughness_texture,
            TextureTarget::Normal => slot.normal_texture,
            TextureTarget::Opacity => opacity,
            TextureTarget::Emission => slot.emissive_texture,
            TextureTarget::Coat => slot.coat_texture,
            TextureTarget::Film => slot.film_texture,
            TextureTarget::FilmThickness => slot.film_thickness_texture,
        };
        let mut used = of_reference(target, &reference?);
        if target == TextureTarget::FilmThickness && slot.film_thickness > 0.0 {
            // From the least thickness to the largest, by the green channel.
            used.offset = slot.film_thickness_min / slot.film_thickness;
            used.scale = 1.0 - used.offset;
            used.flags |= 2 << CHANNEL_SHIFT;
        }
        Some(used)
    };
    std::array::from_fn(|index| uses(TextureTarget::ALL[index]))
}

fn of_reference(target: TextureTarget, reference: &TextureRef) -> Use {
    let flag = |is_on: bool, flag: u32| if is_on { flag } else { 0 };
    // Opacity in a base colour map's alpha is read with its colour.
    let is_srgb = target.is_color() || target == TextureTarget::Opacity;
    Use {
        picture: reference.texture,
        target,
        is_flipped: false,
        picture_from_uv: reference.texture_from_mesh_uv,
        flags: flag(is_srgb, IS_SRGB)
            | flag(reference.filter == Filter::Nearest, IS_NEAREST)
            | flag(reference.uv_set == 1, IS_SECOND_SET)
            | wrap_flags(reference.wrap),
        scale: 1.0,
        offset: 0.0,
    }
}

fn wrap_flags(wrap: [Wrap; 2]) -> u32 {
    let [u, v] = wrap.map(|wrap| match wrap {
        Wrap::Repeat => WRAP_REPEAT,
        Wrap::MirroredRepeat => WRAP_MIRRORED,
        Wrap::ClampToEdge => WRAP_CLAMP,
    });
    u << WRAP_SHIFT | v << (WRAP_SHIFT + 2)
}

/// A use of a user's map with its index, whether it is translucent anywhere, and whether the slot's triangles have texture
/// coordinates.
pub(super) fn of_user_texture(
    assigned: &TextureAssignment,
    picture: usize,
    is_translucent: bool,
    has_coordinates: bool,
) -> Use {
    let TextureAssignment { target, texture, .. } = assigned;
    let is_srgb = texture.is_srgb(*target);
    let channel = match target.is_number() {
        true => 1 + texture.channel_of(*target, is_translucent),
        false => 0,
    };
    let is_normal = *target == TextureTarget::Normal;
    let flag = |is_on: bool, flag: u32| if is_on { flag } else { 0 };
    let [scale, offset] = match texture.inverted {
        _ if is_normal => [1.0, 0.0],
        true => [-texture.strength, 1.0],
        false => [texture.strength, 1.0 - texture.strength],
    };
    let side = match texture.projection {
        TextureProjection::First => 0,
        TextureProjection::Second => IS_SECOND_SET,
        TextureProjection::Box => IS_BOX,
        TextureProjection::Auto => flag(!has_coordinates, IS_BOX),
    };
    Use {
        picture,
        target: *target,
        is_flipped: assigned.is_flipped(),
        picture_from_uv: texture.picture_from_uv(),
        flags: flag(is_srgb, IS_SRGB) | flag(is_normal, TURNS_NORMALS) | side | channel << CHANNEL_SHIFT,
        scale,
        offset,
    }
}
