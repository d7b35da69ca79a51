//! Light groups of a film by the document that it shows: their layers and their mix.

use std::borrow::Cow;

use crate::document::{Document, GroupName, effect::without_what_is_off};
use crate::job::film::{Film, Image};

/// The light of a group, under its name.
pub type LightLayer = (String, Image);

/// The names of a film's light groups, by number.
pub fn light_groups(film: &Film, document: &Document) -> Vec<GroupName> {
    let mut names = without_what_is_off(document).light_groups();
    names.truncate(film.light_groups());
    names
}

/// The light of each group as it was rendered, by the group's name.
pub fn light_layers(film: &Film, document: &Document) -> Vec<LightLayer> {
    light_groups(film, document)
        .into_iter()
        .enumerate()
        .map(|(group, name)| (name.into(), film.light_image(group)))
        .collect()
}

/// The film with the mix of its light groups.
pub fn mixed<'f>(film: &'f Film, document: &Document) -> Cow<'f, Film> {
    film.mixed(&without_what_is_off(document).light_factors())
}
