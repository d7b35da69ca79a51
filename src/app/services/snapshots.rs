//! Pinned states: the document with its image, kept with the user's data.

use std::collections::HashMap;
use std::path::PathBuf;

use egui::{ColorImage, TextureHandle, TextureOptions};

use crate::store::library::Removed;
use crate::store::snapshots::Pinned;

/// The pinned states, and what is wrong with files.
pub type Pins = (Vec<Pinned>, Vec<String>);

/// The pinned states.
#[derive(Default)]
pub struct Snapshots {
    /// Where they are; `None` where there is no place for them.
    pub folder: Option<PathBuf>,
    /// The newest first.
    pub pinned: Vec<Pinned>,
    /// What was removed last.
    pub removed: Option<Removed>,
    /// The file that is being given another name, and what was typed so far.
    pub renaming: Option<(PathBuf, String)>,
    pub textures: HashMap<PathBuf, TextureHandle>,
}

impl Snapshots {
    pub fn new(folder: Option<PathBuf>) -> Self {
        Self {
            folder,
            ..Self::default()
        }
    }

    /// The image of a pinned state, by its place among them.
    pub fn picture(&mut self, ctx: &egui::Context, index: usize) -> Option<&TextureHandle> {
        let pinned = self.pinned.get(index)?;
        Some(self.textures.entry(pinned.path.clone()).or_insert_with(|| {
            let size = pinned.size.map(|side| side as usize);
            let image = ColorImage::from_rgba_unmultiplied(size, &pinned.rgba);
            ctx.load_texture("snapshot", image, TextureOptions::LINEAR)
        }))
    }
}
