//! Display-referred images.

use std::ops::Range;

use crate::{
    document::ViewSettings,
    job::film::Image,
    optics::tone::{Grade, display_codes},
    optics::vector::{Vec3, vec3},
    parallel,
    store::lut,
};

use super::lens;

/// Luminance of middle grey.
pub const MIDDLE_GREY: f64 = 0.18;

/// Lower bound of luminances for automatic exposure.
const LUMINANCE_MIN: f64 = 0.0001;

/// The factor on radiance. The automatic one brings the geometric mean of the luminance to middle grey (Reinhard et al.
/// 2002), weighed by the pixels' opacity.
pub fn exposure(image: &Image, view: &ViewSettings) -> f32 {
    let chosen = view.exposure_ev.exp2();
    if !view.auto_exposure {
        return chosen;
    }
    let add = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
    let of_block = |range: Range<usize>| {
        image.pixels[range]
            .iter()
            .map(|pixel| {
                let [r, g, b, alpha] = pixel.map(f64::from);
                let luminance = (0.2126 * r + 0.7152 * g + 0.0722 * b) / alpha.max(1e-9);
                [alpha * luminance.max(LUMINANCE_MIN).ln(), alpha]
            })
            .fold([0.0; 2], add)
    };
    let blocks = parallel::map_blocks(image.pixels.len(), of_block).into_iter();
    let [logs, weight] = blocks.fold([0.0; 2], add);
    if weight > 0.0 {
        chosen * (MIDDLE_GREY / (logs / weight).exp()) as f32
    } else {
        chosen
    }
}

/// What the lens does to an image, then exposure, white balance, contrast, saturation, tone curve, sRGB encoding and the view's table of colours: red, green, blue and
/// alpha of 8 bits, row by row from the top; alpha is not premultiplied.
pub fn display(image: &Image, view: &ViewSettings) -> Vec<u8> {
    let exposure = exposure(image, view);
    let through_lens = lens::applied(image, view);
    let image = through_lens.as_ref().unwrap_or(image);
    let grade = Grade::new(view.white_k, view.contrast, view.saturation);
    let lut = view.lut.as_deref().and_then(lut::remembered);
    let graded = |pixel: &[f32; 4]| {
        let [r, g, b, alpha] = *pixel;
        let straight = if alpha > 0.0 { exposure / alpha } else { 0.0 };
        grade.apply(vec3(r * straight, g * straight, b * straight))
    };
    let of_block = |range: Range<usize>| {
        let pixels = &image.pixels[range];
        let colors: Vec<_> = pixels.iter().map(graded).collect();
        let encode = |(&codes, [.., alpha]): (&Vec3<f32>, &[f32; 4])| {
            let [r, g, b] = lut.as_ref().map_or(codes, |lut| lut.apply(codes)).to_f32();
            [r, g, b, *alpha].map(|x| (255.0 * x.clamp(0.0, 1.0) + 0.5) as u8)
        };
        let codes = display_codes(view.tone_map, &colors);
        codes.iter().zip(pixels).map(encode).collect::<Vec<_>>()
    };
    parallel::map_blocks(image.pixels.len(), of_block)
        .concat()
        .into_flattened()
}
