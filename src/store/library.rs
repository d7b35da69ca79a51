//! A folder of the user's materials, those with images in folders of their own; what is removed can be restored.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::FileError;
use super::preset::{command_line_name, load_material, save_material};
use super::replace::save_atomically;
use crate::document::MaterialSettings;

/// A file of the folder.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    pub path: PathBuf,
    /// Its material, or what is wrong with it.
    pub material: Result<MaterialSettings, String>,
}

impl Entry {
    /// What to call it: the material's name, else the file's.
    pub fn name(&self) -> String {
        let stem = || self.path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        self.material
            .as_ref()
            .map_or_else(|_| stem(), |material| material.name.clone())
    }
}

/// The materials in a folder by name; none where it is not there.
pub fn list(folder: &Path) -> Result<Vec<Entry>, FileError> {
    let files = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        other => other.map_err(FileError::reading(folder))?,
    };
    let paths = files.flatten().flat_map(|file| materials_at(&file.path()));
    let mut entries: Vec<Entry> = paths
        .map(|path| Entry {
            material: load_material(&path).map(|loaded| loaded.value).map_err(crate::in_words),
            path,
        })
        .collect();
    entries.sort_by_key(|entry| (entry.name().to_lowercase(), entry.path.clone()));
    Ok(entries)
}

/// The material that is a file, or the one in a folder for one.
fn materials_at(path: &Path) -> Option<PathBuf> {
    let is_json = |ending: &std::ffi::OsStr| ending.eq_ignore_ascii_case("json");
    if path.extension().is_some_and(is_json) {
        return Some(path.to_owned());
    }
    let within = file_within(path)?;
    within.is_file().then_some(within)
}

/// The file in a folder for one material, which has its name.
fn file_within(home: &Path) -> Option<PathBuf> {
    let is_home = home.extension().is_some_and(|ending| ending == HOME);
    let mut name = home.file_stem()?.to_owned();
    name.push(".json");
    is_home.then(|| home.join(name))
}

/// Adds a material in a file named after it; no other file is replaced. One with images gets a folder, with copies of them.
/// The folder is made where it is not there.
pub fn add(folder: &Path, material: &MaterialSettings) -> Result<PathBuf, FileError> {
    fs::create_dir_all(folder).map_err(FileError::writing(folder))?;
    let stem = file_stem(&material.name);
    if material.user_textures.iter().next().is_none() {
        let path = free_path(folder, &stem, "json");
        save_material(&path, material)?;
        return Ok(path);
    }
    let home = free_path(folder, &stem, HOME);
    fs::create_dir_all(&home).map_err(FileError::writing(&home))?;
    let material = with_copies(material, &home)?;
    let path = file_within(&home).unwrap_or(home);
    save_material(&path, &material)?;
    Ok(path)
}

/// The material with its images copied to a folder. One that is not there any more stays named as it is.
fn with_copies(material: &MaterialSettings, home: &Path) -> Result<MaterialSettings, FileError> {
    let mut copies: Vec<(PathBuf, PathBuf)> = Vec::new();
    for (_, texture) in material
        .user_textures
        .iter()
        .filter(|(_, texture)| texture.file.is_file())
    {
        if copies.iter().any(|(of, _)| *of == texture.file) {
            continue;
        }
        let part = |part: Option<&std::ffi::OsStr>| part.unwrap_or_default().to_string_lossy().into_owned();
        let copy = free_path(home, &part(texture.file.file_stem()), &part(texture.file.extension()));
        fs::copy(&texture.file, &copy).map_err(FileError::writing(&copy))?;
        copies.push((texture.file.clone(), copy));
    }
    let mut material = material.clone();
    material.user_textures.map_files(|file| {
        let copy = copies.iter().find(|(of, _)| of == file);
        copy.map_or_else(|| file.to_owned(), |(_, copy)| copy.clone())
    });
    Ok(material)
}

/// The folder of a material that has one of its own. Its ending sets it apart from the folder of all, which may have a material's name.
fn own_folder(path: &Path) -> Option<&Path> {
    let folder = path.parent()?;
    (file_within(folder)? == path).then_some(folder)
}

/// The folder that a material is in, its own left aside.
fn root(path: &Path) -> &Path {
    own_folder(path).unwrap_or(path).parent().unwrap_or(Path::new("."))
}

/// Gives a material another name, and its file, too.
///
/// # Errors
/// What is wrong with the file, or [`FileError::Write`]; the material then has its old name.
pub fn rename(path: &Path, name: &str) -> Result<PathBuf, FileError> {
    let mut material = load_material(path)?.value;
    if material.name == name {
        return Ok(path.to_owned());
    }
    let Some(folder) = own_folder(path) else {
        material.name = name.to_owned();
        let renamed = add(root(path), &material)?;
        // Not kept, so that what was removed before can still be restored.
        fs::remove_file(path).map_err(FileError::writing(path))?;
        return Ok(renamed);
    };
    // Moved, so that it keeps all that is in it.
    let home = free_path(root(path), &file_stem(name), HOME);
    let renamed = moved_home(folder, path, &home)?;
    // Its images are beside it in the new place.
    let mut material = load_material(&renamed)?.value;
    material.name = name.to_owned();
    save_material(&renamed, &material)?;
    Ok(renamed)
}

/// Adds a copy of a material under another name.
pub fn duplicate(path: &Path) -> Result<PathBuf, FileError> {
    let mut material = load_material(path)?.value;
    material.name.push_str(" copy");
    add(root(path), &material)
}

/// A material that was removed, to be restored.
#[derive(Clone, Debug, PartialEq)]
pub struct Removed {
    path: PathBuf,
    kept: Remains,
}

/// What is kept of it.
#[derive(Clone, Debug, PartialEq)]
enum Remains {
    Bytes(Vec<u8>),
    /// Its folder, hidden beside the others until the next one is removed.
    Folder(PathBuf),
}

/// Ending of a folder for one material and its images. No material's file is called so.
const HOME: &str = "material";

/// The folder in which the one that was removed last is kept.
const REMOVED: &str = ".removed";

impl Removed {
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Removes a material, with its folder where it has one.
///
/// # Errors
/// [`FileError`]; it is then still there.
pub fn remove(path: &Path) -> Result<Removed, FileError> {
    if let Some(folder) = own_folder(path) {
        let kept = root(path).join(REMOVED);
        if kept.exists() {
            fs::remove_dir_all(&kept).map_err(FileError::writing(&kept))?;
        }
        fs::rename(folder, &kept).map_err(FileError::writing(folder))?;
        return Ok(Removed {
            path: path.to_owned(),
            kept: Remains::Folder(kept),
        });
    }
    let bytes = fs::read(path).map_err(FileError::reading(path))?;
    fs::remove_file(path).map_err(FileError::writing(path))?;
    Ok(Removed {
        path: path.to_owned(),
        kept: Remains::Bytes(bytes),
    })
}

/// Puts what was removed back, beside one that has taken its name meanwhile.
pub fn restore(removed: &Removed) -> Result<PathBuf, FileError> {
    let stem = removed
        .path
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let folder = root(&removed.path);
    match &removed.kept {
        Remains::Bytes(bytes) => {
            let ending = removed.path.extension().unwrap_or_default().to_string_lossy();
            let path = free_path(folder, &stem, &ending);
            save_atomically(&path, bytes)?;
            Ok(path)
        }
        Remains::Folder(kept) => {
            let home = free_path(folder, &stem, HOME);
            moved_home(kept, &removed.path, &home)
        }
    }
}

/// Moves a folder for one material, whose file was `path`, and gives that the folder's name.
fn moved_home(folder: &Path, path: &Path, home: &Path) -> Result<PathBuf, FileError> {
    fs::rename(folder, home).map_err(FileError::writing(home))?;
    let moved = file_within(home).unwrap_or_else(|| home.to_owned());
    let before = home.join(path.file_name().unwrap_or_default());
    if before != moved {
        fs::rename(&before, &moved).map_err(FileError::writing(&moved))?;
    }
    Ok(moved)
}

/// A material's name as that of a file, with what is allowed everywhere.
fn file_stem(name: &str) -> String {
    let allowed = |c: char| if c.is_alphanumeric() || c == '-' { c } else { '-' };
    let stem: String = command_line_name(name).chars().map(allowed).take(60).collect();
    if stem.trim_matches('-').is_empty() {
        "material".to_owned()
    } else {
        stem
    }
}

/// A file of the folder that is not there yet: `stem.ending`, else with a number; without an ending the name of a folder.
pub(super) fn free_path(folder: &Path, stem: &str, ending: &str) -> PathBuf {
    let dot = if ending.is_empty() { "" } else { "." };
    let first = folder.join(format!("{stem}{dot}{ending}"));
    let others = (2..).map(|number| folder.join(format!("{stem} {number}{dot}{ending}")));
    let is_free = |path: &PathBuf| !path.exists();
    std::iter::once(first.clone())
        .chain(others)
        .find(is_free)
        .unwrap_or(first)
}
