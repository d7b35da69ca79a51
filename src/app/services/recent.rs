//! The files opened and saved last.

use std::path::{Path, PathBuf};

use crate::import::endings::is_picture;
use crate::scene::environment::EnvironmentSource;
use crate::store::file_kind::may_hold_document;

/// Most that are remembered.
const COUNT: usize = 12;

/// The list, the latest first.
#[derive(Default)]
pub struct Recent {
    pub paths: Vec<PathBuf>,
}

impl Recent {
    /// Those that are environments.
    pub fn environments(&self) -> impl Iterator<Item = EnvironmentSource> {
        // Of images only environments are remembered, and those that have a document inside.
        let is_map = |path: &&PathBuf| is_picture(path) && !may_hold_document(path);
        self.paths.iter().filter(is_map).cloned().map(EnvironmentSource::File)
    }

    /// A file was opened or saved. Files not named in Unicode can't be remembered, as the settings are text.
    pub fn add(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        if path.to_str().is_some() {
            self.paths.retain(|known| *known != path);
            self.paths.insert(0, path);
            self.paths.truncate(COUNT);
        }
    }
}
