//! Texture uses of slots: the model's maps, and users' maps in their place.

use super::{
    CHANNEL_SHIFT, IS_BOX, IS_NEAREST, IS_SECOND_SET, IS_SRGB, TURNS_NORMALS, TextureRecord, WRAP_SHIFT,
    user::{TextureProjection, UserTexture},
};
use crate::optics::target::{TARGETS, TextureTarget};
use crate::scene::model::{Filter, Slot, TextureRef};

/// One use of a texture map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Use {
    /// Index among the packed maps.
    pub picture: usize,
    /// Material parameter that it varies.
    pub target: TextureTarget,
    /// True if its green channel points down.
    pub is_flipped: bool,
    /// All but where its texels are, and the channels' width.
    pub record: TextureRecord,
}

/// The uses of a slot, by target.
pub type SlotUses = [Option<Use>; TARGETS];

/// A slot's uses of its model's maps.
pub fn of_slot(slot: &Slot, is_translucent: impl Fn(usize) -> bool) -> SlotUses {
    std::array::from_fn(|index| {
        let target = TextureTarget::ALL[index];
        let reference = slot.texture(target)?;
        let is_seen = target != TextureTarget::Opacity || is_translucent(reference.texture);
        let mut used = of_reference(target, &reference);
        if target == TextureTarget::FilmThickness {
            // From the least thickness to the largest.
            used.record.offset = slot.thinnest;
            used.record.scale = 1.0 - slot.thinnest;
        }
        is_seen.then_some(used)
    })
}

fn of_reference(target: TextureTarget, reference: &TextureRef) -> Use {
    let [u, v] = reference.wrap;
    Use {
        picture: reference.texture,
        target,
        is_flipped: false,
        record: TextureRecord {
            // Opacity in a base colour map's alpha is read with its colour.
            flags: flag(target.home().is_color(), IS_SRGB)
                | flag(reference.filter == Filter::Nearest, IS_NEAREST)
                | flag(reference.uv_set == 1, IS_SECOND_SET)
                | (u as u32) << WRAP_SHIFT
                | (v as u32) << (WRAP_SHIFT + 2),
            scale: 1.0,
            ..placed(reference.texture_from_mesh_uv)
        },
    }
}

/// A record with rows of (u, v, 1).
fn placed([uu, uv, u1, vu, vv, v1]: [f32; 6]) -> TextureRecord {
    TextureRecord {
        u_from_uv: [uu, uv, u1],
        v_from_uv: [vu, vv, v1],
        ..TextureRecord::default()
    }
}

/// A use of a user's map with its index, whether it is translucent anywhere, and whether the slot's triangles have texture
/// coordinates.
pub fn of_user_texture(
    target: TextureTarget,
    texture: &UserTexture,
    picture: usize,
    is_translucent: bool,
    has_coordinates: bool,
) -> Use {
    let is_srgb = texture.is_srgb(target);
    let channel = match target.is_number() {
        true => 1 + texture.channel_of(target, is_translucent),
        false => 0,
    };
    let is_normal = target.is_normal();
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
        target,
        is_flipped: texture.is_flipped(target),
        record: TextureRecord {
            flags: flag(is_srgb, IS_SRGB) | flag(is_normal, TURNS_NORMALS) | side | channel << CHANNEL_SHIFT,
            scale,
            offset,
            ..placed(texture.picture_from_uv())
        },
    }
}

/// The flag where it is on.
pub fn flag(is_on: bool, flag: u32) -> u32 {
    if is_on { flag } else { 0 }
}
