//! Reduction of texture maps.

use std::ops::Range;

use crate::{
    optics::tone::{linear_from_srgb, srgb_from_linear},
    optics::vector::{Vec3, vec3},
    scene::model::Texture,
};

/// A channel of a texel, in [0, 1]; `place` counts channels from the first texel on.
pub(super) fn fraction(picture: &Texture, place: usize) -> f64 {
    match picture.rgba16.get(place) {
        Some(code) => f64::from(*code) / 65535.0,
        None => f64::from(picture.rgba8[place]) / 255.0,
    }
}

/// Half a width and height.
fn half(size: [u32; 2]) -> [u32; 2] {
    size.map(|side| (side / 2).max(1))
}

/// The part of `from` texels that the texel `place` of `to` covers.
fn span(place: usize, from: usize, to: usize) -> Range<usize> {
    place * from / to..(place + 1) * from / to
}

/// The code of 8 bits nearest to one of 16.
pub fn nearest_of_16(code: u16) -> u8 {
    ((u32::from(code) * 255 + 32767) / 65535) as u8
}

/// A map of half the width and height.
pub(super) fn halved(picture: &Texture, is_color: bool) -> Texture {
    let size = [picture.width, picture.height];
    let [width, height] = half(size);
    let rgba16 = halved_codes(&picture.rgba16, 65535, |code| code as u16, size, is_color);
    Texture {
        name: picture.name.clone(),
        width,
        height,
        rgba8: match rgba16.is_empty() {
            true => halved_codes(&picture.rgba8, 255, |code| code as u8, size, is_color),
            false => rgba16.iter().copied().map(nearest_of_16).collect(),
        },
        rgba16,
    }
}

/// The same of one kind of codes, by box filtering; colours are filtered linearly.
fn halved_codes<C: Copy + PartialEq + Into<usize>>(
    codes: &[C],
    most: usize,
    code: impl Fn(f64) -> C,
    size: [u32; 2],
    is_color: bool,
) -> Vec<C> {
    if codes.is_empty() {
        return Vec::new();
    }
    let values: Vec<f64> = (0..=most)
        .map(|code| {
            let fraction = code as f64 / most as f64;
            if is_color {
                linear_from_srgb(Vec3::splat(fraction)).x
            } else {
                fraction
            }
        })
        .collect();
    let [width, height] = size.map(|side| side as usize);
    let [to_width, to_height] = half(size).map(|side| side as usize);
    let texels = codes.as_chunks::<4>().0;
    // The mean of the texels that one covers, of which there is one at least.
    let mean = |place: usize| {
        let columns = span(place % to_width, width, to_width);
        let rows = span(place / to_width, height, to_height);
        let covered = || rows.clone().flat_map(|row| &texels[row * width..][columns.clone()]);
        let mut others = covered();
        // Large maps of little content mostly have equal texels.
        if let Some(first) = others.next()
            && others.all(|texel| texel == first)
        {
            return *first;
        }
        let (mut sums, mut count) = ([0.0; 4], 0.0);
        for texel in covered() {
            let [r, g, b, a] = texel.map(Into::<usize>::into);
            let of_texel = [values[r], values[g], values[b], a as f64 / most as f64];
            sums.iter_mut().zip(of_texel).for_each(|(sum, value)| *sum += value);
            count += 1.0;
        }
        let [r, g, b, a] = sums.map(|sum| sum / count);
        let color = if is_color {
            srgb_from_linear(vec3(r, g, b))
        } else {
            vec3(r, g, b)
        };
        [color.x, color.y, color.z, a].map(|value| code((most as f64 * value).round()))
    };
    (0..to_width * to_height).flat_map(mean).collect()
}

/// A map halved until its sides are at most `side_max`, and the original size if it was larger.
pub fn scaled_to(picture: Texture, side_max: u32, is_color: bool) -> (Texture, Option<[u32; 2]>) {
    let whole = [picture.width, picture.height];
    let mut scaled = picture;
    while scaled.width.max(scaled.height) > side_max.max(1) {
        scaled = halved(&scaled, is_color);
    }
    let is_scaled = [scaled.width, scaled.height] != whole;
    (scaled, is_scaled.then_some(whole))
}
