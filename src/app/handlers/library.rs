//! What the window does about the user's materials.

use crate::app::App;
use crate::app::layout::Pane;
use crate::app::services::disk::Done;
use crate::app::services::library::{Change, Listed};
use crate::render::worker::Level;
use crate::store::{FileError, library};

impl App {
    /// Lists the user's folder, beside the window.
    pub(in crate::app) fn list_library(&mut self) {
        if let Some(folder) = self.shared.library.folder.clone() {
            self.files.disk.list(move || {
                Done::Listed(library::list(&folder).map(|entries| Listed {
                    words: String::new(),
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
                let words = match &change {
                    Change::Add => {
                        let path = library::add(&folder, &material)?;
                        let words = format!("saved {}", path.display());
                        added = Some(path);
                        words
                    }
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
                if !listed.words.is_empty() {
                    self.report(Level::Info, listed.words);
                }
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
