//! The pictures of a model as the integrators read them: all texels in one array, filtered by hand, so that both engines
//! find the same numbers. Twin of `shaders/scene/texture.wgsl`.
//!
//! Texels are RGBA of 8 bits in words of 32, or of 16 bits in two words each. The array begins with the linear values of the 256 sRGB codes as the bits of
//! f32: colours are decoded before they are filtered, by a look-up that has no rounding of its own.

use std::ops::Range;
use std::path::Path;

use bytemuck::{Pod, Zeroable};

use super::geometry::{Geometry, Vertex};
use super::model::{AlphaMode, Filter, Model, Slot, Texture, TextureRef, Wrap};
use super::picture::decode_bytes;
use super::texture_scale::{fraction, halved};
use crate::optics::albedo::table_lookup;
use crate::optics::material::{MATCHED_NODES, Material, NO_TEXTURE};
use crate::optics::real::Real;
use crate::optics::tone::linear_from_srgb;
use crate::optics::vector::{Vec3, vec3};

/// Words before the first texel: the linear values of sRGB codes.
const DECODED: usize = 256;
/// Words that a model's texels may take: what every Vulkan adapter binds at once, 128 MiB.
pub const WORDS_MAX: usize = 1 << 25;

/// [`TextureRecord::wrap`]: from the start again.
pub const WRAP_REPEAT: u32 = 0;
/// [`TextureRecord::wrap`]: back and forth.
pub const WRAP_MIRRORED: u32 = 1;
/// [`TextureRecord::wrap`]: the texel at the edge.
pub const WRAP_CLAMP: u32 = 2;
/// [`TextureRecord::flags`]: red, green and blue are sRGB codes.
pub const IS_SRGB: u32 = 1;
/// [`TextureRecord::flags`]: the nearest texel alone counts.
pub const IS_NEAREST: u32 = 2;
/// [`TextureRecord::flags`]: the second set of texture coordinates is meant.
pub const IS_SECOND_SET: u32 = 4;
/// [`TextureRecord::flags`]: channels have 16 bits, a texel two words.
pub const IS_FINE: u32 = 8;

/// One use of a picture. Three texels of four words on the GPU (`shaders/scene/texture.wgsl`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct TextureRecord {
    /// The place along u: the dot product with (u, v, 1).
    pub u_from_uv: [f32; 3],
    /// Where the texels begin, row by row from the top.
    pub first_texel: u32,
    /// The place along v.
    pub v_from_uv: [f32; 3],
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// How the texture goes on beyond its edges: along u, along v.
    pub wrap: [u32; 2],
    /// How its texels are read.
    pub flags: u32,
}

/// A model's textures.
#[derive(Clone, Debug, PartialEq)]
pub struct Textures {
    /// The uses of pictures; never empty, since a GPU's buffer cannot be.
    pub records: Vec<TextureRecord>,
    /// Decoded sRGB codes, then texels.
    pub words: Vec<u32>,
    /// What each of the model's slots looks up.
    pub slots: Vec<SlotTextures>,
    /// What had to be changed, one line each.
    pub warnings: Vec<String>,
}

/// What a slot looks up, as numbers of [`Textures::records`] or [`NO_TEXTURE`]. A picture of one value is a number, not
/// looked up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlotTextures {
    /// Multiplies the base colour.
    pub base_color: u32,
    /// Green multiplies the roughness, blue the metalness.
    pub metallic_roughness: u32,
    /// Tangent-space normals.
    pub normal: u32,
    /// Multiplies the emission.
    pub emission: u32,
    /// Its alpha multiplies the opacity.
    pub opacity: u32,
    /// The surface is there where its opacity reaches this; negative where the opacity is a share.
    pub alpha_cutoff: f32,
    /// The emission texture's mean, linear.
    pub mean_emission: [f32; 3],
    /// Linear RGB and alpha of a base colour texture of one value.
    pub constant_base_color: Option<[f32; 4]>,
    /// What a texture of one value multiplies roughness and metalness by.
    pub constant_roughness_metalness: Option<[f32; 2]>,
    /// Colours at the vertices multiply the base colour.
    pub has_vertex_colors: bool,
}

impl Default for SlotTextures {
    fn default() -> Self {
        Self {
            base_color: NO_TEXTURE,
            metallic_roughness: NO_TEXTURE,
            normal: NO_TEXTURE,
            emission: NO_TEXTURE,
            opacity: NO_TEXTURE,
            alpha_cutoff: -1.0,
            mean_emission: [1.0; 3],
            constant_base_color: None,
            constant_roughness_metalness: None,
            has_vertex_colors: false,
        }
    }
}

impl Default for Textures {
    fn default() -> Self {
        Self::new(&Model::default())
    }
}

impl Textures {
    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.records[..]) + size_of_val(&self.words[..])
    }

    /// Packs what a model's slots look up. Where that is too much for a GPU the largest pictures are halved, which the
    /// warnings say.
    pub fn new(model: &Model) -> Self {
        Self::within(model, WORDS_MAX)
    }

    /// The same within as many words.
    pub fn within(model: &Model, words_max: usize) -> Self {
        let decoded = (0..DECODED).map(|code| {
            let linear = linear_from_srgb(Vec3::<f64>::splat(code as f64 / 255.0)).x;
            (linear as f32).to_bits()
        });
        let mut textures = Self {
            records: Vec::new(),
            words: decoded.collect(),
            slots: Vec::new(),
            warnings: Vec::new(),
        };
        let pictures = fitting(model, words_max.saturating_sub(DECODED), &mut textures.warnings);
        let mut first_texels = vec![[None; 2]; pictures.len()];
        for slot in &model.slots {
            let constant = |reference: Option<TextureRef>, channels| {
                reference.and_then(|reference| one_value(&pictures[reference.texture], channels))
            };
            let base_color = constant(slot.base_color_texture, 0..4);
            let metallic_roughness = constant(slot.metallic_roughness_texture, 1..3);
            let mut add = |reference: Option<TextureRef>, is_srgb: bool| {
                reference.map_or(NO_TEXTURE, |reference| {
                    textures.add(&reference, &pictures[reference.texture], &mut first_texels, is_srgb)
                })
            };
            let looked_up = slot.base_color_texture.filter(|_| base_color.is_none());
            let base_color_record = add(looked_up, true);
            let looked_up = slot.metallic_roughness_texture.filter(|_| metallic_roughness.is_none());
            let packed = SlotTextures {
                base_color: base_color_record,
                metallic_roughness: add(looked_up, false),
                normal: add(slot.normal_texture, false),
                // Its mean is that value.
                emission: add(
                    slot.emissive_texture.filter(|e| constant(Some(*e), 0..3).is_none()),
                    true,
                ),
                opacity: if has_opacity(slot, &pictures) {
                    base_color_record
                } else {
                    NO_TEXTURE
                },
                constant_base_color: base_color.map(|[r, g, b, a]| {
                    let [r, g, b] = linear_from_srgb(vec3(r, g, b)).to_f64().map(|x| x as f32);
                    let is_opaque = slot.alpha_mode == AlphaMode::Opaque;
                    [r, g, b, if is_opaque { 1.0 } else { a as f32 }]
                }),
                constant_roughness_metalness: metallic_roughness
                    .map(|[_, roughness, metalness, _]| [roughness as f32, metalness as f32]),
                has_vertex_colors: slot.has_vertex_colors,
                alpha_cutoff: if slot.alpha_mode == AlphaMode::Mask {
                    slot.alpha_cutoff.max(0.0)
                } else {
                    -1.0
                },
                mean_emission: slot
                    .emissive_texture
                    .map_or([1.0; 3], |reference| mean_linear(&pictures[reference.texture])),
            };
            textures.slots.push(packed);
        }
        if textures.records.is_empty() {
            textures.records.push(TextureRecord::default());
        }
        textures
    }

    fn add(
        &mut self,
        reference: &TextureRef,
        picture: &Texture,
        first_texels: &mut [[Option<u32>; 2]],
        is_srgb: bool,
    ) -> u32 {
        let is_fine = !is_srgb && !picture.rgba16.is_empty();
        let first_texel = *first_texels[reference.texture][usize::from(is_fine)].get_or_insert_with(|| {
            let first = self.words.len() as u32;
            if is_fine {
                let pairs = picture.rgba16.as_chunks::<2>().0.iter();
                self.words
                    .extend(pairs.map(|[low, high]| u32::from(*low) | u32::from(*high) << 16));
            } else {
                let texels = picture.rgba8.as_chunks::<4>().0.iter();
                self.words.extend(texels.map(|texel| u32::from_le_bytes(*texel)));
            }
            first
        });
        let flag = |is_on: bool, flag: u32| if is_on { flag } else { 0 };
        let [uu, uv, u1, vu, vv, v1] = reference.texture_from_mesh_uv;
        let record = TextureRecord {
            u_from_uv: [uu, uv, u1],
            first_texel,
            v_from_uv: [vu, vv, v1],
            width: picture.width,
            height: picture.height,
            wrap: reference.wrap.map(|wrap| match wrap {
                Wrap::Repeat => WRAP_REPEAT,
                Wrap::MirroredRepeat => WRAP_MIRRORED,
                Wrap::ClampToEdge => WRAP_CLAMP,
            }),
            flags: flag(is_srgb, IS_SRGB)
                | flag(reference.filter == Filter::Nearest, IS_NEAREST)
                | flag(reference.uv_set == 1, IS_SECOND_SET)
                | flag(is_fine, IS_FINE),
        };
        let known = self.records.iter().position(|known| *known == record);
        let place = known.unwrap_or_else(|| {
            self.records.push(record);
            self.records.len() - 1
        });
        place as u32
    }
}

/// The value of a picture, each channel in [0, 1], where these channels are the same everywhere.
fn one_value(picture: &Texture, channels: Range<usize>) -> Option<[f64; 4]> {
    fn same<C: PartialEq>(texels: &[C], channels: Range<usize>) -> bool {
        let mut texels = texels.as_chunks::<4>().0.iter();
        let first = texels.next();
        first.is_some_and(|first| texels.all(|texel| texel[channels.clone()] == first[channels.clone()]))
    }
    let is_same = match picture.rgba16.is_empty() {
        true => same(&picture.rgba8, channels),
        false => same(&picture.rgba16, channels),
    };
    is_same.then(|| [0, 1, 2, 3].map(|channel| fraction(picture, channel)))
}

/// Whether the base colour's picture says where a slot's surface is.
fn has_opacity(slot: &Slot, pictures: &[Texture]) -> bool {
    let is_translucent = |reference: TextureRef| {
        let picture = &pictures[reference.texture];
        picture.rgba8.iter().skip(3).step_by(4).any(|alpha| *alpha < 255)
    };
    slot.alpha_mode != AlphaMode::Opaque && slot.base_color_texture.is_some_and(is_translucent)
}

/// The pictures that slots look up (those that none does without texels), the largest halved until all fit.
fn fitting(model: &Model, words_max: usize, warnings: &mut Vec<String>) -> Vec<Texture> {
    let uses = |index: usize| {
        model
            .slots
            .iter()
            .any(|slot| slot.texture_refs().any(|r| r.texture == index))
    };
    let is_color = |index: usize| {
        let colors = |slot: &Slot| [slot.base_color_texture, slot.emissive_texture];
        let mut references = model.slots.iter().flat_map(colors).flatten();
        references.any(|reference| reference.texture == index)
    };
    // One texel does where all are the same.
    let used = |(index, picture): (usize, &Texture)| {
        let side = match one_value(picture, 0..4) {
            _ if !uses(index) => 0,
            Some(_) => 1,
            None => return picture.clone(),
        };
        Texture {
            name: picture.name.clone(),
            width: side,
            height: side,
            rgba8: picture.rgba8[..4 * side as usize].to_vec(),
            rgba16: picture.rgba16.iter().take(4 * side as usize).copied().collect(),
        }
    };
    let mut pictures: Vec<Texture> = model.textures.iter().enumerate().map(used).collect();
    let words = |picture: &Texture| match picture.rgba16.len() {
        0 => picture.rgba8.len() / 4,
        channels => channels / 2,
    };
    let whole: Vec<usize> = pictures.iter().map(words).collect();
    while pictures.iter().map(words).sum::<usize>() > words_max {
        let largest = (0..pictures.len()).max_by_key(|&index| words(&pictures[index]));
        let Some(index) = largest.filter(|&index| pictures[index].rgba8.len() > 4) else {
            break;
        };
        pictures[index] = halved(&pictures[index], is_color(index));
    }
    for ((picture, original), whole) in pictures.iter().zip(&model.textures).zip(whole) {
        if words(picture) < whole {
            warnings.push(format!(
                "{}: the picture {} is used at {} × {} instead of {} × {}: together the pictures are more than {} \
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
    pictures
}

/// The mean of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureMean {
    /// Of its codes, in [0, 1].
    pub codes: [f32; 4],
    /// Of the light that its codes stand for as sRGB.
    pub linear: [f32; 3],
}

/// The mean of a picture.
pub fn texture_mean(picture: &Texture) -> TextureMean {
    let mut sums = [0_u64; 4];
    for texel in picture.rgba8.as_chunks::<4>().0 {
        sums.iter_mut()
            .zip(texel)
            .for_each(|(sum, code)| *sum += u64::from(*code));
    }
    let texels = (picture.rgba8.len() / 4).max(1) as f64;
    TextureMean {
        codes: sums.map(|sum| (sum as f64 / (255.0 * texels)) as f32),
        linear: mean_linear(picture),
    }
}

/// The mean of a picture in a file.
///
/// # Errors
/// What is wrong with the file.
pub fn mean_of_file(path: &Path) -> Result<TextureMean, String> {
    let bytes = std::fs::read(path).map_err(|error| error.to_string())?;
    Ok(texture_mean(&decode_bytes(String::new(), &bytes)?.texture(true)))
}

/// The mean of a picture of sRGB codes, linear.
fn mean_linear(picture: &Texture) -> [f32; 3] {
    let mut counts = [[0u32; DECODED]; 3];
    for texel in picture.rgba8.as_chunks::<4>().0 {
        for (counts, code) in counts.iter_mut().zip(texel) {
            counts[usize::from(*code)] += 1;
        }
    }
    let texels = (picture.rgba8.len() / 4).max(1) as f64;
    counts.map(|counts| {
        let linear = |code: usize| linear_from_srgb(Vec3::<f64>::splat(code as f64 / 255.0)).x;
        let sum: f64 = (0..DECODED).map(|code| f64::from(counts[code]) * linear(code)).sum();
        (sum / texels) as f32
    })
}

/// Red, green, blue (linear) and alpha of a texture at a surface point with these two sets of texture coordinates.
pub fn texture_lookup<T: Real>(textures: &Textures, index: u32, uvs: [[T; 2]; 2]) -> (Vec3<T>, T) {
    let record = &textures.records[index as usize];
    let [u, v] = uvs[usize::from(record.flags & IS_SECOND_SET != 0)];
    let along = |row: [f32; 3]| {
        let [a, b, c] = row.map(|x| T::from_f64(f64::from(x)));
        a * u + b * v + c
    };
    let [width, height] = [record.width, record.height].map(|size| T::from_f64(f64::from(size)));
    let x = wrapped(along(record.u_from_uv), record.wrap[0]) * width;
    let y = wrapped(along(record.v_from_uv), record.wrap[1]) * height;
    if record.flags & IS_NEAREST != 0 {
        let place = |x: T, size: u32| (x.to_f64() as u32).min(size - 1);
        return texel(textures, record, place(x, record.width), place(y, record.height));
    }
    let half = T::from_f64(0.5);
    let (left, top) = ((x - half).floor(), (y - half).floor());
    let columns = neighbours(left, record.width, record.wrap[0]);
    let rows = neighbours(top, record.height, record.wrap[1]);
    let (fx, fy) = (x - half - left, y - half - top);
    let mix = |(a, a1): (Vec3<T>, T), (b, b1): (Vec3<T>, T), t: T| (a.mix(b, t), a1 + (b1 - a1) * t);
    let [above, below] = rows.map(|row| {
        let [a, b] = columns.map(|column| texel(textures, record, column, row));
        mix(a, b, fx)
    });
    mix(above, below, fy)
}

/// A place along one side of a texture, brought into [0, 1].
pub fn wrapped<T: Real>(place: T, wrap: u32) -> T {
    match wrap {
        WRAP_CLAMP => place.clamp(T::zero(), T::one()),
        WRAP_MIRRORED => {
            let two = T::from_f64(2.0);
            let turn = place - two * (place / two).floor();
            turn.min(two - turn)
        }
        _ => place - place.floor(),
    }
}

/// The texels on both sides of a place, whose left one is `low` (from −1 on).
fn neighbours<T: Real>(low: T, size: u32, wrap: u32) -> [u32; 2] {
    let last = size - 1;
    let low = low.to_f64();
    let is_first = low < 0.0;
    let left = (low.max(0.0) as u32).min(last);
    let right = if is_first { 0 } else { (left + 1).min(last) };
    if wrap == WRAP_REPEAT {
        return [
            if is_first { last } else { left },
            if left == last && !is_first { 0 } else { right },
        ];
    }
    [left, right]
}

fn texel<T: Real>(textures: &Textures, record: &TextureRecord, column: u32, row: u32) -> (Vec3<T>, T) {
    let place = row * record.width + column;
    if record.flags & IS_FINE != 0 {
        let first = (record.first_texel + 2 * place) as usize;
        let fraction = |code: u32| T::from_f64(f64::from((code & 0xffff) as f32 / 65535.0));
        let [rg, ba] = [textures.words[first], textures.words[first + 1]];
        return (vec3(fraction(rg), fraction(rg >> 16), fraction(ba)), fraction(ba >> 16));
    }
    let word = textures.words[(record.first_texel + place) as usize];
    let [r, g, b, a] = word.to_le_bytes();
    let channel = |code: u8| {
        let linear = if record.flags & IS_SRGB != 0 {
            f32::from_bits(textures.words[usize::from(code)])
        } else {
            f32::from(code) / 255.0
        };
        T::from_f64(f64::from(linear))
    };
    (
        vec3(channel(r), channel(g), channel(b)),
        T::from_f64(f64::from(f32::from(a) / 255.0)),
    )
}

/// Both sets of texture coordinates at a place of a triangle, given by the weights of its corners.
#[inline(always)]
pub fn uvs_at<T: Real>(geometry: &Geometry, triangle: usize, weights: [T; 3]) -> [[T; 2]; 2] {
    let corners = geometry.triangles[triangle].map(|vertex| &geometry.vertices[vertex as usize]);
    let sum = |number: &dyn Fn(&Vertex) -> f32| {
        let part = |i: usize| T::from_f64(f64::from(number(corners[i]))) * weights[i];
        part(0) + part(1) + part(2)
    };
    [
        [0, 1].map(|i| sum(&|vertex| vertex.uv[i])),
        [0, 1].map(|i| sum(&|vertex| vertex.second_uv[i])),
    ]
}

/// The material at a surface point: what its textures say and the colour between its vertices multiplied in.
/// `tables` holds all materials' tables.
pub fn textured_material<T: Real>(
    textures: &Textures,
    tables: &[f32],
    material: &Material<T>,
    uvs: [[T; 2]; 2],
    vertex_color: Vec3<T>,
) -> Material<T> {
    let mut at_point = *material;
    at_point.base_color = material.base_color * vertex_color;
    at_point.transmission_tint = material.transmission_tint * vertex_color;
    let [base_color, metallic_roughness, _, emission] = material.textures;
    if base_color != NO_TEXTURE {
        let (color, _) = texture_lookup(textures, base_color, uvs);
        at_point.base_color = at_point.base_color * color;
        at_point.transmission_tint = at_point.transmission_tint * color;
    }
    if metallic_roughness != NO_TEXTURE {
        let (values, _) = texture_lookup(textures, metallic_roughness, uvs);
        at_point.metalness = material.metalness * values.z;
        at_point.roughness = material.texture_roughness * values.y;
        if material.roughness_table != NO_TEXTURE {
            at_point.roughness = table_lookup(tables, material.roughness_table, MATCHED_NODES, at_point.roughness);
        }
        // What the refraction is rougher by stays.
        let rough = material.transmission_roughness + (at_point.roughness - material.roughness);
        at_point.transmission_roughness = rough.clamp(T::zero(), T::one());
    }
    if emission != NO_TEXTURE {
        at_point.emission = material.emission * texture_lookup(textures, emission, uvs).0;
    }
    at_point
}

/// What a surface point emits, linear RGB, its holes left out.
pub fn emission_at<T: Real>(textures: &Textures, material: &Material<T>, uvs: [[T; 2]; 2]) -> Vec3<T> {
    let share = if material.has_holes() {
        opacity_at(textures, material, uvs)
    } else {
        T::one()
    };
    let emission = material.textures[3];
    if emission == NO_TEXTURE {
        return material.emission * share;
    }
    material.emission * texture_lookup(textures, emission, uvs).0 * share
}

/// The share of light that a surface point stops, in [0, 1].
pub fn opacity_at<T: Real>(textures: &Textures, material: &Material<T>, uvs: [[T; 2]; 2]) -> T {
    let mut opacity = material.opacity;
    if material.opacity_texture != NO_TEXTURE {
        opacity = opacity * texture_lookup(textures, material.opacity_texture, uvs).1;
    }
    let cutoff = material.alpha_cutoff;
    let masked = T::select(opacity.less(cutoff), T::zero(), T::one());
    T::select(cutoff.less(T::zero()), opacity, masked)
}

/// The normal that a normal texture gives, in world space. `tangent` and the sign of the bitangent as the geometry has
/// them, `normal` the interpolated one; the plain normal where the texture says nothing.
pub fn mapped_normal<T: Real>(
    textures: &Textures,
    material: &Material<T>,
    uvs: [[T; 2]; 2],
    [normal, tangent]: [Vec3<T>; 2],
    sign: T,
) -> Vec3<T> {
    let (texel, _) = texture_lookup(textures, material.textures[2], uvs);
    let signed = |x: T| T::from_f64(2.0) * x - T::one();
    let (x, y) = (
        signed(texel.x) * material.normal_strength,
        signed(texel.y) * material.normal_strength,
    );
    let along = crate::optics::frame::frame_from_tangent(normal, tangent, T::zero());
    let bitangent = along.bitangent * T::select(sign.less(T::zero()), -T::one(), T::one());
    // What points into the surface is laid down on it.
    let up = signed(texel.z).max(T::zero());
    let mapped = along.tangent * x + bitangent * y + normal * up;
    crate::optics::numeric::normalize_or(mapped, normal)
}
