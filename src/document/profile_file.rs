//! The name of a light profile's file.

use std::{path::Path, path::PathBuf, sync::Mutex};

use serde::{Deserialize, Serialize};

use crate::panics::lock;

/// The file of a light's profile. Each name is kept once for the life of the program, so that lights stay plain values.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(from = "PathBuf", into = "PathBuf")]
pub struct ProfileFile(&'static Path);

impl ProfileFile {
    /// The file of this name.
    pub fn new(path: &Path) -> Self {
        static NAMES: Mutex<Vec<&'static Path>> = Mutex::new(Vec::new());
        let mut names = lock(&NAMES);
        if let Some(known) = names.iter().find(|known| **known == path) {
            return Self(known);
        }
        let kept: &'static Path = Box::leak(path.to_owned().into_boxed_path());
        names.push(kept);
        Self(kept)
    }

    pub fn path(&self) -> &'static Path {
        self.0
    }
}

impl From<PathBuf> for ProfileFile {
    fn from(path: PathBuf) -> Self {
        Self::new(&path)
    }
}

impl From<ProfileFile> for PathBuf {
    fn from(file: ProfileFile) -> Self {
        file.0.to_owned()
    }
}
