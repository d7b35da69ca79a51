//! Images that a MaterialX document names.

use std::{cell::RefCell, collections::HashMap, path::Path, path::PathBuf};

use crate::{
    import::{Budget, limits::Reach, picture::FileMean, picture::mean_of_file},
    scene::Loading,
};

/// Images that a document names: each is read once, within one budget.
pub struct Images<'p> {
    /// Folder of the document.
    folder: &'p Path,
    /// Cancellation, and images that were refused.
    loading: &'p Loading,
    budget: Budget,
    means: RefCell<HashMap<PathBuf, Result<FileMean, String>>>,
}

impl<'p> Images<'p> {
    /// Images of a document in a folder, none read.
    pub fn in_folder(folder: &'p Path, loading: &'p Loading) -> Self {
        Self {
            folder,
            loading,
            budget: Budget::of_import(),
            means: RefCell::default(),
        }
    }

    /// The file of an image by its name in the document.
    pub fn path(&self, file: &Path) -> PathBuf {
        self.folder.join(file).components().collect()
    }

    /// Mean of an image by its name in the document.
    pub fn mean(&self, file: &Path) -> Result<FileMean, String> {
        if let Some(known) = self.means.borrow().get(file) {
            return known.clone();
        }
        let path = self.path(file);
        let reached = Reach::of_folder(self.folder).check(&path, self.loading);
        let wanted = self.loading.check().map_err(crate::in_words);
        let mean = wanted
            .and_then(|()| reached.map_err(crate::in_words))
            .and_then(|()| mean_of_file(&path, &self.budget));
        self.means.borrow_mut().insert(file.to_owned(), mean.clone());
        mean
    }
}
