//! The thin film of a material as other programs know it: what they show of it, and what becomes of it.

use super::{Surface, Takes};
use crate::document::MaterialSettings;
use crate::store::exchange::report::Entry;

/// Leaves of a surface's film what a program takes.
pub(super) fn take(surface: &mut Surface, takes: &Takes) {
    if !takes.film {
        surface.film_weight = 0.0;
    } else if !takes.film_weight && surface.film_weight > 0.0 {
        surface.film_weight = 1.0;
    }
}

/// What becomes of a material's film.
pub(super) fn losses(material: &MaterialSettings, takes: &Takes) -> Vec<Entry> {
    if !material.has_film() {
        return Vec::new();
    }
    if !takes.film {
        return vec![Entry::dropped("thin film", "the format has none")];
    }
    let mut entries = vec![Entry::exact("thin film")];
    if material.film_weight < 1.0 && !takes.film_weight {
        let why = "the format's film is everywhere";
        entries.push(Entry::dropped("the thin film's weight", why));
    }
    entries
}
