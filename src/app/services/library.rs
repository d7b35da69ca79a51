//! The user's materials and the thumbnails of all of them.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use egui::{ColorImage, TextureHandle, TextureOptions};

use crate::app::services::beside::started;
use crate::app::services::messages::Success;
use crate::document::MaterialSettings;
use crate::render::thumbnails::{self, SIDE, ThumbnailWorker, Thumbnails};
use crate::store::library::{self, Entry, Removed};
use crate::store::{FileError, PRESETS};

/// What can be done with the files of a folder of the user's: materials, or pinned states.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// The selected material is added, or the document pinned with the latest image.
    Add,
    /// A file gets another name.
    Rename(PathBuf, String),
    /// A material is added once more under another name.
    Duplicate(PathBuf),
    /// A file is removed.
    Remove(PathBuf),
    /// What was removed last comes back.
    Restore,
}

/// What came of a change: what to say, what there is in the folder, what was added and is to be named, and what was removed.
#[derive(Default)]
pub struct Listed<T> {
    pub done: Option<Success>,
    pub entries: T,
    pub added: Option<PathBuf>,
    pub removed: Option<Removed>,
}

impl<T: Default> Listed<T> {
    pub fn of(entries: T) -> Self {
        Self {
            entries,
            ..Self::default()
        }
    }

    /// What is the same in every folder: makes a change but for additions, with the file that was removed before.
    pub fn change(
        &mut self,
        change: &Change,
        removed: Option<&Removed>,
        rename: fn(&Path, &str) -> Result<PathBuf, FileError>,
    ) -> Result<(), FileError> {
        let done = |verb: &str, path: &Path| Some(Success::with_file(verb, path, ""));
        match change {
            Change::Rename(path, name) => self.done = done("Renamed to", &rename(path, name)?),
            Change::Remove(path) => {
                self.removed = Some(library::remove(path)?);
                self.done = done("Removed", path);
            }
            Change::Restore => {
                if let Some(removed) = removed {
                    self.done = done("Restored", &library::restore(removed)?);
                }
            }
            Change::Add | Change::Duplicate(_) => {}
        }
        Ok(())
    }
}

/// A material of the panel, with the key of its image.
pub struct MaterialCard {
    pub entry: Entry,
    pub key: u64,
}

/// The materials to choose from.
#[derive(Default)]
pub struct Library {
    /// Where the user's are; `None` where there is no place for them.
    pub folder: Option<PathBuf>,
    pub own: Vec<MaterialCard>,
    /// Keys of the shipped ones.
    shipped: Vec<u64>,
    pub renaming: Option<(PathBuf, String)>,
    /// What was removed last.
    pub removed: Option<Removed>,
    /// Set while the viewport goes first.
    hold: Arc<AtomicBool>,
    cache: Option<PathBuf>,
    worker: Option<ThumbnailWorker>,
    /// Those of the document with the keys of their images, as they were when the user last paused.
    in_document: Vec<(MaterialSettings, u64)>,
    /// Materials that lie in watched folders.
    pub watched: Vec<MaterialSettings>,
    pub is_asked: bool,
    textures: HashMap<u64, TextureHandle>,
    uploaded: Option<Thumbnails>,
}

impl Library {
    /// `cache` keeps the images; without it none are made.
    pub fn new(folder: Option<PathBuf>, cache: Option<PathBuf>) -> Self {
        Self {
            folder,
            cache,
            hold: Arc::new(AtomicBool::new(true)),
            ..Self::default()
        }
    }

    /// Set while images have to wait.
    pub fn holder(&self) -> Arc<AtomicBool> {
        self.hold.clone()
    }

    /// Whether images have to wait.
    pub fn hold(&self, is_held: bool) {
        self.hold.store(is_held, Ordering::Relaxed);
    }

    /// The image of a shipped material, by its place among them.
    pub fn shipped_picture(&self, index: usize) -> Option<&TextureHandle> {
        self.textures.get(self.shipped.get(index)?)
    }

    /// The image of a material of the user's.
    pub fn picture(&self, key: u64) -> Option<&TextureHandle> {
        self.textures.get(&key)
    }

    /// Has the name of a material of the user's typed, which begins as the one that it has.
    pub fn ask_name(&mut self, path: PathBuf) {
        let own = self.own.iter().find(|shown| shown.entry.path == path);
        if let Some(Ok(material)) = own.map(|shown| &shown.entry.material) {
            self.renaming = Some((path, material.name.clone()));
        }
    }

    pub fn take_list(&mut self, entries: Vec<Entry>) {
        let show = |entry: Entry| MaterialCard {
            key: entry.material.as_ref().map_or(0, thumbnails::key),
            entry,
        };
        self.own = entries.into_iter().map(show).collect();
        self.is_asked = false;
    }

    /// Has images made of the document's materials, and gives that of each; `is_in_flow`: they are being edited.
    pub fn pictures_of(
        &mut self,
        ctx: &egui::Context,
        materials: &[MaterialSettings],
        is_in_flow: bool,
    ) -> Vec<Option<TextureHandle>> {
        let is_known = |(known, material): (&(MaterialSettings, u64), &MaterialSettings)| known.0 == *material;
        let is_same =
            self.in_document.len() == materials.len() && std::iter::zip(&self.in_document, materials).all(is_known);
        if !is_in_flow && !is_same {
            let keyed = |material: &MaterialSettings| (material.clone(), thumbnails::key(material));
            self.in_document = materials.iter().map(keyed).collect();
            self.is_asked = false;
        }
        self.make_pictures(ctx);
        // While a material is edited its image is that from before.
        let picture = |place: usize| self.textures.get(&self.in_document.get(place)?.1).cloned();
        (0..materials.len()).map(picture).collect()
    }

    /// Asks for images that are not there yet, and takes those that are. To be called while they are seen.
    pub fn make_pictures(&mut self, ctx: &egui::Context) {
        let Some(cache) = &self.cache else {
            return;
        };
        if self.shipped.is_empty() {
            self.shipped = PRESETS.iter().map(thumbnails::key).collect();
        }
        let worker = started(&mut self.worker, ctx, |repaint| {
            thumbnails::spawn_thumbnails(cache.join("thumbnails"), self.hold.clone(), repaint)
        });
        let Some(worker) = worker else {
            // Colours stand in for images.
            self.cache = None;
            return;
        };
        if !std::mem::replace(&mut self.is_asked, true) {
            let own = self.own.iter().filter_map(|shown| shown.entry.material.as_ref().ok());
            let all = self
                .in_document
                .iter()
                .map(|(material, _)| material)
                .chain(PRESETS.iter())
                .chain(own)
                .chain(&self.watched);
            worker.ask(all.cloned().collect::<Vec<MaterialSettings>>());
        }
        let Some(made) = worker.latest() else {
            return;
        };
        if self.uploaded.as_ref().is_some_and(|of| Arc::ptr_eq(of, &made)) {
            return;
        }
        for (key, pixels) in made.iter() {
            self.textures.entry(*key).or_insert_with(|| {
                let image = ColorImage::from_rgba_unmultiplied([SIDE as usize; 2], pixels);
                ctx.load_texture("material", image, TextureOptions::LINEAR)
            });
        }
        self.uploaded = Some(made);
    }
}
