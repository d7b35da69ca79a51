//! What the window does about pinned states.

use std::path::PathBuf;

use crate::app::App;
use crate::app::services::disk::Done;
use crate::app::services::messages::Success;
use crate::app::services::snapshots::{PinChange, PinsListed};
use crate::render::worker::Level;
use crate::store::{FileError, library, snapshots};

impl App {
    /// Lists the pinned states, beside the window.
    pub(in crate::app) fn list_snapshots(&mut self) {
        if let Some(folder) = self.shared.snapshots.folder.clone() {
            self.files.disk.list(move || {
                Done::ListedPins(snapshots::list(&folder).map(|(pinned, errors)| PinsListed {
                    done: None,
                    pinned,
                    errors,
                    removed: None,
                }))
            });
        }
    }

    /// Changes the pinned states, beside the window.
    pub(in crate::app) fn change_snapshots(&mut self, change: PinChange) {
        let Some(folder) = self.shared.snapshots.folder.clone() else {
            self.report(
                Level::Error,
                "there is no folder for snapshots: set HOME, or save the image as a .png, which has the document inside",
            );
            return;
        };
        let picture = self.worker.snapshot().picture.clone();
        if change == PinChange::Add && picture.is_none() {
            self.report(Level::Warning, "there is no image to pin yet");
            return;
        }
        let document = self.document.clone();
        let kept = self.shared.snapshots.removed.take();
        self.files.disk.write(move || {
            let changed = || -> Result<PinsListed, FileError> {
                let mut removed = None;
                let done = match (&change, &picture) {
                    (PinChange::Add, Some(picture)) => {
                        let rgba = crate::render::display::display(&picture.image, &picture.document.view);
                        let path = snapshots::add(&folder, &document, [picture.width, picture.height], &rgba)?;
                        Some(Success::with_file("Pinned", &path, ""))
                    }
                    (PinChange::Rename(path, name), _) => {
                        Some(Success::with_file("Renamed to", &snapshots::rename(path, name)?, ""))
                    }
                    (PinChange::Remove(path), _) => {
                        removed = Some(library::remove(path)?);
                        Some(Success::with_file("Removed", path, ""))
                    }
                    (PinChange::Restore, _) => match &kept {
                        Some(kept) => Some(Success::with_file("Restored", &library::restore(kept)?, "")),
                        None => None,
                    },
                    (PinChange::Add, None) => None,
                };
                let (pinned, errors) = snapshots::list(&folder)?;
                Ok(PinsListed {
                    done,
                    pinned,
                    errors,
                    removed,
                })
            };
            Done::ChangedPins(changed())
        });
    }

    /// Takes what there is in the folder, or says why there is nothing.
    pub(in crate::app) fn take_snapshots(&mut self, listed: Result<PinsListed, FileError>) {
        match listed {
            Ok(listed) => {
                self.report_success(listed.done);
                for error in listed.errors {
                    self.report(Level::Warning, error);
                }
                let snapshots = &mut self.shared.snapshots;
                let is_there = |path: &PathBuf| listed.pinned.iter().any(|pinned| pinned.path == *path);
                snapshots.textures.retain(|path, _| is_there(path));
                snapshots.pinned = listed.pinned;
                snapshots.removed = listed.removed;
            }
            Err(error) => self.report(Level::Error, error.to_string()),
        }
    }

    /// Brings a pinned state back: an edit like others.
    pub(in crate::app) fn use_snapshot(&mut self, path: &std::path::Path) {
        let found = self.shared.snapshots.pinned.iter().find(|pinned| pinned.path == path);
        if let Some(pinned) = found {
            self.document = pinned.document.clone();
            self.edits.note(format!("Bring back {}", pinned.name), "");
            self.shared.selection.slot = 0;
        }
    }
}
