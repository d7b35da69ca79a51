//! Pinned states: the document with its image, kept with the user's data.

use std::collections::HashMap;
use std::path::PathBuf;

use egui::{ColorImage, TextureHandle, TextureOptions};

use crate::app::services::messages::Success;
use crate::store::library::Removed;
use crate::store::snapshots::Pinned;

/// What can be done with pinned states.
#[derive(Clone, Debug, PartialEq)]
pub enum PinChange {
    /// The document is pinned with the latest image.
    Add,
    /// A file gets another name.
    Rename(PathBuf, String),
    /// A file is removed.
    Remove(PathBuf),
    /// What was removed last comes back.
    Restore,
}

/// What came of a change: what to say, which states there are, what is wrong with files, and what was removed.
pub(in crate::app) struct PinsListed {
    pub(in crate::app) done: Option<Success>,
    pub(in crate::app) pinned: Vec<Pinned>,
    pub(in crate::app) errors: Vec<String>,
    pub(in crate::app) removed: Option<Removed>,
}

/// The pinned states.
#[derive(Default)]
pub(in crate::app) struct Snapshots {
    /// Where they are; `None` where there is no place for them.
    pub(in crate::app) folder: Option<PathBuf>,
    /// The newest first.
    pub(in crate::app) pinned: Vec<Pinned>,
    /// What was removed last.
    pub(in crate::app) removed: Option<Removed>,
    /// The file that is being given another name, and what was typed so far.
    pub(in crate::app) renaming: Option<(PathBuf, String)>,
    pub(in crate::app) textures: HashMap<PathBuf, TextureHandle>,
}

impl Snapshots {
    pub(in crate::app) fn new(folder: Option<PathBuf>) -> Self {
        Self {
            folder,
            ..Self::default()
        }
    }

    /// The image of a pinned state, by its place among them.
    pub(in crate::app) fn picture(&mut self, ctx: &egui::Context, index: usize) -> Option<&TextureHandle> {
        let pinned = self.pinned.get(index)?;
        Some(self.textures.entry(pinned.path.clone()).or_insert_with(|| {
            let size = pinned.size.map(|side| side as usize);
            let image = ColorImage::from_rgba_unmultiplied(size, &pinned.rgba);
            ctx.load_texture("snapshot", image, TextureOptions::LINEAR)
        }))
    }
}
