//! Texture sets: maps of one surface, recognised by their names: `wood_basecolor.png`, `Wood062_2K_NormalGL.jpg`,
//! `wood_arm_4k.png`.

use std::path::{Path, PathBuf};

use super::user::{TextureChannel, UserTexture};
use crate::optics::target::TextureTarget;

/// Meaning of a word in a file name.
#[derive(Clone, Copy, PartialEq)]
enum Meaning {
    Is(TextureTarget),
    /// The parameter, with inverted values.
    IsInverted(TextureTarget),
    /// Occlusion, roughness and metalness in red, green and blue.
    Packed,
    /// Something that no material here has.
    Other,
}

use Meaning::{Is, IsInverted, Other, Packed};
use TextureTarget as To;

/// Known words beside the targets' names, in lower case without separators. Of several words in a row the longest counts.
const WORDS: &[(Meaning, &str)] = &[
    (
        Is(To::BaseColor),
        "basecolor basecolour albedo diffuse diff color colour col bc",
    ),
    (Packed, "metallicroughness roughnessmetallic orm arm aorm"),
    (Is(To::Roughness), "roughness rough rgh"),
    (IsInverted(To::Roughness), "glossiness gloss smoothness"),
    (Is(To::Metalness), "metalness metallic metal"),
    (IsInverted(To::Normal), "normaldx nordx nrmdx normaldirectx"),
    (
        Is(To::Normal),
        "normalgl norgl nrmgl normalopengl normal normals nor nrm norm",
    ),
    (Is(To::Opacity), "opacity alpha opac"),
    (IsInverted(To::Opacity), "transparency"),
    (Is(To::Emission), "emission emissive emit"),
    (
        Other,
        "ao ambientocclusion occlusion displacement disp height bump specular spec preview thumbnail sheen anisotropy thickness curvature id",
    ),
];

/// The words of a file name in lower case: split at characters other than letters and digits, and before a capital after a
/// small letter.
fn words(path: &Path) -> Vec<String> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let mut words = vec![String::new()];
    let mut was_small = false;
    for letter in stem.chars() {
        let begins = letter.is_uppercase() && was_small;
        if begins || !letter.is_alphanumeric() {
            words.push(String::new());
        }
        if letter.is_alphanumeric()
            && let Some(word) = words.last_mut()
        {
            word.extend(letter.to_lowercase());
        }
        was_small = letter.is_lowercase();
    }
    words.retain(|word| !word.is_empty());
    words
}

/// The last meaning in a file name; a resolution or similar may follow.
fn meaning(path: &Path) -> Option<Meaning> {
    let words = words(path);
    let known = |text: &str| {
        let row = WORDS
            .iter()
            .find(|(_, known)| known.split(' ').any(|word| word == text));
        let of_name = |target: &&TextureTarget| {
            let name = target.name().replace('-', "");
            [name.as_str(), &name.replace("color", "colour"), &format!("clear{name}")].contains(&text)
        };
        let of_name = || TextureTarget::ALL.iter().find(of_name).map(|target| Is(*target));
        row.map(|(meaning, _)| *meaning).or_else(of_name)
    };
    (1..=words.len()).rev().find_map(|end| {
        let longest = (end.saturating_sub(3)..end).map(|start| words[start..end].concat());
        longest.into_iter().find_map(|text| known(&text))
    })
}

impl UserTexture {
    /// Channel (0 to 3) of a scalar target. `has_alpha`: the map is translucent anywhere.
    pub fn channel_of(&self, target: TextureTarget, has_alpha: bool) -> u32 {
        match self.channel {
            TextureChannel::Red => 0,
            TextureChannel::Green => 1,
            TextureChannel::Blue => 2,
            TextureChannel::Alpha => 3,
            TextureChannel::Auto => match target {
                TextureTarget::Opacity if has_alpha => 3,
                // A file name may announce roughness in green and metalness in blue.
                To::Roughness if meaning(&self.file) == Some(Packed) => 1,
                To::Metalness if meaning(&self.file) == Some(Packed) => 2,
                _ => 0,
            },
        }
    }
}

/// Targets according to a file name; empty if it has none.
pub fn targets_of(path: &Path) -> Vec<(TextureTarget, UserTexture)> {
    let plain = || UserTexture::of(path.to_owned());
    match meaning(path) {
        Some(Is(target)) => vec![(target, plain())],
        Some(IsInverted(target)) => vec![(
            target,
            UserTexture {
                inverted: true,
                ..plain()
            },
        )],
        Some(Packed) => vec![(To::Roughness, plain()), (To::Metalness, plain())],
        Some(Other) | None => Vec::new(),
    }
}

/// Assigns several maps to targets, one each; also returns the unassigned ones. Of two for the same target the first is
/// used, but a normal map with green up is preferred to green down, and a map of one scalar to one of several.
pub fn recognised(pictures: &[PathBuf]) -> (Vec<(TextureTarget, UserTexture)>, Vec<PathBuf>) {
    let mut found: Vec<(TextureTarget, UserTexture)> = Vec::new();
    let mut in_order: Vec<&PathBuf> = pictures.iter().collect();
    let comes_late = |path: &Path| match meaning(path) {
        Some(IsInverted(_)) => 1,
        Some(Packed) => 2,
        _ => 0,
    };
    in_order.sort_by_key(|path| comes_late(path));
    for path in in_order {
        for (target, texture) in targets_of(path) {
            if found.iter().all(|(known, _)| *known != target) {
                found.push((target, texture));
            }
        }
    }
    found.sort_by_key(|(target, _)| *target as u32);
    let is_used = |path: &PathBuf| found.iter().any(|(_, texture)| texture.file == *path);
    let left = pictures.iter().filter(|path| !is_used(path)).cloned().collect();
    (found, left)
}
