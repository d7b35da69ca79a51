//! Files that are read where they are needed, and again once they were saved since.

use std::{fmt::Display, path::Path, path::PathBuf, sync::Arc, sync::Mutex, time::SystemTime};

use crate::panics::lock;

/// A file, when it was saved, and what it holds.
type CachedFile<T> = (PathBuf, Option<SystemTime>, Option<Arc<T>>);

/// The contents of the files that were asked for last, the latest at the end.
#[derive(Debug)]
pub struct Remembered<T> {
    entries: Mutex<Vec<CachedFile<T>>>,
    most: usize,
}

impl<T> Remembered<T> {
    /// Nothing yet, and never more than this many files.
    pub const fn new(most: usize) -> Self {
        Self {
            entries: Mutex::new(Vec::new()),
            most,
        }
    }

    /// What a file holds, read again if the file was saved since. `None`, logged once with its consequence, if it can't be
    /// read.
    pub fn get<E: Display>(
        &self,
        path: &Path,
        load: impl Fn(&Path) -> Result<T, E>,
        consequence: &str,
    ) -> Option<Arc<T>> {
        let saved = std::fs::metadata(path).and_then(|file| file.modified()).ok();
        let mut entries = lock(&self.entries);
        if let Some((.., contents)) = entries.iter().find(|(of, at, _)| of == path && *at == saved) {
            return contents.clone();
        }
        let contents = match load(path) {
            Ok(contents) => Some(Arc::new(contents)),
            Err(error) => {
                log::warn!("{error}; {consequence}");
                None
            }
        };
        entries.retain(|(of, ..)| of != path);
        if entries.len() >= self.most {
            entries.remove(0);
        }
        entries.push((path.to_owned(), saved, contents.clone()));
        contents
    }
}
