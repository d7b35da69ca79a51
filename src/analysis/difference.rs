//! Signed difference of two images, in linear light.

use super::error::relative_mean_squared_error;
use crate::job::film::Image;

/// Share of the pixels within the automatic scale.
const SHARE_WITHIN: f64 = 0.99;
/// Smallest automatic scale: below is rounding.
const SCALE_MIN: f32 = 1e-4;
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
    let colors = |image: &Image| -> Vec<f32> { image.pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect() };
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

#[cfg(test)]
mod tests {
    use super::*;

    fn image(values: &[f32]) -> Image {
        Image {
            width: values.len() as u32,
            height: 1,
            pixels: values.iter().map(|x| [*x, *x, *x, 1.0]).collect(),
        }
    }

    #[test]
    fn differences_are_signed_and_relative() {
        let found = difference(&image(&[1.0, 2.0]), &image(&[1.5, 1.0])).expect("equal sizes");
        assert!((found.signed[0] - 0.5).abs() < 1e-6 && (found.signed[1] + 1.0).abs() < 1e-6);
        let expected = (0.5_f64 * (0.25 / 1.01 + 1.0 / 4.01)).sqrt();
        assert!((found.rms_relative - expected).abs() < 1e-6, "{}", found.rms_relative);
        assert_eq!(difference(&image(&[1.0]), &image(&[1.0, 1.0])), None);
        let none = difference(&image(&[3.0]), &image(&[3.0])).expect("equal sizes");
        assert_eq!((none.rms_relative, none.automatic_scale()), (0.0, SCALE_MIN));
    }

    #[test]
    fn colours_are_neutral_in_the_middle_and_differ_by_sign() {
        let [r, g, b] = diverging(0.0);
        assert!(r == g && g == b);
        assert!(diverging(0.5)[0] > diverging(0.5)[2] && diverging(-0.5)[2] > diverging(-0.5)[0]);
        assert_eq!(diverging(7.0), diverging(1.0));
        let found = difference(&image(&[1.0, 1.0]), &image(&[2.0, 1.0])).expect("equal sizes");
        let rgba = found.rgba(1.0);
        assert_eq!((&rgba[..3], &rgba[4..7]), (&diverging(1.0)[..], &diverging(0.0)[..]));
    }
}
