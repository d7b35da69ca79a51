//! The user's folders: materials, and pinned states.

use std::path::PathBuf;

use egui::TextureHandle;

use crate::{
    document::Document,
    store::library::{LibraryMaterial, Removed},
    store::snapshots::Pinned,
};

/// What can be done with the files of a folder of the user's.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// Nothing: they are listed.
    List,
    /// The selected material is added, or the document pinned with the latest image.
    Add,
    /// A file gets another name.
    Rename(PathBuf, String),
    /// A material is added once more under another name.
    Duplicate(PathBuf),
    /// A file is removed.
    Remove(PathBuf),
    /// What was removed last comes back.
    Restore,
    /// The image of a pinned state is replaced by the latest.
    Retake(PathBuf),
}

/// A folder and what it holds.
pub struct Folder<T> {
    /// `None` where there is no place for it.
    pub path: Option<PathBuf>,
    pub entries: Vec<T>,
    /// What was removed last.
    pub removed: Option<Removed>,
    /// The file that is being given another name, and what was typed so far.
    pub renaming: Option<(PathBuf, String)>,
    /// What was pinned before its image was whole.
    pub unfinished: Option<(PathBuf, Document)>,
}

impl<T> Folder<T> {
    pub fn new(path: Option<PathBuf>) -> Self {
        Self {
            path,
            entries: Vec::new(),
            removed: None,
            renaming: None,
            unfinished: None,
        }
    }
}

/// By name.
pub type Library = Folder<LibraryMaterial>;
/// The newest first, with their images.
pub type Snapshots = Folder<(Pinned, TextureHandle)>;
