//! The user's materials and the small pictures of all of them.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use egui::{ColorImage, TextureHandle, TextureOptions};

use super::App;
use super::disk::Done;
use crate::document::MaterialSettings;
use crate::render::thumbnails::{self, SIDE, ThumbnailWorker, Thumbnails};
use crate::render::worker::Level;
use crate::store::library::{self, Entry, Removed};
use crate::store::{FileError, PRESETS};

/// What can be done with a material of the user's.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// The selected material is added.
    Add,
    /// A file's material gets another name.
    Rename(PathBuf, String),
    /// A file's material is added once more under another name.
    Duplicate(PathBuf),
    /// A file is removed.
    Remove(PathBuf),
    /// What was removed last comes back.
    Restore,
}

/// What came of a change: what to say, which materials there are, and what was removed.
pub(super) struct Listed {
    words: String,
    entries: Vec<Entry>,
    removed: Option<Removed>,
}

/// A material of the panel, with the key of its picture.
pub(super) struct Shown {
    pub(super) entry: Entry,
    pub(super) key: u64,
}

/// The materials to choose from.
#[derive(Default)]
pub(super) struct Library {
    /// Where the user's are; `None` where there is no place for them.
    folder: Option<PathBuf>,
    pub(super) own: Vec<Shown>,
    /// Keys of the shipped ones.
    shipped: Vec<u64>,
    pub(super) renaming: Option<(PathBuf, String)>,
    /// What was removed last.
    pub(super) removed: Option<Removed>,
    /// Set while the viewport goes first.
    hold: Arc<AtomicBool>,
    cache: Option<PathBuf>,
    worker: Option<ThumbnailWorker>,
    is_asked: bool,
    textures: HashMap<u64, TextureHandle>,
    uploaded: Option<Thumbnails>,
}

impl Library {
    /// `cache` keeps the pictures; without it none are made.
    pub(super) fn new(folder: Option<PathBuf>, cache: Option<PathBuf>) -> Self {
        Self {
            folder,
            cache,
            hold: Arc::new(AtomicBool::new(true)),
            ..Self::default()
        }
    }

    /// Set while pictures have to wait.
    pub(super) fn holder(&self) -> Arc<AtomicBool> {
        self.hold.clone()
    }

    /// Whether pictures have to wait.
    pub(super) fn hold(&self, is_held: bool) {
        self.hold.store(is_held, Ordering::Relaxed);
    }

    /// The picture of a shipped material, by its place among them.
    pub(super) fn shipped_picture(&self, index: usize) -> Option<&TextureHandle> {
        self.textures.get(self.shipped.get(index)?)
    }

    /// The picture of a material of the user's.
    pub(super) fn picture(&self, key: u64) -> Option<&TextureHandle> {
        self.textures.get(&key)
    }

    fn take_list(&mut self, entries: Vec<Entry>) {
        let show = |entry: Entry| Shown {
            key: entry.material.as_ref().map_or(0, thumbnails::key),
            entry,
        };
        self.own = entries.into_iter().map(show).collect();
        self.is_asked = false;
    }

    /// Asks for pictures that are not there yet, and takes those that are. To be called while they are seen.
    pub(super) fn make_pictures(&mut self, ctx: &egui::Context) {
        let Some(cache) = &self.cache else {
            return;
        };
        if self.shipped.is_empty() {
            self.shipped = PRESETS.iter().map(thumbnails::key).collect();
        }
        if self.worker.is_none() {
            let repainting = ctx.clone();
            let folder = cache.join("thumbnails");
            let repaint = move || repainting.request_repaint();
            let worker = thumbnails::spawn_thumbnails(folder, self.hold.clone(), repaint);
            match worker {
                Ok(worker) => self.worker = Some(worker),
                // Colours stand in for pictures.
                Err(_) => return self.cache = None,
            }
        }
        let Some(worker) = &self.worker else {
            return;
        };
        if !std::mem::replace(&mut self.is_asked, true) {
            let own = self.own.iter().filter_map(|shown| shown.entry.material.as_ref().ok());
            worker.ask(PRESETS.iter().chain(own).cloned().collect::<Vec<MaterialSettings>>());
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

impl App {
    /// Lists the user's folder, beside the window.
    pub(super) fn list_library(&mut self) {
        if let Some(folder) = self.panels.library.folder.clone() {
            self.files.disk.list(move || {
                Done::Listed(library::list(&folder).map(|entries| Listed {
                    words: String::new(),
                    entries,
                    removed: None,
                }))
            });
        }
    }

    /// Changes the user's folder, beside the window.
    pub(super) fn change_library(&mut self, change: Change) {
        let Some(folder) = self.panels.library.folder.clone() else {
            self.say(
                Level::Error,
                "there is no folder for your materials: set HOME, or save the material as a file",
            );
            return;
        };
        let material = self.desk_material();
        let kept = self.panels.library.removed.take();
        self.files.disk.write(move || {
            let changed = || -> Result<Listed, FileError> {
                let mut removed = None;
                let words = match &change {
                    Change::Add => format!("saved {}", library::add(&folder, &material)?.display()),
                    Change::Rename(path, name) => {
                        format!("renamed to {name}: {}", library::rename(path, name)?.display())
                    }
                    Change::Remove(path) => {
                        removed = Some(library::remove(path)?);
                        format!("removed {}", path.display())
                    }
                    Change::Duplicate(path) => format!("saved {}", library::duplicate(path)?.display()),
                    Change::Restore => match &kept {
                        Some(kept) => format!("restored {}", library::restore(kept)?.display()),
                        None => String::new(),
                    },
                };
                Ok(Listed {
                    words,
                    entries: library::list(&folder)?,
                    removed,
                })
            };
            Done::ChangedLibrary(changed())
        });
    }

    /// Takes the folder's contents, or says why there are none.
    pub(super) fn take_library(&mut self, listed: Result<Listed, FileError>) {
        match listed {
            Ok(listed) => {
                if !listed.words.is_empty() {
                    self.say(Level::Info, listed.words);
                }
                self.panels.library.removed = listed.removed;
                self.panels.library.take_list(listed.entries);
            }
            Err(error) => self.say(Level::Error, error.to_string()),
        }
    }
}
