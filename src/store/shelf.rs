//! What lies in folders that the user keeps materials and environments in: any format that is opened, a few folders deep.

use std::{collections::HashMap, fs, path::Path, path::PathBuf, time::SystemTime};

use super::{
    exchange::{self, ExchangeError, ReadOptions, holds_materials},
    file_kind::{FileKind, MATERIAL_KINDS},
    preset::load_material,
};
use crate::document::MaterialSettings;

/// Folders below one that is watched which are looked into.
const DEPTH: usize = 3;
/// Files of a folder that are shown at most: more are not looked through, but searched for in a file manager.
pub const FILES_MAX: usize = 400;
/// Images of fewer bytes are no environments but icons and previews.
const ENVIRONMENT_BYTES_MIN: u64 = 1 << 12;

/// A file that can be used.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    pub path: PathBuf,
    pub kind: ItemKind,
}

/// What a file holds.
#[derive(Clone, Debug, PartialEq)]
pub enum ItemKind {
    /// A material, or what is wrong with it.
    Material(Result<Box<MaterialSettings>, String>),
    /// An environment, which is read once it is wanted.
    Environment,
}

/// What a folder holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Contents {
    pub folder: PathBuf,
    /// In the order of their paths; or why there are none.
    pub items: Result<Vec<Item>, String>,
    /// Whether there are more than are listed.
    pub has_more: bool,
}

/// When a file was last changed, and its length.
type Stamp = (Option<SystemTime>, u64);

/// What files hold that have been read: only what has changed is read again.
#[derive(Debug, Default)]
pub struct Shelf(HashMap<PathBuf, (Stamp, Option<ItemKind>)>);

impl Shelf {
    /// What folders hold now.
    pub fn list(&mut self, folders: &[PathBuf]) -> Vec<Contents> {
        let known = std::mem::take(&mut self.0);
        let list_one = |folder: &PathBuf| {
            let mut paths = Vec::new();
            let walked = walk(folder, 0, &mut paths);
            paths.sort();
            let has_more = paths.len() > FILES_MAX;
            paths.truncate(FILES_MAX);
            let item = |path: PathBuf| {
                let kind = self.kind(&path, &known)?;
                Some(Item { path, kind })
            };
            Contents {
                folder: folder.clone(),
                items: walked.map(|()| paths.into_iter().filter_map(item).collect()),
                has_more,
            }
        };
        folders.iter().map(list_one).collect()
    }

    fn kind(&mut self, path: &Path, known: &HashMap<PathBuf, (Stamp, Option<ItemKind>)>) -> Option<ItemKind> {
        let metadata = fs::metadata(path).ok()?;
        let stamp = (metadata.modified().ok(), metadata.len());
        let kind = match known.get(path) {
            Some((before, kind)) if *before == stamp => kind.clone(),
            _ if is_material(path) => material(path),
            _ => (stamp.1 >= ENVIRONMENT_BYTES_MIN).then_some(ItemKind::Environment),
        };
        self.0.insert(path.to_owned(), (stamp, kind.clone()));
        kind
    }
}

/// The files below a folder that may be of use, one more than are shown at most.
fn walk(folder: &Path, depth: usize, paths: &mut Vec<PathBuf>) -> Result<(), String> {
    let entries = fs::read_dir(folder).map_err(|error| {
        let folder = folder.display();
        format!("{folder} can't be read: {error}; bring it back, or stop watching it")
    })?;
    let mut folders = Vec::new();
    for entry in entries.flatten() {
        let path = entry.path();
        if entry.file_name().to_string_lossy().starts_with('.') || paths.len() > FILES_MAX {
            continue;
        }
        // Images for screens are seldom environments; where a folder holds some, they are opened by hand.
        let is_environment = FileKind::of(&path) == Some(FileKind::Light);
        // Links to folders could go round in circles.
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            folders.push(path);
        } else if is_environment || is_material(&path) {
            paths.push(path);
        }
    }
    folders.sort();
    for folder in folders.iter().filter(|_| depth < DEPTH) {
        // What can't be looked into is left out; a watched folder itself is reported.
        _ = walk(folder, depth + 1, paths);
    }
    Ok(())
}

fn is_material(path: &Path) -> bool {
    FileKind::of(path).is_some_and(|kind| MATERIAL_KINDS.contains(&kind))
}

/// A material in a file; `None` where the file holds something else, as scripts and tables without the exact parameters do.
fn material(path: &Path) -> Option<ItemKind> {
    let read = if holds_materials(path) {
        match exchange::find(&path.to_string_lossy(), ReadOptions::default()) {
            Err(ExchangeError::NothingCarried { .. }) => return None,
            opened => opened.map(|loaded| loaded.value).map_err(crate::in_words),
        }
    } else {
        let bytes = fs::read(path).ok()?;
        let json: serde_json::Value = serde_json::from_slice(&bytes).ok()?;
        json.get("material")?;
        load_material(path).map(|loaded| loaded.value).map_err(crate::in_words)
    };
    Some(ItemKind::Material(read.map(Box::new)))
}
