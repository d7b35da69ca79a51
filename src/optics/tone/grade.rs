//! Colour grading before the tone curve: white balance, contrast, saturation.

use super::LUMINANCE;
use crate::optics::blackbody::blackbody_color;
use crate::optics::primaries::{Matrix, rec709_adapted};
use crate::optics::vector::Vec3;

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_changes_nothing_is_left_out() {
        assert_eq!(Grade::new(Grade::NEUTRAL_K, 1.0, 1.0), Grade::default());
    }

    #[test]
    fn the_light_that_is_to_be_white_becomes_white() {
        for kelvin in [2800.0, 4000.0, 9000.0] {
            let light = blackbody_color(f64::from(kelvin));
            let white = blackbody_color(f64::from(Grade::NEUTRAL_K));
            let [r, g, b] = Grade::new(kelvin, 1.0, 1.0).apply(Vec3::from_f64(light)).to_f32();
            let scale = g / white[1] as f32;
            assert!((r / scale - white[0] as f32).abs() < 1e-4, "{kelvin} K: {r}");
            assert!((b / scale - white[2] as f32).abs() < 1e-4, "{kelvin} K: {b}");
        }
    }

    #[test]
    fn contrast_keeps_middle_grey_and_saturation_luminance() {
        let grey = Vec3::splat(MIDDLE_GREY);
        assert!((Grade::new(Grade::NEUTRAL_K, 1.7, 1.0).apply(grey).x - MIDDLE_GREY).abs() < 1e-6);
        let color = Vec3::from_f64([0.5, 0.3, 0.2]);
        let luminance = |color: Vec3<f32>| color.dot(Vec3::from_f64(LUMINANCE));
        let changed = Grade::new(Grade::NEUTRAL_K, 1.0, 1.3).apply(color);
        assert!((luminance(changed) - luminance(color)).abs() < 1e-6);
        assert!(changed.x > color.x && changed.z < color.z);
        let grey = Grade::new(Grade::NEUTRAL_K, 1.0, 0.0).apply(color);
        assert!((grey.x - grey.z).abs() < 1e-6);
    }
}
