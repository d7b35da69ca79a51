//! What the window does about the user's materials.

use std::path::Path;

use crate::app::App;
use crate::app::layout::Pane;
use crate::app::services::disk::Done;
use crate::app::services::library::{Change, Listed};
use crate::app::services::messages::Success;
use crate::render::worker::Level;
use crate::store::{FileError, library};

impl App {
    /// Lists the user's folder, beside the window.
    pub(in crate::app) fn list_library(&mut self) {
        if let Some(folder) = self.shared.library.folder.clone() {
            self.files.disk.list(move || {
                Done::Listed(library::list(&folder).map(|entries| Listed {
                    done: None,
                    entries,
                    added: None,
                    removed: None,
                }))
            });
        }
    }

    /// Changes the user's folder, beside the window.
    pub(in crate::app) fn change_library(&mut self, change: Change) {
        let Some(folder) = self.shared.library.folder.clone() else {
            self.report(
                Level::Error,
                "there is no folder for your materials: set HOME, or save the material as a file",
            );
            return;
        };
        let material = self.desk_material();
        let kept = self.shared.library.removed.take();
        self.files.disk.write(move || {
            let changed = || -> Result<Listed, FileError> {
                let (mut added, mut removed) = (None, None);
                let saved = |path: &Path| Success::with_file("Saved", path, "one of your presets");
                let done = match &change {
                    Change::Add => {
                        let path = library::add(&folder, &material)?;
                        Some(saved(added.insert(path)))
                    }
                    Change::Rename(path, name) => {
                        Some(Success::with_file("Renamed to", &library::rename(path, name)?, ""))
                    }
                    Change::Remove(path) => {
                        removed = Some(library::remove(path)?);
                        Some(Success::with_file("Removed", path, ""))
                    }
                    Change::Duplicate(path) => Some(saved(&library::duplicate(path)?)),
                    Change::Restore => match &kept {
                        Some(kept) => Some(Success::with_file("Restored", &library::restore(kept)?, "")),
                        None => None,
                    },
                };
                Ok(Listed {
                    done,
                    entries: library::list(&folder)?,
                    added,
                    removed,
                })
            };
            Done::ChangedLibrary(changed())
        });
    }

    /// Takes the folder's contents, or says why there are none.
    pub(in crate::app) fn take_library(&mut self, listed: Result<Listed, FileError>) {
        match listed {
            Ok(listed) => {
                self.report_success(listed.done);
                self.shared.library.removed = listed.removed;
                self.shared.library.take_list(listed.entries);
                if let Some(path) = listed.added {
                    self.reveal(Pane::Presets);
                    self.shared.library.ask_name(path);
                }
            }
            Err(error) => self.report(Level::Error, error.to_string()),
        }
    }
}
