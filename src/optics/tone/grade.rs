//! Colour grading before the tone curve: white balance, contrast, saturation.

use super::LUMINANCE;
use crate::optics::{blackbody::blackbody_color, primaries::Matrix, primaries::rec709_adapted, vector::Vec3};

/// Luminance that contrast leaves unchanged.
const MIDDLE_GREY: f32 = 0.18;

/// White balance, contrast and saturation, ready to apply; neutral ones are skipped.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Grade {
    balance: Option<[Vec3<f32>; 3]>,
    contrast: Option<f32>,
    saturation: Option<f32>,
}

impl Grade {
    /// Neutral white point, in K.
    pub const NEUTRAL_K: f32 = 6500.0;

    /// `white_k`: temperature of the black body whose light becomes white. `contrast`: the power around middle grey.
    /// `saturation`: the distance from grey. [`Grade::NEUTRAL_K`], 1 and 1 are neutral.
    pub fn new(white_k: f32, contrast: f32, saturation: f32) -> Self {
        let [from, to] = [white_k, Self::NEUTRAL_K].map(|kelvin| blackbody_color(f64::from(kelvin)));
        let balance = (white_k != Self::NEUTRAL_K).then(|| rec709_adapted(from, to));
        let rows = |matrix: Matrix| matrix.map(Vec3::from_f64);
        Self {
            balance: balance.map(rows),
            contrast: (contrast != 1.0).then_some(contrast),
            saturation: (saturation != 1.0).then_some(saturation),
        }
    }

    /// Scene-referred linear Rec. 709 from the same.
    pub fn apply(&self, mut color: Vec3<f32>) -> Vec3<f32> {
        if let Some(rows) = &self.balance {
            let [r, g, b] = rows.map(|row| row.dot(color).max(0.0));
            color = Vec3 { x: r, y: g, z: b };
        }
        if let Some(power) = self.contrast {
            color = color.map(|x| MIDDLE_GREY * (x.max(0.0) / MIDDLE_GREY).powf(power));
        }
        if let Some(saturation) = self.saturation {
            let luminance = color.dot(Vec3::from_f64(LUMINANCE));
            color = Vec3::splat(luminance).mix(color, saturation).map(|x| x.max(0.0));
        }
        color
    }
}
