//! Kinds of files that are opened, by their endings. Dialogs, what is dropped, folders that are watched, recent files, help
//! and messages ask this table.

use std::path::Path;

use super::exchange::FORMATS;
use crate::import::endings::{LIGHT, MODELS, PARTS, PICTURES, has_ending};
use crate::named::{joined, named};

named! {
    /// What a file holds, as its ending says.
    FileKind {
        Document, "document", "Projects and materials", "Projects and materials of Glossmith.";
        Model, "model", "Models", "Models, alone or in an archive.";
        Light, "light", "Environment images", "Environments, and textures if assigned to a material.";
        Picture, "picture", "Images", "Images for screens: environments, textures, or images saved here, which have the document inside.";
        Material, "material", "Materials of other programs", "Materials in other programs' formats.";
        Measured, "measured", "Measured materials (MERL)", "Measurements that a material is fitted to.";
        ColorTable, "color-table", "Tables of colours", "Tables that the image's colours go through.";
        LightProfile, "light-profile", "Light profiles", "Intensities of a lamp by direction, for spheres among the lights.";
        Part, "part", "Parts of models", "What models refer to; dropped together with them.";
    }
}

/// The kinds that are opened without saying what for.
pub const OPENED: &[FileKind] = &[
    FileKind::Document,
    FileKind::Model,
    FileKind::Light,
    FileKind::Picture,
    FileKind::Material,
];

/// The kinds that an environment or a texture can be.
pub const PICTURE_KINDS: &[FileKind] = &[FileKind::Light, FileKind::Picture];

/// The kinds that a material is opened from.
pub const MATERIAL_KINDS: &[FileKind] = &[FileKind::Document, FileKind::Material];

impl FileKind {
    /// The endings of its files, without their dots.
    pub fn endings(self) -> Vec<&'static str> {
        match self {
            Self::Document => vec!["json"],
            Self::Model => MODELS.to_vec(),
            Self::Light => LIGHT.to_vec(),
            Self::Picture => PICTURES.to_vec(),
            Self::Material => {
                let is_alone = |format: &&super::exchange::Registered| format.is_material_alone();
                let mut endings: Vec<&str> = FORMATS
                    .iter()
                    .filter(is_alone)
                    .flat_map(|f| f.extensions)
                    .copied()
                    .collect();
                endings.dedup();
                endings
            }
            Self::Measured => vec!["binary"],
            Self::ColorTable => vec!["cube"],
            Self::LightProfile => vec!["ies"],
            Self::Part => PARTS.to_vec(),
        }
    }

    /// The kind of a file; none where its ending is not known.
    pub fn of(path: &Path) -> Option<Self> {
        Self::ALL.iter().copied().find(|kind| has_ending(path, &kind.endings()))
    }
}

/// The endings of several kinds.
pub fn endings(kinds: &[FileKind]) -> Vec<&'static str> {
    kinds.iter().flat_map(|kind| kind.endings()).collect()
}

/// Whether a file may have a document in it, which images that were saved here do.
pub fn may_hold_document(path: &Path) -> bool {
    FileKind::of(path) == Some(FileKind::Document) || has_ending(path, &["png"])
}

/// What can be opened, for help and messages: each kind with its endings.
pub fn what_is_opened() -> String {
    let one = |kind: &FileKind| {
        let endings = kind.endings().into_iter().map(|ending| format!(".{ending}"));
        format!("{} ({})", kind.label().to_lowercase(), joined(endings, ", "))
    };
    joined(OPENED.iter().map(one), ", ")
}
