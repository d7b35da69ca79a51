//! What the window does about pinned states.

use std::path::PathBuf;

use crate::app::App;
use crate::app::services::disk::Done;
use crate::app::services::library::{Change, Listed};
use crate::app::services::messages::Success;
use crate::app::services::snapshots::Pins;
use crate::render::worker::Level;
use crate::store::{FileError, snapshots};

impl App {
    /// Lists the pinned states, beside the window.
    pub fn list_snapshots(&mut self) {
        if let Some(folder) = self.shared.snapshots.folder.clone() {
            self.files
                .disk
                .list(move || Done::ListedPins(snapshots::list(&folder).map(Listed::of)));
        }
    }

    /// Changes the pinned states, beside the window.
    pub fn change_snapshots(&mut self, change: Change) {
        let Some(folder) = self.shared.snapshots.folder.clone() else {
            self.report(
                Level::Error,
                "there is no folder for snapshots: set HOME, or save the image as a .png, which has the document inside",
            );
            return;
        };
        let picture = self.worker.snapshot().picture.clone();
        if change == Change::Add && picture.is_none() {
            self.report(Level::Warning, "there is no image to pin yet");
            return;
        }
        let document = self.document.clone();
        let kept = self.shared.snapshots.removed.take();
        self.files.disk.write(move || {
            let changed = || -> Result<Listed<Pins>, FileError> {
                let mut listed = Listed::default();
                match (&change, &picture) {
                    (Change::Add, Some(picture)) => {
                        let rgba = crate::render::display::display(&picture.image, &picture.document.view);
                        let path = snapshots::add(&folder, &document, [picture.width, picture.height], &rgba)?;
                        listed.done = Some(Success::with_file("Pinned", &path, ""));
                    }
                    (change, _) => listed.change(change, kept.as_ref(), snapshots::rename)?,
                }
                listed.entries = snapshots::list(&folder)?;
                Ok(listed)
            };
            Done::ChangedPins(changed())
        });
    }

    /// Takes what there is in the folder, or says why there is nothing.
    pub fn take_snapshots(&mut self, listed: Result<Listed<Pins>, FileError>) {
        match listed {
            Ok(listed) => {
                self.report_success(listed.done);
                let (pinned, errors) = listed.entries;
                self.report_all(errors);
                let snapshots = &mut self.shared.snapshots;
                let is_there = |path: &PathBuf| pinned.iter().any(|pinned| pinned.path == *path);
                snapshots.textures.retain(|path, _| is_there(path));
                snapshots.pinned = pinned;
                snapshots.removed = listed.removed;
            }
            Err(error) => self.report(Level::Error, error.to_string()),
        }
    }

    /// Brings a pinned state back: an edit like others.
    pub fn use_snapshot(&mut self, path: &std::path::Path) {
        let found = self.shared.snapshots.pinned.iter().find(|pinned| pinned.path == path);
        if let Some(pinned) = found {
            self.document = pinned.document.clone();
            self.edits.note(format!("Bring back {}", pinned.name), "");
            self.shared.selection.slot = 0;
        }
    }
}
