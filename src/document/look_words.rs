//! Words for how a material looks, which a search finds it by.

use super::MaterialSettings;
use crate::optics::{fresnel::Fresnel, tone::srgb_from_linear, vector::Vec3};

/// Roughness below which a reflection is a mirror's, glossy, satin; above it is matt.
const SMOOTHNESS: [(f32, &str); 3] = [(0.06, "mirror"), (0.28, "glossy"), (0.52, "satin")];
/// Hues by the degrees at which they end.
const HUES: [(f32, &str); 9] = [
    (18.0, "red"),
    (45.0, "orange"),
    (70.0, "yellow"),
    (165.0, "green"),
    (200.0, "cyan"),
    (260.0, "blue"),
    (295.0, "purple"),
    (340.0, "pink"),
    (360.0, "red"),
];

impl MaterialSettings {
    /// English words for its look: colour, smoothness, and what it is like.
    pub fn look_words(&self) -> Vec<&'static str> {
        let is_metal = self.metalness > 0.5 && self.reflects();
        let mut words = vec![colour_word(self.seen_color(is_metal))];
        let roughness = if self.coat_weight > 0.5 {
            self.coat_roughness
        } else if self.reflects() {
            self.roughness
        } else {
            1.0
        };
        let smoothness = SMOOTHNESS.iter().find(|(end, _)| roughness < *end);
        words.push(smoothness.map_or("matt", |(_, word)| word));
        let kinds = [
            (is_metal, "metal"),
            (is_metal && self.anisotropy != 0.0, "brushed"),
            (
                self.transmits() && self.transmission_weight > 0.5,
                "clear glass transparent",
            ),
            (self.coat_weight > 0.0, "lacquered coated"),
            (self.fuzz_weight > 0.0, "cloth fabric soft"),
            (self.has_film(), "iridescent film"),
            (self.emission_strength > 0.0, "glowing light"),
        ];
        words.extend(kinds.into_iter().filter(|(is, _)| *is).map(|(_, word)| word));
        words
    }

    /// The colour that it shows at first sight, linear RGB.
    fn seen_color(&self, is_metal: bool) -> [f32; 3] {
        let through = self.coat_color.map(|x| 1.0 + self.coat_weight * (x - 1.0));
        let below = if is_metal && self.fresnel == Fresnel::Conductor {
            self.measured_reflectance(1.0).map(|x| x as f32)
        } else if self.transmits() && self.transmission_weight > 0.5 {
            self.transmission_color
        } else {
            self.base_color
        };
        let mix = |i: usize| {
            let seen = below[i] * through[i];
            seen + 0.5 * self.fuzz_weight * (self.fuzz_color[i] - seen)
        };
        [0, 1, 2].map(mix)
    }
}

/// The everyday word for a linear colour.
fn colour_word(color: [f32; 3]) -> &'static str {
    let linear = Vec3::<f32>::from_f32(color.map(|x| x.clamp(0.0, 1.0)));
    let [r, g, b] = srgb_from_linear(linear).to_f32();
    let (high, low) = (r.max(g).max(b), r.min(g).min(b));
    let spread = high - low;
    if high < 0.12 {
        return "black";
    }
    if spread < 0.12 * high {
        return if low > 0.8 { "white" } else { "grey" };
    }
    let sixth = if high == r {
        (g - b) / spread
    } else if high == g {
        2.0 + (b - r) / spread
    } else {
        4.0 + (r - g) / spread
    };
    let hue = (60.0 * sixth).rem_euclid(360.0);
    let word = HUES.iter().find(|(end, _)| hue <= *end).map_or("red", |(_, word)| word);
    let is_dull = word == "orange" && (high < 0.7 || spread < 0.35 * high);
    if is_dull { "brown" } else { word }
}
