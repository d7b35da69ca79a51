//! Reduction of texture maps.

use std::ops::Range;

use crate::optics::tone::{linear_from_srgb, srgb_from_linear};
use crate::optics::vector::{Vec3, vec3};
use crate::scene::model::Texture;

/// A channel of a texel, in [0, 1]; `place` counts channels from the first texel on.
pub(super) fn fraction(picture: &Texture, place: usize) -> f64 {
    match picture.rgba16.get(place) {
        Some(code) => f64::from(*code) / 65535.0,
        None => f64::from(picture.rgba8[place]) / 255.0,
    }
}

/// A map of half the width and height by box filtering; colours are filtered linearly.
pub(super) fn halved(picture: &Texture, is_color: bool) -> Texture {
    let (width, height) = ((picture.width / 2).max(1), (picture.height / 2).max(1));
    let decode = |[r, g, b, a]: [f64; 4]| {
        let color = vec3(r, g, b);
        (if is_color { linear_from_srgb(color) } else { color }, a)
    };
    let span = |i: u32, from: u32, to: u32| (i * from / to)..((i + 1) * from / to).max(i * from / to + 1);
    let mut rgba8 = Vec::with_capacity((4 * width * height) as usize);
    let mut rgba16 = Vec::new();
    for y in 0..height {
        for x in 0..width {
            if let Some(one) = same(picture, span(y, picture.height, height), span(x, picture.width, width)) {
                rgba8.extend_from_slice(&picture.rgba8[4 * one..4 * one + 4]);
                rgba16.extend_from_slice(picture.rgba16.get(4 * one..4 * one + 4).unwrap_or_default());
                continue;
            }
            let (mut color, mut alpha, mut count) = (Vec3::zero(), 0.0, 0.0);
            for row in span(y, picture.height, height) {
                for column in span(x, picture.width, width) {
                    let place = 4 * (row * picture.width + column) as usize;
                    let texel = [0, 1, 2, 3].map(|channel| fraction(picture, place + channel));
                    let (c, a) = decode(texel);
                    (color, alpha, count) = (color + c, alpha + a, count + 1.0);
                }
            }
            let mean = color / count;
            let [r, g, b] = if is_color { srgb_from_linear(mean) } else { mean }.to_f64();
            let code = |value: f64, most: f64| (most * value).round().clamp(0.0, most);
            let rgba = [r, g, b, alpha / count];
            rgba8.extend(rgba.map(|value| code(value, 255.0) as u8));
            if !picture.rgba16.is_empty() {
                rgba16.extend(rgba.map(|value| code(value, 65535.0) as u16));
            }
        }
    }
    Texture {
        name: picture.name.clone(),
        width,
        height,
        rgba8,
        rgba16,
    }
}

/// The common value of some texels, if they are equal: large maps of little content mostly are.
fn same(picture: &Texture, mut rows: Range<u32>, columns: Range<u32>) -> Option<usize> {
    let place = |row: u32, column: u32| (row * picture.width + column) as usize;
    let texels8 = picture.rgba8.as_chunks::<4>().0;
    let texels16 = picture.rgba16.as_chunks::<4>().0;
    let first = place(rows.start, columns.start);
    let is_same = |other: usize| texels8[other] == texels8[first] && texels16.get(other) == texels16.get(first);
    let all = rows.all(|row| columns.clone().all(|column| is_same(place(row, column))));
    all.then_some(first)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Texels that are all the same need no arithmetic, and must be what it gives.
    #[test]
    fn the_mean_of_equal_texels_is_any_of_them() {
        for code in 0..=255 {
            let texel = [code, 255 - code, code / 3, code];
            let of = |last: [u8; 4]| Texture {
                name: String::new(),
                width: 3,
                height: 2,
                rgba8: [[texel; 5].concat(), last.to_vec()].concat(),
                rgba16: Vec::new(),
            };
            for is_color in [false, true] {
                assert_eq!(halved(&of(texel), is_color).rgba8, texel);
                // With one that differs in opacity alone, colours are computed.
                let [r, g, b, a] = texel;
                let other = halved(&of([r, g, b, a.wrapping_add(1)]), is_color).rgba8;
                assert_eq!(other[..3], texel[..3], "{is_color}");
            }
        }
    }
}
