//! Pinned states: the document with its picture, kept with the user's data.

use std::collections::HashMap;
use std::path::PathBuf;

use egui::{ColorImage, TextureHandle, TextureOptions};

use super::App;
use super::disk::Done;
use crate::render::worker::Level;
use crate::store::FileError;
use crate::store::library::{self, Removed};
use crate::store::snapshots::{self, Pinned};

/// What can be done with pinned states.
#[derive(Clone, Debug, PartialEq)]
pub enum PinChange {
    /// The document is pinned with the latest picture.
    Add,
    /// A file gets another name.
    Rename(PathBuf, String),
    /// A file is removed.
    Remove(PathBuf),
    /// What was removed last comes back.
    Restore,
}

/// What came of a change: what to say, which states there are, what is wrong with files, and what was removed.
pub(super) struct PinsListed {
    words: String,
    pinned: Vec<Pinned>,
    errors: Vec<String>,
    removed: Option<Removed>,
}

/// The pinned states.
#[derive(Default)]
pub(super) struct Snapshots {
    /// Where they are; `None` where there is no place for them.
    folder: Option<PathBuf>,
    /// The newest first.
    pub(super) pinned: Vec<Pinned>,
    /// What was removed last.
    pub(super) removed: Option<Removed>,
    /// The file that is being given another name, and what was typed so far.
    pub(super) renaming: Option<(PathBuf, String)>,
    textures: HashMap<PathBuf, TextureHandle>,
}

impl Snapshots {
    pub(super) fn new(folder: Option<PathBuf>) -> Self {
        Self {
            folder,
            ..Self::default()
        }
    }

    /// The picture of a pinned state, by its place among them.
    pub(super) fn picture(&mut self, ctx: &egui::Context, index: usize) -> Option<&TextureHandle> {
        let pinned = self.pinned.get(index)?;
        Some(self.textures.entry(pinned.path.clone()).or_insert_with(|| {
            let size = pinned.size.map(|side| side as usize);
            let image = ColorImage::from_rgba_unmultiplied(size, &pinned.rgba);
            ctx.load_texture("snapshot", image, TextureOptions::LINEAR)
        }))
    }
}

impl App {
    /// Lists the pinned states, beside the window.
    pub(super) fn list_snapshots(&mut self) {
        if let Some(folder) = self.panels.snapshots.folder.clone() {
            self.files.disk.list(move || {
                Done::ListedPins(snapshots::list(&folder).map(|(pinned, errors)| PinsListed {
                    words: String::new(),
                    pinned,
                    errors,
                    removed: None,
                }))
            });
        }
    }

    /// Changes the pinned states, beside the window.
    pub(super) fn change_snapshots(&mut self, change: PinChange) {
        let Some(folder) = self.panels.snapshots.folder.clone() else {
            self.say(
                Level::Error,
                "there is no folder for snapshots: set HOME, or save the picture as a .png, which has the document inside",
            );
            return;
        };
        let picture = self.worker.snapshot().picture.clone();
        if change == PinChange::Add && picture.is_none() {
            self.say(Level::Warning, "there is no picture to pin yet");
            return;
        }
        let document = self.document.clone();
        let kept = self.panels.snapshots.removed.take();
        self.files.disk.write(move || {
            let changed = || -> Result<PinsListed, FileError> {
                let mut removed = None;
                let words = match (&change, &picture) {
                    (PinChange::Add, Some(picture)) => {
                        let rgba = crate::render::display::display(&picture.image, &picture.document.view);
                        let path = snapshots::add(&folder, &document, [picture.width, picture.height], &rgba)?;
                        format!("pinned {}", path.display())
                    }
                    (PinChange::Rename(path, name), _) => {
                        format!("renamed to {name}: {}", snapshots::rename(path, name)?.display())
                    }
                    (PinChange::Remove(path), _) => {
                        removed = Some(library::remove(path)?);
                        format!("removed {}", path.display())
                    }
                    (PinChange::Restore, _) => match &kept {
                        Some(kept) => format!("restored {}", library::restore(kept)?.display()),
                        None => String::new(),
                    },
                    (PinChange::Add, None) => String::new(),
                };
                let (pinned, errors) = snapshots::list(&folder)?;
                Ok(PinsListed {
                    words,
                    pinned,
                    errors,
                    removed,
                })
            };
            Done::ChangedPins(changed())
        });
    }

    /// Takes what there is in the folder, or says why there is nothing.
    pub(super) fn take_snapshots(&mut self, listed: Result<PinsListed, FileError>) {
        match listed {
            Ok(listed) => {
                if !listed.words.is_empty() {
                    self.say(Level::Info, listed.words);
                }
                for error in listed.errors {
                    self.say(Level::Warning, error);
                }
                let snapshots = &mut self.panels.snapshots;
                let is_there = |path: &PathBuf| listed.pinned.iter().any(|pinned| pinned.path == *path);
                snapshots.textures.retain(|path, _| is_there(path));
                snapshots.pinned = listed.pinned;
                snapshots.removed = listed.removed;
            }
            Err(error) => self.say(Level::Error, error.to_string()),
        }
    }

    /// Brings a pinned state back: an edit like others.
    pub(super) fn use_snapshot(&mut self, path: &std::path::Path) {
        let found = self.panels.snapshots.pinned.iter().find(|pinned| pinned.path == path);
        if let Some(pinned) = found {
            self.document = pinned.document.clone();
            self.edits.note(format!("Bring back {}", pinned.name), "");
            self.panels.slot = 0;
        }
    }
}
