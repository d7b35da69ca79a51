//! Signed difference of two images, in linear light.

use super::error::{colors, relative_mean_squared_error};
use crate::job::film::Image;

/// Share of the pixels within the automatic scale.
const SHARE_WITHIN: f64 = 0.99;
/// Smallest automatic scale: below is rounding.
const SCALE_MIN: f32 = 0.0001;
/// Colours of no difference and of the largest ones, where A or B is brighter; sRGB.
const NEUTRAL: [f32; 3] = [44.0, 44.0, 44.0];
const A_BRIGHTER: [f32; 3] = [84.0, 170.0, 255.0];
const B_BRIGHTER: [f32; 3] = [255.0, 150.0, 48.0];

/// The difference of two images.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Difference {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Luminance of B less that of A, row by row from the top.
    pub signed: Vec<f32>,
    /// Root of the mean of (B − A)²/(A² + 0.01) over all pixels and colours.
    pub rms_relative: f64,
}

/// The difference of two images; `None` if their sizes differ.
pub fn difference(a: &Image, b: &Image) -> Option<Difference> {
    if (a.width, a.height) != (b.width, b.height) {
        return None;
    }
    let luminance = |[r, g, b, _]: [f32; 4]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let pairs = std::iter::zip(&a.pixels, &b.pixels);
    Some(Difference {
        width: a.width,
        height: a.height,
        signed: pairs.map(|(a, b)| luminance(*b) - luminance(*a)).collect(),
        rms_relative: relative_mean_squared_error(&colors(b), &colors(a)).sqrt(),
    })
}

impl Difference {
    /// A scale within which all but the largest differences lie.
    pub fn automatic_scale(&self) -> f32 {
        let mut sizes: Vec<f32> = self.signed.iter().map(|x| x.abs()).collect();
        if sizes.is_empty() {
            return SCALE_MIN;
        }
        let at = ((sizes.len() - 1) as f64 * SHARE_WITHIN) as usize;
        let (_, size, _) = sizes.select_nth_unstable_by(at, f32::total_cmp);
        size.max(SCALE_MIN)
    }

    /// An image of the difference, RGBA of 8 bits each; differences of `scale` and more have the full colour.
    pub fn rgba(&self, scale: f32) -> Vec<u8> {
        let color = |x: &f32| {
            let [r, g, b] = diverging(x / scale);
            [r, g, b, 255]
        };
        self.signed.iter().flat_map(color).collect()
    }
}

/// The colour (sRGB) of a share of the scale: grey at 0, blue at −1 and below (A is brighter), orange at 1 and above.
pub fn diverging(share: f32) -> [u8; 3] {
    let end = if share < 0.0 { A_BRIGHTER } else { B_BRIGHTER };
    let size = share.abs().min(1.0);
    [0, 1, 2].map(|i| (NEUTRAL[i] + size * (end[i] - NEUTRAL[i])) as u8)
}
