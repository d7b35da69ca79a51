//! Means of texture maps.

use crate::optics::tone::linear_from_srgb;
use crate::optics::vector::Vec3;
use crate::scene::model::Texture;

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
    let mut sums = [0_u64; 4];
    for texel in picture.rgba8.as_chunks::<4>().0 {
        sums.iter_mut()
            .zip(texel)
            .for_each(|(sum, code)| *sum += u64::from(*code));
    }
    let texels = (picture.rgba8.len() / 4).max(1) as f64;
    TextureMean {
        codes: sums.map(|sum| (sum as f64 / (255.0 * texels)) as f32),
        linear: mean_linear(picture),
    }
}

/// Mean of sRGB codes, linear.
fn mean_linear(picture: &Texture) -> [f32; 3] {
    let mut counts = [[0u32; CODES]; 3];
    for texel in picture.rgba8.as_chunks::<4>().0 {
        for (counts, code) in counts.iter_mut().zip(texel) {
            counts[usize::from(*code)] += 1;
        }
    }
    let texels = (picture.rgba8.len() / 4).max(1) as f64;
    counts.map(|counts| {
        let linear = |code: usize| linear_from_srgb(Vec3::<f64>::splat(code as f64 / 255.0)).x;
        let sum: f64 = (0..CODES).map(|code| f64::from(counts[code]) * linear(code)).sum();
        (sum / texels) as f32
    })
}
