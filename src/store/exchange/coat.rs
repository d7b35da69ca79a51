//! The coat of a material as other programs know it: what they show of it, and what becomes of it.

use super::report::Entry;
use super::surface::{Surface, Takes, rounded};
use crate::document::{CoatLobe, MaterialSettings};
use crate::optics::lobe::stretch_from_anisotropy;
use crate::optics::material::coat_blur;

impl Surface {
    /// The coat's narrower width over its wider one.
    pub fn coat_ratio(&self) -> f32 {
        let stretch = stretch_from_anisotropy(self.coat_anisotropy.abs());
        1.0 / (stretch * stretch)
    }

    /// Sets index and roughness of the base so that a coat which changes both (OpenPBR 1.1, "Coat") leaves the look of one
    /// that does not.
    pub(super) fn counter_coat(&mut self) {
        if self.coat_on_base || self.coat_weight == 0.0 {
            return;
        }
        if let Some(ior) = self.countered_ior() {
            self.ior = ior;
        }
        let below = |roughness: f32| {
            let blurred = (roughness.powi(4) + coat_blur(self.coat_roughness)).min(1.0).powf(0.25);
            roughness + (blurred - roughness) * self.coat_weight
        };
        let (mut low, mut high) = (0.0, self.roughness);
        for _ in 0..24 {
            let middle = 0.5 * (low + high);
            if below(middle) < self.roughness {
                low = middle;
            } else {
                high = middle;
            }
        }
        (self.coat_on_base, self.roughness) = (true, rounded(low));
    }

    /// The index that a coat brings down to that of the base; none where light is refracted by it or a film lies on it.
    fn countered_ior(&self) -> Option<f32> {
        let ior = self.ior / (1.0 - self.coat_weight + self.coat_weight / self.coat_ior);
        let is_free = self.transmission_weight == 0.0 && self.film_weight == 0.0 && ior >= self.coat_ior;
        is_free.then(|| rounded(ior))
    }

    /// What becomes of a material's coat.
    pub(super) fn coat_losses(&self, material: &MaterialSettings, takes: &Takes) -> Vec<Entry> {
        if material.coat_weight == 0.0 {
            return Vec::new();
        }
        if !takes.has("coat.weight") {
            return vec![Entry::dropped("coat", "the format has none")];
        }
        let mut entries = Vec::new();
        let mut part = |is_used, key, what, detail| entries.extend(takes.part(is_used, key, what, detail));
        let is_tinted = material.coat_ior != 1.5 || material.coat_color != [1.0; 3];
        part(is_tinted, "coat.ior", "the coat's index and colour", "1.5 and white");
        let is_stretched = material.coat_anisotropy != 0.0;
        part(is_stretched, "coat.anisotropy", "the coat's anisotropy", "it is round");
        let changes = material.coat_on_base || material.coat_darkening > 0.0;
        let detail = "what lies below keeps its reflection, roughness, brightness and emission";
        part(changes, "coat.on_base", "what the coat changes below it", detail);
        if takes.has("coat.on_base") && !material.coat_on_base {
            let set = match self.countered_ior() {
                Some(_) => "index and roughness are",
                None => "roughness is",
            };
            let dimmed = if self.emission() == [0.0; 3] {
                ""
            } else {
                "; emission is dimmed"
            };
            let detail = format!("the base's {set} set against a coat that always acts on it{dimmed}");
            entries.push(Entry::approximated("the coat's share in the base", detail, None));
        }
        entries.push(match material.coat_lobe {
            CoatLobe::Geometric => {
                let detail = format!("GGX of roughness {} stands for its geometric lobe", self.coat_roughness);
                Entry::approximated("coat", detail, None)
            }
            CoatLobe::Ggx => Entry::exact("coat"),
        });
        entries
    }
}
