//! Texture uses of slots: the model's maps, and users' maps in their place.

use std::path::PathBuf;

use super::user::{TextureProjection, UserTexture};
use super::{CHANNEL_SHIFT, IS_BOX, IS_NEAREST, IS_SECOND_SET, IS_SRGB, TURNS_NORMALS, WRAP_SHIFT};
use crate::optics::target::TextureTarget;
use crate::scene::model::{Filter, Slot, TextureRef, Wrap};

/// A user's map assigned to a slot.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureAssignment {
    /// The number of the slot.
    pub slot: usize,
    /// Parameter that the map multiplies.
    pub target: TextureTarget,
    pub texture: UserTexture,
}

impl TextureAssignment {
    /// The map's file, and whether it is read as colours.
    pub fn picture(&self) -> (PathBuf, bool) {
        (self.texture.file.clone(), self.texture.is_srgb(self.target))
    }

    /// Whether green is read upside down.
    pub fn is_flipped(&self) -> bool {
        self.target.is_normal() && self.texture.inverted
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
    std::array::from_fn(|index| {
        let target = TextureTarget::ALL[index];
        let reference = slot.texture(target)?;
        let is_seen = target != TextureTarget::Opacity || is_translucent(reference.texture);
        let mut used = of_reference(target, &reference);
        if target == TextureTarget::FilmThickness {
            // From the least thickness to the largest.
            used.offset = slot.thinnest;
            used.scale = 1.0 - used.offset;
        }
        is_seen.then_some(used)
    })
}

fn of_reference(target: TextureTarget, reference: &TextureRef) -> Use {
    let flag = |is_on: bool, flag: u32| if is_on { flag } else { 0 };
    Use {
        picture: reference.texture,
        target,
        is_flipped: false,
        picture_from_uv: reference.texture_from_mesh_uv,
        // Opacity in a base colour map's alpha is read with its colour.
        flags: flag(target.home().is_color(), IS_SRGB)
            | flag(reference.filter == Filter::Nearest, IS_NEAREST)
            | flag(reference.uv_set == 1, IS_SECOND_SET)
            | wrap_flags(reference.wrap),
        scale: 1.0,
        offset: 0.0,
    }
}

fn wrap_flags([u, v]: [Wrap; 2]) -> u32 {
    (u as u32) << WRAP_SHIFT | (v as u32) << (WRAP_SHIFT + 2)
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
    let is_normal = target.is_normal();
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
