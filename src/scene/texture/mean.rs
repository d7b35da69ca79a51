//! Means of texture maps.

use crate::{optics::tone::linear_from_srgb, optics::vector::Vec3, scene::model::Texture};

/// Codes of 8 bits.
const CODES: usize = 256;

/// Mean of a texture map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureMean {
    /// Mean of the codes, in [0, 1].
    pub codes: [f32; 4],
    /// Mean of the decoded sRGB codes, linear.
    pub linear: [f32; 3],
}

/// Mean of a texture map.
pub fn texture_mean(picture: &Texture) -> TextureMean {
    let mut counts = [[0_u32; CODES]; 4];
    let texels = picture.rgba8.as_chunks::<4>().0;
    for texel in texels {
        for (counts, code) in counts.iter_mut().zip(texel) {
            counts[usize::from(*code)] += 1;
        }
    }
    let texels = texels.len().max(1) as f64;
    let sum = |counts: [u32; CODES]| {
        (0..)
            .zip(counts)
            .map(|(code, count)| code * u64::from(count))
            .sum::<u64>()
    };
    let [red, green, blue, _] = counts;
    TextureMean {
        codes: counts.map(|counts| (sum(counts) as f64 / (255.0 * texels)) as f32),
        linear: [red, green, blue].map(|counts| {
            let linear = |code: usize| linear_from_srgb(Vec3::<f64>::splat(code as f64 / 255.0)).x;
            let sum: f64 = (0..CODES).map(|code| f64::from(counts[code]) * linear(code)).sum();
            (sum / texels) as f32
        }),
    }
}
