//! Packing of texture maps for the integrators.

use std::{borrow::Cow, path::Path, path::PathBuf, sync::Arc};

use super::{
    CHANNEL_SHIFT, IS_BOX, IS_FINE, IS_SRGB, TextureRecord,
    mean::{TextureMean, texture_mean},
    scale::{fraction, halved},
    user::{UserTexture, UserTextures},
    uses::{SlotUses, Use, flag, of_slot, of_user_texture},
};
use crate::{
    named::with_defaults,
    optics::{
        material::{NO_TEXTURE, VERTEX_BASE, VERTEX_EMISSION, VERTEX_OPACITY},
        target::{TARGETS, TextureTarget, TextureValues},
        tone::linear_from_srgb,
        vector::{Vec3, vec3},
    },
    scene::model::{AlphaMode, Model, Slot, Texture},
};

/// Words before the first texel: the linear values of sRGB codes.
const DECODED: usize = 256;
/// Largest number of texel words of a model: 128 MiB, which every Vulkan adapter can bind.
pub const WORDS_MAX: usize = 1 << 25;

/// Reader of users' texture maps; the flag is true for colours.
pub type Pictures<'a> = &'a dyn Fn(&Path, bool) -> Result<Arc<Texture>, String>;

/// A user's texture map, or the reason why it cannot be read.
#[derive(Clone, Debug, PartialEq)]
pub struct UserTextureFile {
    pub file: PathBuf,
    pub picture: Result<Arc<Texture>, String>,
    is_srgb: bool,
    /// Index among the packed maps, if readable.
    index: Option<usize>,
}

impl UserTextureFile {
    fn is_of(&self, texture: &UserTexture, target: TextureTarget) -> bool {
        self.file == texture.file && self.is_srgb == texture.is_srgb(target)
    }
}

/// Texture data of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Textures {
    /// Records of texture uses; never empty, since a GPU buffer cannot be.
    pub records: Vec<TextureRecord>,
    /// Decoded sRGB codes, then texels.
    pub words: Arc<Vec<u32>>,
    /// Textures per material slot.
    pub slots: Vec<SlotTextures>,
    /// Warnings on reduced and missing maps, one line each.
    pub warnings: Vec<String>,
    pub user_textures: Vec<UserTextureFile>,
}

with_defaults! {
    /// Textures of a slot.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct SlotTextures {
        /// Indices into [`Textures::records`] by target, or [`NO_TEXTURE`]. A map of one value is a constant instead.
        pub records: [u32; TARGETS] = [NO_TEXTURE; TARGETS],
        /// Values of maps of one value, by target: linear RGB, or a number in all three.
        pub constants: [Option<[f32; 3]>; TARGETS],
        /// Opacity cutoff of a masked material; negative for blended opacity.
        pub alpha_cutoff: f32 = -1.0,
        /// The emission texture's mean, linear.
        pub mean_emission: [f32; 3] = [1.0; 3],
        /// Parameters that vertex colours multiply, as material flags.
        pub vertex_flags: u32,
        /// Whether each target uses box projection.
        pub on_box: [bool; TARGETS],
    }
}

impl SlotTextures {
    /// A target's index into [`Textures::records`], or [`NO_TEXTURE`].
    pub fn record(&self, target: TextureTarget) -> u32 {
        self.records[target as usize]
    }

    /// Linear RGB of a target's map of one value; a number stands in all three.
    pub fn constant(&self, target: TextureTarget) -> Option<[f32; 3]> {
        self.constants[target as usize]
    }

    /// Without the textures of the other targets.
    pub fn only(mut self, is_on: impl Fn(TextureTarget) -> bool) -> Self {
        for target in TextureTarget::ALL.iter().filter(|target| !is_on(**target)) {
            let index = *target as usize;
            (self.records[index], self.constants[index], self.on_box[index]) = (NO_TEXTURE, None, false);
        }
        self
    }
}

/// Parameters that a slot's vertex colours multiply, as material flags.
fn vertex_flags(slot: &Slot) -> u32 {
    let of_color = if slot.is_unlit { VERTEX_EMISSION } else { VERTEX_BASE };
    let is_clear = slot.has_vertex_alpha && slot.alpha_mode != AlphaMode::Opaque;
    flag(slot.has_vertex_colors, of_color) | flag(is_clear, VERTEX_OPACITY)
}

/// Texels and properties of all used maps: everything that does not depend on their mapping.
#[derive(Debug)]
pub struct Pack {
    words: Arc<Vec<u32>>,
    pictures: Vec<Packed>,
    user_textures: Vec<UserTextureFile>,
    /// Whether the triangles of each slot have texture coordinates.
    has_coordinates: Vec<bool>,
    warnings: Vec<String>,
}

/// A packed map.
#[derive(Debug)]
struct Packed {
    size: [u32; 2],
    /// First texel by [`variant`].
    first_texels: [Option<u32>; 4],
    /// Uniform channels' values, in [0, 1].
    channels: [Option<f64>; 4],
    mean: Option<TextureMean>,
    is_translucent: bool,
    is_fine: bool,
}

/// Texels as they are packed: of 8 or of 16 bits, green as it is or upside down.
fn variant(is_fine: bool, is_flipped: bool) -> usize {
    usize::from(is_fine) + 2 * usize::from(is_flipped)
}

impl Pack {
    /// Packs the maps that a model's slots and the user's own for them need. If that is too much for a GPU, the largest maps
    /// are halved, with a warning.
    pub fn new(model: &Model, assigned: &[UserTextures], pictures: Pictures<'_>) -> Self {
        Self::within(model, assigned, pictures, WORDS_MAX)
    }

    fn within(model: &Model, assigned: &[UserTextures], read: Pictures<'_>, words_max: usize) -> Self {
        let mut warnings = Vec::new();
        let mut user_textures: Vec<UserTextureFile> = Vec::new();
        let mut count = model.textures.len();
        for (target, texture) in assigned.iter().flat_map(UserTextures::iter) {
            if user_textures.iter().any(|user| user.is_of(texture, target)) {
                continue;
            }
            let (file, is_srgb) = (texture.file.clone(), texture.is_srgb(target));
            let picture = read(&file, is_srgb);
            if let Err(why) = &picture {
                warnings.push(format!(
                    "{}: the {} texture can't be had: {why}; put the file there, or choose another",
                    file.display(),
                    target.label().to_lowercase()
                ));
            }
            let index = picture.is_ok().then_some(count);
            count += usize::from(picture.is_ok());
            user_textures.push(UserTextureFile {
                file,
                picture,
                is_srgb,
                index,
            });
        }
        let read: Vec<Arc<Texture>> = user_textures
            .iter()
            .filter_map(|user| user.picture.clone().ok())
            .collect();
        let all: Vec<&Texture> = model.textures.iter().chain(read.iter().map(Arc::as_ref)).collect();
        let mut pack = Self {
            words: Arc::default(),
            pictures: all.iter().map(|picture| Packed::of(picture)).collect(),
            user_textures,
            has_coordinates: slots_with_coordinates(model),
            warnings,
        };
        let uses: Vec<Use> = pack.uses(model, assigned).into_iter().flatten().flatten().collect();
        let fitted = fitting(
            model,
            (&all, &pack.pictures),
            &uses,
            words_max.saturating_sub(DECODED),
            &mut pack.warnings,
        );
        let mut words: Vec<u32> = decoded_codes().collect();
        for used in &uses {
            pack.pictures[used.picture].put(&fitted[used.picture], used, &mut words);
        }
        pack.words = Arc::new(words);
        pack
    }

    /// Warnings on reduced and missing maps, one line each.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.words[..])
    }

    /// Texture uses per slot. A user's map replaces the model's, even if unreadable.
    fn uses(&self, model: &Model, assigned: &[UserTextures]) -> Vec<SlotUses> {
        let is_translucent = |picture: usize| self.pictures[picture].is_translucent;
        let mut uses: Vec<SlotUses> = model.slots.iter().map(|slot| of_slot(slot, is_translucent)).collect();
        for ((uses, textures), has_coordinates) in uses.iter_mut().zip(assigned).zip(&self.has_coordinates) {
            for (target, texture) in textures.iter() {
                let user = self.user_textures.iter().find(|user| user.is_of(texture, target));
                uses[target as usize] = user.and_then(|user| user.index).map(|picture| {
                    of_user_texture(target, texture, picture, is_translucent(picture), *has_coordinates)
                });
            }
        }
        uses
    }

    /// Texture data for the same users' maps with any mapping.
    pub fn textures(&self, model: &Model, assigned: &[UserTextures]) -> Textures {
        let mut textures = Textures {
            records: Vec::new(),
            words: self.words.clone(),
            slots: Vec::new(),
            warnings: self.warnings.clone(),
            user_textures: self.user_textures.clone(),
        };
        for (slot, uses) in model.slots.iter().zip(self.uses(model, assigned)) {
            let mut packed = SlotTextures {
                vertex_flags: vertex_flags(slot),
                ..SlotTextures::default()
            };
            if slot.alpha_mode == AlphaMode::Mask {
                packed.alpha_cutoff = slot.alpha_cutoff.max(0.0);
            }
            for used in uses.iter().flatten() {
                self.look_up(used, &mut textures, &mut packed);
            }
            textures.slots.push(packed);
        }
        if textures.records.is_empty() {
            textures.records.push(TextureRecord::default());
        }
        textures
    }

    /// Assigns a map, or its uniform value, to a slot.
    fn look_up(&self, used: &Use, textures: &mut Textures, slot: &mut SlotTextures) {
        let picture = &self.pictures[used.picture];
        let is_vector = used.target.values() == TextureValues::Vector;
        let value = picture.one_value(used).filter(|_| !is_vector);
        let index = used.target as usize;
        slot.on_box[index] = value.is_none() && used.record.flags & IS_BOX != 0;
        slot.constants[index] = value.map(Vec3::to_f32);
        if value.is_none() {
            slot.records[index] = textures.add(picture.record(used));
        }
        if used.target == TextureTarget::Emission {
            slot.mean_emission = picture.mean(used);
        }
    }
}

impl Packed {
    fn of(picture: &Texture) -> Self {
        Self {
            size: [0; 2],
            first_texels: [None; 4],
            channels: [0, 1, 2, 3].map(|channel| one_value(picture, channel)),
            mean: None,
            is_translucent: picture.is_translucent(),
            is_fine: !picture.rgba16.is_empty(),
        }
    }

    fn is_fine_for(&self, used: &Use) -> bool {
        self.is_fine && used.record.flags & IS_SRGB == 0
    }

    /// Appends the texels for a use, unless they are there.
    fn put(&mut self, picture: &Texture, used: &Use, words: &mut Vec<u32>) {
        self.size = [picture.width, picture.height];
        if used.target == TextureTarget::Emission && self.mean.is_none() {
            self.mean = Some(texture_mean(picture));
        }
        let is_fine = self.is_fine_for(used);
        let first = &mut self.first_texels[variant(is_fine, used.is_flipped)];
        if first.is_some() {
            return;
        }
        *first = Some(words.len() as u32);
        // A flipped green channel counts from the other end.
        let green = if used.is_flipped { u16::MAX } else { 0 };
        if is_fine {
            let texels = picture.rgba16.as_chunks::<4>().0.iter();
            let pair = |low: u16, high: u16| u32::from(low) | u32::from(high) << 16;
            words.extend(texels.flat_map(|[r, g, b, a]| [pair(*r, g ^ green), pair(*b, *a)]));
        } else {
            let texels = picture.rgba8.as_chunks::<4>().0.iter();
            words.extend(texels.map(|[r, g, b, a]| u32::from_le_bytes([*r, g ^ green as u8, *b, *a])));
        }
    }

    fn record(&self, used: &Use) -> TextureRecord {
        let is_fine = self.is_fine_for(used);
        let [width, height] = self.size;
        TextureRecord {
            first_texel: self.first_texels[variant(is_fine, used.is_flipped)].unwrap_or_default(),
            width,
            height,
            flags: used.record.flags | flag(is_fine, IS_FINE),
            ..used.record
        }
    }

    /// Uniform value of a use, if any: linear RGB, or a scalar in all three.
    fn one_value(&self, used: &Use) -> Option<Vec3<f64>> {
        let is_srgb = used.record.flags & IS_SRGB != 0;
        let channel = |channel: usize| {
            let code = self.channels[channel]?;
            let is_code = is_srgb && channel < 3;
            Some(if is_code {
                linear_from_srgb(Vec3::splat(code)).x
            } else {
                code
            })
        };
        let counts = match (used.record.flags >> CHANNEL_SHIFT) & 7 {
            0 => match used.target.values() {
                TextureValues::Number(channel) => Some(channel),
                TextureValues::Color | TextureValues::Vector => None,
            },
            one => Some(one as usize - 1),
        };
        let value = match counts {
            Some(one) => Vec3::splat(channel(one)?),
            None => vec3(channel(0)?, channel(1)?, channel(2)?),
        };
        Some(value * f64::from(used.record.scale) + Vec3::splat(f64::from(used.record.offset)))
    }

    /// Mean value of a use, linear.
    fn mean(&self, used: &Use) -> [f32; 3] {
        self.mean.map_or([1.0; 3], |mean| {
            let [r, g, b, _] = mean.codes;
            let found = if used.record.flags & IS_SRGB != 0 {
                mean.linear
            } else {
                [r, g, b]
            };
            found.map(|x| x * used.record.scale + used.record.offset)
        })
    }
}

impl Default for Textures {
    fn default() -> Self {
        Self::new(&Model::default())
    }
}

impl Textures {
    /// Bytes in memory, the texels left out, which are the [`Pack`]'s.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.records[..])
    }

    /// Texture data of a model without assignments.
    pub fn new(model: &Model) -> Self {
        Self::within(model, WORDS_MAX)
    }

    /// The same within `words_max` words.
    pub fn within(model: &Model, words_max: usize) -> Self {
        let none = |_: &Path, _: bool| Err(String::new());
        Pack::within(model, &[], &none, words_max).textures(model, &[])
    }

    fn add(&mut self, record: TextureRecord) -> u32 {
        let known = self.records.iter().position(|known| *known == record);
        let place = known.unwrap_or_else(|| {
            self.records.push(record);
            self.records.len() - 1
        });
        place as u32
    }
}

fn decoded_codes() -> impl Iterator<Item = u32> {
    (0..DECODED).map(|code| (linear_from_srgb(Vec3::<f64>::splat(code as f64 / 255.0)).x as f32).to_bits())
}

/// Whether the triangles of each slot have texture coordinates: not the same ones at all corners.
pub fn slots_with_coordinates(model: &Model) -> Vec<bool> {
    let mut has = vec![false; model.slots.len()];
    for mesh in model.meshes() {
        for (triangle, slot) in mesh.triangles.iter().zip(&mesh.slots) {
            let Some(has) = has.get_mut(*slot as usize).filter(|has| !**has) else {
                continue;
            };
            let [a, b, c] = triangle.map(|vertex| mesh.uvs.get(vertex as usize));
            *has = a != b || b != c;
        }
    }
    has
}

/// Value in [0, 1] of a uniform channel.
fn one_value(picture: &Texture, channel: usize) -> Option<f64> {
    fn same<C: PartialEq>(texels: &[C], channel: usize) -> bool {
        let mut texels = texels.as_chunks::<4>().0.iter();
        let first = texels.next();
        first.is_some_and(|first| texels.all(|texel| texel[channel] == first[channel]))
    }
    let is_same = match picture.rgba16.is_empty() {
        true => same(&picture.rgba8, channel),
        false => same(&picture.rgba16, channel),
    };
    is_same.then(|| fraction(picture, channel))
}

/// The used maps (others empty), with the largest halved until all fit.
fn fitting<'a>(
    model: &Model,
    (pictures, packed): (&[&'a Texture], &[Packed]),
    uses: &[Use],
    words_max: usize,
    warnings: &mut Vec<String>,
) -> Vec<Cow<'a, Texture>> {
    let is_used = |index: usize| uses.iter().any(|used| used.picture == index);
    let is_color = |index: usize| {
        let mut of_it = uses.iter().filter(|used| used.picture == index);
        of_it.any(|used| used.record.flags & IS_SRGB != 0)
    };
    // A uniform map needs one texel.
    let used = |(index, picture): (usize, &&'a Texture)| {
        let is_one_value = packed[index].channels.iter().all(Option::is_some);
        let side = match is_one_value {
            _ if !is_used(index) => 0,
            true => 1,
            false => return Cow::Borrowed(*picture),
        };
        Cow::Owned(Texture {
            name: picture.name.clone(),
            width: side,
            height: side,
            rgba8: picture.rgba8[..4 * side as usize].to_vec(),
            rgba16: picture.rgba16.iter().take(4 * side as usize).copied().collect(),
        })
    };
    let mut fitted: Vec<Cow<'a, Texture>> = pictures.iter().enumerate().map(used).collect();
    let words = |picture: &Cow<'_, Texture>| match picture.rgba16.len() {
        0 => picture.rgba8.len() / 4,
        channels => channels / 2,
    };
    let whole: Vec<usize> = fitted.iter().map(words).collect();
    while fitted.iter().map(words).sum::<usize>() > words_max {
        let largest = (0..fitted.len()).max_by_key(|&index| words(&fitted[index]));
        let Some(index) = largest.filter(|&index| fitted[index].rgba8.len() > 4) else {
            break;
        };
        fitted[index] = Cow::Owned(halved(&fitted[index], is_color(index)));
    }
    for ((picture, original), whole) in fitted.iter().zip(pictures).zip(whole) {
        if words(picture) < whole {
            warnings.push(format!(
                "{}: the texture {} is used at {} × {} instead of {} × {}: together the textures are more than {} \
                 MiB; export smaller ones to choose which",
                model.name,
                picture.name,
                picture.width,
                picture.height,
                original.width,
                original.height,
                words_max.next_power_of_two() >> 18,
            ));
        }
    }
    fitted
}
