//! The coat of a material as other programs know it: what they show of it, and what becomes of it.

use super::{Surface, Takes};
use crate::document::{CoatLobe, MaterialSettings};
use crate::optics::lobe::stretch_from_anisotropy;
use crate::store::exchange::report::Entry;

impl Surface {
    /// The coat's narrower width over its wider one.
    pub fn coat_ratio(&self) -> f32 {
        let stretch = stretch_from_anisotropy(self.coat_anisotropy.abs());
        1.0 / (stretch * stretch)
    }
}

/// Leaves of a surface's coat what a program takes.
pub(super) fn take(surface: &mut Surface, takes: &Takes) {
    if !takes.coat {
        surface.coat_weight = 0.0;
    }
    if !takes.coat_details {
        (surface.coat_ior, surface.coat_color) = (1.5, [1.0; 3]);
    }
    if !takes.coat_stretch {
        surface.coat_anisotropy = 0.0;
    }
    surface.coat_on_base = takes.coat_on_base;
    if !takes.coat_on_base {
        surface.coat_darkening = 0.0;
    }
}

/// What becomes of a material's coat.
pub(super) fn losses(surface: &Surface, material: &MaterialSettings, takes: &Takes) -> Vec<Entry> {
    if material.coat_weight == 0.0 {
        return Vec::new();
    }
    if !takes.coat {
        return vec![Entry::dropped("coat", "the format has none")];
    }
    let mut entries = Vec::new();
    let mut part = |is_used: bool, is_taken: bool, what: &str, detail: &str| {
        if is_used && is_taken {
            entries.push(Entry::exact(what));
        } else if is_used {
            entries.push(Entry::dropped(what, detail));
        }
    };
    let is_tinted = material.coat_ior != 1.5 || material.coat_color != [1.0; 3];
    part(
        is_tinted,
        takes.coat_details,
        "the coat's index and colour",
        "1.5 and white",
    );
    let is_stretched = material.coat_anisotropy != 0.0;
    part(is_stretched, takes.coat_stretch, "the coat's anisotropy", "it is round");
    let changes = material.coat_on_base || material.coat_darkening > 0.0;
    let detail = "what lies below keeps its reflection, roughness, brightness and emission";
    part(changes, takes.coat_on_base, "what the coat changes below it", detail);
    if takes.coat_on_base && !material.coat_on_base {
        let detail = "there it always changes reflection, roughness and emission below it";
        entries.push(Entry::approximated("the coat's share in the base", detail, None));
    }
    entries.push(match material.coat_lobe {
        CoatLobe::Geometric => {
            let detail = format!(
                "GGX of roughness {} stands for its geometric lobe",
                surface.coat_roughness
            );
            Entry::approximated("coat", detail, None)
        }
        CoatLobe::Ggx => Entry::exact("coat"),
    });
    entries
}
