//! What the window does about the user's materials.

use std::path::Path;

use crate::app::App;
use crate::app::layout::Pane;
use crate::app::services::disk::Done;
use crate::app::services::library::{Change, Listed};
use crate::app::services::messages::Success;
use crate::render::worker::Level;
use crate::store::{FileError, library};

type Materials = Listed<Vec<library::Entry>>;

impl App {
    /// Lists the user's folder, beside the window.
    pub fn list_library(&mut self) {
        if let Some(folder) = self.shared.library.folder.clone() {
            self.files
                .disk
                .list(move || Done::Listed(library::list(&folder).map(Listed::of)));
        }
    }

    /// Changes the user's folder, beside the window.
    pub fn change_library(&mut self, change: Change) {
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
            let changed = || -> Result<Materials, FileError> {
                let mut listed = Listed::default();
                let saved = |path: &Path| Some(Success::with_file("Saved", path, "one of your presets"));
                match &change {
                    Change::Add => {
                        let path = library::add(&folder, &material)?;
                        listed.done = saved(listed.added.insert(path));
                    }
                    Change::Duplicate(path) => listed.done = saved(&library::duplicate(path)?),
                    change => listed.change(change, kept.as_ref(), library::rename)?,
                }
                listed.entries = library::list(&folder)?;
                Ok(listed)
            };
            Done::ChangedLibrary(changed())
        });
    }

    /// Takes the folder's contents, or says why there are none.
    pub fn take_library(&mut self, listed: Result<Materials, FileError>) {
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
