//! Reduction of texture maps.

use std::ops::Range;

use crate::optics::tone::{linear_from_srgb, srgb_from_linear};
use crate::optics::vector::Vec3;
use crate::scene::model::Texture;

/// A channel of a texel, in [0, 1]; `place` counts channels from the first texel on.
pub(super) fn fraction(picture: &Texture, place: usize) -> f64 {
    match picture.rgba16.get(place) {
        Some(code) => f64::from(*code) / 65535.0,
        None => f64::from(picture.rgba8[place]) / 255.0,
    }
}

/// A number of a channel as texture maps store it.
trait Code: Copy + PartialEq {
    const MOST: usize;
    /// The number as an index.
    fn index(self) -> usize;
    /// The number nearest to a fraction in [0, 1].
    fn nearest(fraction: f64) -> Self;
}

impl Code for u8 {
    const MOST: usize = 255;
    fn index(self) -> usize {
        self.into()
    }
    fn nearest(fraction: f64) -> Self {
        (255.0 * fraction).round().clamp(0.0, 255.0) as Self
    }
}

impl Code for u16 {
    const MOST: usize = 65535;
    fn index(self) -> usize {
        self.into()
    }
    fn nearest(fraction: f64) -> Self {
        (65535.0 * fraction).round().clamp(0.0, 65535.0) as Self
    }
}

/// Conversion between codes and the values whose mean is taken: linear for colours.
struct Scale<C> {
    /// Value of each code.
    values: Vec<f64>,
    /// Code of the darkest value in each of equal intervals; empty if values are proportional to codes.
    starts: Vec<C>,
    /// Smallest value of each code but the first.
    limits: Vec<f64>,
}

impl<C: Code> Scale<C> {
    fn new(is_color: bool) -> Self {
        let fraction = |code: usize| code as f64 / C::MOST as f64;
        if !is_color {
            return Self {
                values: (0..=C::MOST).map(fraction).collect(),
                starts: Vec::new(),
                limits: Vec::new(),
            };
        }
        let linear = |fraction: f64| linear_from_srgb(Vec3::<f64>::splat(fraction)).x;
        let intervals = 16 * (C::MOST + 1);
        let start = |place: usize| {
            let value = place as f64 / intervals as f64;
            C::nearest(srgb_from_linear(Vec3::<f64>::splat(value)).x)
        };
        Self {
            values: (0..=C::MOST).map(|code| linear(fraction(code))).collect(),
            starts: (0..=intervals).map(start).collect(),
            limits: (0..C::MOST)
                .map(|code| linear((code as f64 + 0.5) / C::MOST as f64))
                .collect(),
        }
    }

    fn value(&self, code: C) -> f64 {
        self.values[code.index()]
    }

    /// The code nearest to a value in [0, 1].
    fn code(&self, value: f64) -> C {
        let Some(last) = self.starts.len().checked_sub(1) else {
            return C::nearest(value);
        };
        let start = self.starts[((last as f64 * value) as usize).min(last)].index();
        let above = self.limits[start..].iter().take_while(|limit| value >= **limit).count();
        C::nearest((start + above) as f64 / C::MOST as f64)
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
    let rgba16 = halved_codes(&picture.rgba16, size, is_color);
    Texture {
        name: picture.name.clone(),
        width,
        height,
        rgba8: match rgba16.is_empty() {
            true => halved_codes(&picture.rgba8, size, is_color),
            false => rgba16.iter().copied().map(nearest_of_16).collect(),
        },
        rgba16,
    }
}

/// The same of one kind of codes, by box filtering; colours are filtered linearly.
fn halved_codes<C: Code>(codes: &[C], size: [u32; 2], is_color: bool) -> Vec<C> {
    if codes.is_empty() {
        return Vec::new();
    }
    let (colors, alphas) = (Scale::new(is_color), Scale::new(false));
    let [width, height] = size.map(|side| side as usize);
    let [to_width, to_height] = half(size).map(|side| side as usize);
    let texels = codes.as_chunks::<4>().0;
    let texel = |place: usize| {
        let (columns, rows) = (
            span(place % to_width, width, to_width),
            span(place / to_width, height, to_height),
        );
        let of_row = |row: usize| &texels[row * width..][columns.clone()];
        mean(|| rows.clone().flat_map(of_row), &colors, &alphas)
    };
    (0..to_width * to_height).flat_map(texel).collect()
}

/// Mean of some texels, of which there is one at least.
fn mean<'a, C: Code + 'a, I: Iterator<Item = &'a [C; 4]>>(
    texels: impl Fn() -> I,
    colors: &Scale<C>,
    alphas: &Scale<C>,
) -> [C; 4] {
    let mut others = texels();
    // Large maps of little content mostly have equal texels.
    if let Some(first) = others.next()
        && others.all(|texel| texel == first)
    {
        return *first;
    }
    let (mut sums, mut count) = ([0.0; 4], 0.0);
    for [r, g, b, a] in texels() {
        let color = [*r, *g, *b].map(|code| colors.value(code));
        sums.iter_mut().zip(color).for_each(|(sum, value)| *sum += value);
        sums[3] += alphas.value(*a);
        count += 1.0;
    }
    let [r, g, b, a] = sums.map(|sum| sum / count);
    let [r, g, b] = [r, g, b].map(|value| colors.code(value));
    [r, g, b, alphas.code(a)]
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
