//! The picture as a screen shows it.

use rayon::prelude::*;

use crate::analysis::film::Image;
use crate::document::ViewSettings;
use crate::optics::tone::{srgb_from_linear, tone_map};
use crate::optics::vector::vec3;

/// Exposure, tone curve and sRGB encoding: red, green, blue and alpha of 8 bits, row by row from the top; alpha is not
/// premultiplied.
pub fn display(image: &Image, view: &ViewSettings) -> Vec<u8> {
    let exposure = view.exposure_ev.exp2();
    let encode = |pixel: &[f32; 4]| -> [u8; 4] {
        let [r, g, b, alpha] = *pixel;
        let straight = if alpha > 0.0 { exposure / alpha } else { 0.0 };
        let mapped = tone_map(view.tone_map, vec3(r * straight, g * straight, b * straight));
        let [r, g, b] = srgb_from_linear(mapped).to_f32();
        [r, g, b, alpha].map(|x| (255.0 * x.clamp(0.0, 1.0) + 0.5) as u8)
    };
    image.pixels.par_iter().flat_map_iter(encode).collect()
}
