//! Thumbnails of environments for the panels.

use super::{Environment, environment_direction, environment_radiance};
use crate::optics::{tone::linear_from_srgb, tone::srgb_from_linear, vector::Vec3};

/// Samples along each side of a thumbnail's pixel.
const TAPS: u32 = 4;
/// The luminance that the geometric mean is brought to.
const MIDDLE_GREY: f32 = 0.3;

/// The whole map as `width` × `height` opaque sRGB pixels, rows from the top, exposed to its geometric mean, with a
/// highlight roll-off.
pub fn thumbnail(environment: &Environment, width: u32, height: u32) -> Vec<[u8; 4]> {
    let pixels: Vec<[f32; 3]> = (0..height)
        .flat_map(|row| (0..width).map(move |column| [column, row]))
        .map(|place| radiance_of_taps(environment, place, [width, height]))
        .collect();
    let exposure = MIDDLE_GREY / geometric_mean_luminance(&pixels);
    pixels
        .iter()
        .map(|pixel| {
            let [red, green, blue] = pixel.map(|value| shown(value * exposure));
            [red, green, blue, 255]
        })
        .collect()
}

/// The pixels of a thumbnail, red, green, blue and alpha, as if the environment were so many times as bright.
pub fn brightened(pixels: &[u8], factor: f32) -> Vec<u8> {
    let codes: Vec<u8> = (0..=255_u8)
        .map(|code| {
            // The inverse of the curve, which white at 4 ends.
            let code: f32 = linear_from_srgb(Vec3::splat(f32::from(code) / 255.0)).x;
            shown(factor * (8.0 * (code - 1.0 + ((1.0 - code).powi(2) + 0.25 * code).sqrt())))
        })
        .collect();
    pixels
        .as_chunks()
        .0
        .iter()
        .flat_map(|[red, green, blue, alpha]| {
            let [red, green, blue] = [red, green, blue].map(|code| codes[usize::from(*code)]);
            [red, green, blue, *alpha]
        })
        .collect()
}

/// The sum of a pixel's samples.
fn radiance_of_taps(environment: &Environment, place: [u32; 2], size: [u32; 2]) -> [f32; 3] {
    let mut sum = [0.0; 3];
    for tap in 0..TAPS * TAPS {
        let offset = [tap % TAPS, tap / TAPS];
        let uv =
            [0, 1].map(|axis| (place[axis] as f32 + (offset[axis] as f32 + 0.5) / TAPS as f32) / size[axis] as f32);
        let radiance = environment_radiance(environment, environment_direction(uv)).to_f32();
        sum = [0, 1, 2].map(|channel| sum[channel] + radiance[channel]);
    }
    sum
}

/// exp(mean(ln luminance)), with black pixels counted as nearly black; 1 if there is no light at all.
fn geometric_mean_luminance(pixels: &[[f32; 3]]) -> f32 {
    let luminances = pixels
        .iter()
        .map(|[red, green, blue]| 0.2126 * red + 0.7152 * green + 0.0722 * blue);
    let brightest = luminances.clone().fold(0.0, f32::max);
    if brightest <= 0.0 {
        return 1.0;
    }
    let floor = brightest * 1e-6;
    let sum: f32 = luminances.map(|luminance| luminance.max(floor).ln()).sum();
    (sum / pixels.len() as f32).exp()
}

/// The sRGB code of an exposed value, by Reinhard's curve with white at 4.
fn shown(exposed: f32) -> u8 {
    let linear: f32 = exposed * (1.0 + exposed / 16.0) / (1.0 + exposed);
    (srgb_from_linear(Vec3::splat(linear.clamp(0.0, 1.0))).x * 255.0 + 0.5) as u8
}
