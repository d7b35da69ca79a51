//! Texture maps as the integrators read them: all texels in one array, filtered in software, so that both engines get the
//! same numbers. Twin of `shaders/scene/texture.wgsl`.
//!
//! Texels are RGBA, 8 bits each in one word or 16 bits each in two. The array starts with the linear values of the 256 sRGB
//! codes as bits of f32: colours are decoded before filtering, by a look-up without rounding of its own.

mod mean;
mod pack;
pub mod scale;
pub mod set;
mod user;
mod uses;

use bytemuck::{Pod, Zeroable};

use super::{geometry::Geometry, part::Vertex, triangle_normal};
use crate::optics::prelude::*;
use crate::optics::{
    frame::frame_from_tangent,
    layer::fuzz::FUZZ_ROUGHNESS_MIN,
    material::{MATCHED_NODES, Material, NO_TEXTURE, VERTEX_BASE, VERTEX_EMISSION, VERTEX_OPACITY},
    numeric::normalize_or,
    table::table_lookup,
    target::TextureTarget as On,
};

pub use crate::optics::target::{TextureTarget, TextureValues};
pub use mean::{TextureMean, texture_mean};
pub use pack::{Pack, Pictures, SlotTextures, Textures, UserTextureFile, WORDS_MAX, slots_with_coordinates};
pub use user::{SHIPPED, TextureChannel, TextureProjection, TextureSpace, UserTexture, UserTextures};

pub const WRAP_REPEAT: u32 = 0;
pub const WRAP_MIRRORED: u32 = 1;
/// The texel at the edge.
pub const WRAP_CLAMP: u32 = 2;
/// [`TextureRecord::flags`]: red, green and blue are sRGB codes.
pub const IS_SRGB: u32 = 1;
/// [`TextureRecord::flags`]: the nearest texel alone counts.
pub const IS_NEAREST: u32 = 2;
/// [`TextureRecord::flags`]: the second set of texture coordinates is meant.
pub const IS_SECOND_SET: u32 = 4;
/// [`TextureRecord::flags`]: channels have 16 bits, a texel two words.
pub const IS_FINE: u32 = 8;
/// [`TextureRecord::flags`]: box projection.
pub const IS_BOX: u32 = 16;
/// [`TextureRecord::flags`]: normals rotate with their map.
pub const TURNS_NORMALS: u32 = 32;
/// [`TextureRecord::flags`]: shift of the selected channel plus 1; 0 for all channels.
pub const CHANNEL_SHIFT: u32 = 8;
/// [`TextureRecord::flags`]: shift of the wrap mode along u; that along v is two bits further.
pub const WRAP_SHIFT: u32 = 16;

/// One use of a texture map. Three texels of four words on the GPU (`shaders/scene/texture.wgsl`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct TextureRecord {
    /// The place along u: the dot product with (u, v, 1).
    pub u_from_uv: [f32; 3],
    /// First texel; rows from the top.
    pub first_texel: u32,
    /// The place along v.
    pub v_from_uv: [f32; 3],
    pub width: u32,
    pub height: u32,
    /// Flags of filtering and format.
    pub flags: u32,
    /// Factor of the filtered value.
    pub scale: f32,
    /// Then this is added.
    pub offset: f32,
}

/// Texture coordinates of a surface point: both sets, and those by box projection.
pub type Uvs<T> = [[T; 2]; 3];

/// Value of a texture use at a surface point: linear RGB and alpha; one channel is repeated four times.
pub fn texture_lookup<T: Scalar>(textures: &Textures, index: u32, uvs: Uvs<T>) -> (Vec3<T>, T) {
    let record = &textures.records[index as usize];
    let (color, alpha) = filtered(textures, record, uvs);
    let (color, alpha) = match (record.flags >> CHANNEL_SHIFT) & 7 {
        0 => (color, alpha),
        1 => (Vec3::splat(color.x), color.x),
        2 => (Vec3::splat(color.y), color.y),
        3 => (Vec3::splat(color.z), color.z),
        _ => (Vec3::splat(alpha), alpha),
    };
    let [scale, offset] = [record.scale, record.offset].map(|x| T::from_f64(f64::from(x)));
    (color * scale + Vec3::splat(offset), alpha * scale + offset)
}

/// Value of a target's texture at a surface point, if there is one.
fn material_lookup<T: Scalar>(
    textures: &Textures,
    material: &Material<T>,
    target: TextureTarget,
    uvs: Uvs<T>,
) -> Option<(Vec3<T>, T)> {
    let index = material.texture(target);
    (index != NO_TEXTURE).then(|| texture_lookup(textures, index, uvs))
}

/// Filtered texture map at a surface point: linear RGB and alpha.
fn filtered<T: Scalar>(textures: &Textures, record: &TextureRecord, uvs: Uvs<T>) -> (Vec3<T>, T) {
    let [u, v] = match record.flags & (IS_SECOND_SET | IS_BOX) {
        0 => uvs[0],
        IS_SECOND_SET => uvs[1],
        _ => uvs[2],
    };
    let along = |row: [f32; 3]| {
        let [a, b, c] = row.map(|x| T::from_f64(f64::from(x)));
        a * u + b * v + c
    };
    let wrap = [0, 2].map(|shift| (record.flags >> (WRAP_SHIFT + shift)) & 3);
    let [width, height] = [record.width, record.height].map(|size| T::from_f64(f64::from(size)));
    let x = wrapped(along(record.u_from_uv), wrap[0]) * width;
    let y = wrapped(along(record.v_from_uv), wrap[1]) * height;
    if record.flags & IS_NEAREST != 0 {
        let place = |x: T, size: u32| (x.to_f64() as u32).min(size - 1);
        return texel(textures, record, place(x, record.width), place(y, record.height));
    }
    let half = T::HALF;
    let (left, top) = ((x - half).floor(), (y - half).floor());
    let columns = neighbours(left, record.width, wrap[0]);
    let rows = neighbours(top, record.height, wrap[1]);
    let (fx, fy) = (x - half - left, y - half - top);
    let [above, below] = rows.map(|row| {
        let [a, b] = columns.map(|column| texel(textures, record, column, row));
        mix_texels(a, b, fx)
    });
    mix_texels(above, below, fy)
}

/// Linear interpolation of two texels.
fn mix_texels<T: Scalar>((a, a_alpha): (Vec3<T>, T), (b, b_alpha): (Vec3<T>, T), t: T) -> (Vec3<T>, T) {
    (a.mix(b, t), a_alpha + (b_alpha - a_alpha) * t)
}

/// A place along one side of a texture, brought into [0, 1].
pub fn wrapped<T: Scalar>(place: T, wrap: u32) -> T {
    match wrap {
        WRAP_CLAMP => place.clamp(T::ZERO, T::ONE),
        WRAP_MIRRORED => {
            let two = T::TWO;
            let turn = place - two * (place / two).floor();
            turn.min(two - turn)
        }
        _ => place - place.floor(),
    }
}

/// The texels on both sides of a place, whose left one is `low` (from −1 on).
fn neighbours<T: Scalar>(low: T, size: u32, wrap: u32) -> [u32; 2] {
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

fn texel<T: Scalar>(textures: &Textures, record: &TextureRecord, column: u32, row: u32) -> (Vec3<T>, T) {
    let place = row * record.width + column;
    if record.flags & IS_FINE != 0 {
        let first = (record.first_texel + 2 * place) as usize;
        let fraction = |code: u32| T::from_f64(f64::from((code & 0xffff) as f32 / 65535.0));
        let [rg, ba] = [textures.words[first], textures.words[first + 1]];
        return (vec3(fraction(rg), fraction(rg >> 16), fraction(ba)), fraction(ba >> 16));
    }
    let [r, g, b, a] = textures.words[(record.first_texel + place) as usize].to_le_bytes();
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

/// Texture coordinates at the barycentric weights of a triangle; box projection only if `has_box`.
pub fn uvs_at<T: Scalar>(geometry: &Geometry, triangle: usize, weights: [T; 3], has_box: bool) -> Uvs<T> {
    let corners = geometry.vertices(triangle);
    let sum = |number: &dyn Fn(&Vertex) -> f32| {
        let part = |i: usize| T::from_f64(f64::from(number(corners[i]))) * weights[i];
        part(0) + part(1) + part(2)
    };
    [
        [0, 1].map(|i| sum(&|vertex| vertex.uvs[i])),
        [2, 3].map(|i| sum(&|vertex| vertex.uvs[i])),
        if has_box {
            let between = |[a, b, c]: [Vec3<T>; 3]| a * weights[0] + b * weights[1] + c * weights[2];
            let places = geometry.corners(triangle).map(Vec3::from_f32);
            let smooth = between(geometry.normals(triangle).map(Vec3::from_f32));
            box_uv(between(places), normalize_or(smooth, triangle_normal(places)))
        } else {
            [T::ZERO; 2]
        },
    ]
}

/// Horizontal axis of the box side that a surface with this normal faces: seen from outside, with +Y up, and −Z up on top.
pub fn box_right<T: Scalar>(normal: Vec3<T>) -> Vec3<T> {
    let [x, y, z] = normal.to_f64();
    let axis = |x: f64, z: f64| vec3(T::from_f64(x), T::ZERO, T::from_f64(z));
    if x.abs() >= y.abs() && x.abs() >= z.abs() {
        axis(0.0, if x < 0.0 { 1.0 } else { -1.0 })
    } else if y.abs() >= z.abs() {
        axis(1.0, 0.0)
    } else {
        axis(if z < 0.0 { -1.0 } else { 1.0 }, 0.0)
    }
}

/// Coordinates of a position on the box side that it faces, v downwards. The box reaches from −1 to 1 in bounding radii of
/// the model.
fn box_uv<T: Scalar>(position: Vec3<T>, normal: Vec3<T>) -> [T; 2] {
    let [x, y, z] = normal.to_f64();
    let is_level = y.abs() > x.abs() && y.abs() >= z.abs();
    let down = match is_level {
        true if y < 0.0 => -position.z,
        true => position.z,
        false => -position.y,
    };
    let half = T::HALF;
    [box_right(normal).dot(position) * half + half, down * half + half]
}

/// Materials at surface points, all of one slot, with textures and vertex colours applied. `tables` holds all materials' tables.
#[inline(always)]
pub fn textured_material<T: Real>(
    textures: &Textures,
    tables: &[f32],
    material: &Material<T>,
    uvs: &T::Each<Uvs<T::Scalar>>,
    vertex_color: Vec3<T>,
) -> Material<T> {
    let mut at_point = *material;
    if material.has_flag(VERTEX_BASE) {
        at_point.base_color = material.base_color * vertex_color;
        at_point.transmission_tint = material.transmission_tint * vertex_color;
    }
    if material.has_flag(VERTEX_EMISSION) {
        at_point.emission = material.emission * vertex_color;
    }
    multiply_by(textures, TextureTarget::ALL, uvs, &mut at_point);
    at_point.fuzz_roughness = at_point.fuzz_roughness.max(T::from_f64(FUZZ_ROUGHNESS_MIN));
    at_point.follow_coat();
    if material.has_texture(&[On::Roughness]) || material.has_varied_blur() {
        at_point.roughness = at_point.ggx_roughness;
        if material.has_varied_blur() {
            at_point.roughness = at_point.roughness_under_coat(at_point.roughness, at_point.coat_weight);
        }
        if material.roughness_table != NO_TEXTURE {
            at_point.roughness = table_lookup(tables, material.roughness_table, MATCHED_NODES, at_point.roughness);
        }
        // The refraction keeps its extra roughness.
        let rough = at_point.roughness + (material.transmission_roughness - material.roughness);
        at_point.transmission_roughness = rough.clamp(T::ZERO, T::ONE);
    }
    at_point
}

/// Multiplies the parameters of some targets by their textures at surface points.
#[inline(always)]
pub fn multiply_by<T: Real>(
    textures: &Textures,
    targets: &[TextureTarget],
    uvs: &T::Each<Uvs<T::Scalar>>,
    material: &mut Material<T>,
) {
    // A texture of targets in a row is looked up once.
    let mut known = NO_TEXTURE;
    let mut found = T::each(|_| Default::default());
    for &target in targets.iter().filter(|target| !target.fields().is_empty()) {
        let texture = material.texture(target);
        if texture == NO_TEXTURE {
            continue;
        }
        if texture != known {
            known = texture;
            found = T::each(|lane| texture_lookup::<T::Scalar>(textures, texture, uvs[lane]));
        }
        let color = Vec3::from_lanes(|lane| found[lane].0);
        material.multiply(target, color, T::from_lanes(|lane| found[lane].1));
    }
}

/// Factors of emission and opacity that the vertices of a triangle give a place on it.
pub fn vertex_factors<T: Scalar>(
    geometry: &Geometry,
    material: &Material<T>,
    triangle: usize,
    weights: [T; 3],
) -> (Vec3<T>, T) {
    let (mut color, mut alpha) = (Vec3::ONE, T::ONE);
    if !material.has_flag(VERTEX_EMISSION | VERTEX_OPACITY) {
        return (color, alpha);
    }
    let corners = geometry.vertices(triangle);
    if material.has_flag(VERTEX_EMISSION) {
        let [a, b, c] = corners.map(|corner| Vec3::from_f32(corner.rgb()));
        color = a * weights[0] + b * weights[1] + c * weights[2];
    }
    if material.has_flag(VERTEX_OPACITY) {
        let [a, b, c] = corners.map(|corner| T::from_f64(f64::from(corner.alpha())));
        alpha = a * weights[0] + b * weights[1] + c * weights[2];
    }
    (color, alpha)
}

/// Emission at a surface point times its opacity, linear RGB; `of_vertices` from [`vertex_factors`].
pub fn emission_at<T: Scalar>(
    textures: &Textures,
    material: &Material<T>,
    uvs: Uvs<T>,
    of_vertices: (Vec3<T>, T),
) -> Vec3<T> {
    let (color, alpha) = of_vertices;
    let share = if material.has_holes() {
        opacity_at(textures, material, uvs, alpha)
    } else {
        T::ONE
    };
    let radiance = material.emission * color * share;
    match material_lookup(textures, material, On::Emission, uvs) {
        Some((emission, _)) => radiance * emission,
        None => radiance,
    }
}

/// The share of light that a surface point stops, in [0, 1]; `alpha` is that of the vertices.
pub fn opacity_at<T: Scalar>(textures: &Textures, material: &Material<T>, uvs: Uvs<T>, alpha: T) -> T {
    let mut opacity = material.opacity * alpha;
    if let Some((_, alpha)) = material_lookup(textures, material, On::Opacity, uvs) {
        opacity = opacity * alpha;
    }
    stopped_share(material, opacity)
}

/// Effective opacity of a surface point: 0 or 1 for a masked material.
fn stopped_share<T: Scalar>(material: &Material<T>, opacity: T) -> T {
    let cutoff = material.alpha_cutoff;
    T::select(
        cutoff.below_zero(),
        opacity,
        T::select(opacity.less(cutoff), T::ZERO, T::ONE),
    )
}

/// The normal of a normal map, in world space. `tangent` and the bitangent's sign are the geometry's, `normal` the
/// interpolated one, `outward` the same on the front. `strength` scales the map's slopes.
pub fn mapped_normal<T: Scalar>(
    textures: &Textures,
    (texture, strength): (u32, T),
    uvs: Uvs<T>,
    [normal, tangent, outward]: [Vec3<T>; 3],
    sign: T,
) -> Vec3<T> {
    let record = &textures.records[texture as usize];
    let (texel, _) = filtered(textures, record, uvs);
    let signed = |x: T| T::TWO * x - T::ONE;
    let (mut x, mut y) = (signed(texel.x) * strength, signed(texel.y) * strength);
    if record.flags & TURNS_NORMALS != 0 {
        let [a, b, _] = record.u_from_uv.map(|x| T::from_f64(f64::from(x)));
        let length = (a * a + b * b).sqrt();
        let (cosine, sine) = (a / length, -b / length);
        (x, y) = (cosine * x - sine * y, sine * x + cosine * y);
    }
    let is_box = record.flags & IS_BOX != 0;
    let tangent = if is_box { box_right(outward) } else { tangent };
    let along = frame_from_tangent(normal, tangent, T::ZERO);
    let bitangent = if !is_box && sign.to_f64() < 0.0 {
        -along.bitangent
    } else {
        along.bitangent
    };
    // A normal that points into the surface is bent onto it.
    normalize_or(
        along.tangent * x + bitangent * y + normal * signed(texel.z).max(T::ZERO),
        normal,
    )
}
