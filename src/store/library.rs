//! A folder of the user's materials, those with images in folders of their own; what is removed can be restored.

use std::{collections::HashMap, fs, io, path::Path, path::PathBuf};

use super::FileError;
use super::preset::{command_line_name, load_material, save_material};
use crate::{document::MaterialSettings, import::endings::has_ending};

/// A file of the folder.
#[derive(Clone, Debug, PartialEq)]
pub struct LibraryMaterial {
    pub path: PathBuf,
    /// Its material, or what is wrong with it.
    pub material: Result<MaterialSettings, String>,
}

impl LibraryMaterial {
    /// What to call it: the material's name, else the file's.
    pub fn name(&self) -> String {
        match &self.material {
            Ok(material) => material.name.clone(),
            Err(_) => stem(&self.path),
        }
    }
}

/// What is in a folder; nothing where it is not there.
pub(super) fn paths_in(folder: &Path) -> Result<Vec<PathBuf>, FileError> {
    match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        other => {
            let files = other.map_err(FileError::reading(folder))?;
            Ok(files.flatten().map(|file| file.path()).collect())
        }
    }
}

/// The materials in a folder by name; none where it is not there.
pub fn list(folder: &Path) -> Result<Vec<LibraryMaterial>, FileError> {
    let paths = paths_in(folder)?.into_iter().filter_map(material_at);
    let mut entries: Vec<LibraryMaterial> = paths
        .map(|path| LibraryMaterial {
            material: load_material(&path).map(|loaded| loaded.value).map_err(crate::in_words),
            path,
        })
        .collect();
    entries.sort_by_key(|entry| (entry.name().to_lowercase(), entry.path.clone()));
    Ok(entries)
}

/// The material that is a file, or the one in a folder for one.
fn material_at(path: PathBuf) -> Option<PathBuf> {
    if has_ending(&path, &["json"]) {
        return Some(path);
    }
    file_within(&path).filter(|within| within.is_file())
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// The ending with its dot.
fn ending(path: &Path) -> String {
    let ending = path.extension();
    ending.map_or_else(String::new, |ending| format!(".{}", ending.to_string_lossy()))
}

/// The file in a folder for one material, which has its name.
fn file_within(home: &Path) -> Option<PathBuf> {
    (ending(home) == HOME).then(|| home.join(format!("{}.json", stem(home))))
}

/// Adds a material in a file named after it; no other file is replaced. One with images gets a folder, with copies of them.
/// The folder is made where it is not there.
pub fn add(folder: &Path, material: &MaterialSettings) -> Result<PathBuf, FileError> {
    fs::create_dir_all(folder).map_err(FileError::writing(folder))?;
    let name = file_stem(&material.name);
    if material.user_textures.iter().next().is_none() {
        let path = free_path(folder, &name, ".json");
        save_material(&path, material)?;
        return Ok(path);
    }
    let home = free_path(folder, &name, HOME);
    fs::create_dir_all(&home).map_err(FileError::writing(&home))?;
    let material = with_copies(material, &home)?;
    let path = file_within(&home).unwrap_or(home);
    save_material(&path, &material)?;
    Ok(path)
}

/// The material with its images copied to a folder. One that is not there any more stays named as it is.
fn with_copies(material: &MaterialSettings, home: &Path) -> Result<MaterialSettings, FileError> {
    let mut copies: HashMap<PathBuf, PathBuf> = HashMap::new();
    for (_, texture) in material.user_textures.iter() {
        let file = &texture.file;
        if file.is_file() && !copies.contains_key(file) {
            let copy = free_path(home, &stem(file), &ending(file));
            fs::copy(file, &copy).map_err(FileError::writing(&copy))?;
            copies.insert(file.clone(), copy);
        }
    }
    let mut material = material.clone();
    let copied = |file: &Path| copies.get(file).map_or_else(|| file.to_owned(), PathBuf::clone);
    material.user_textures.map_files(copied);
    Ok(material)
}

/// The folder of a material that has one of its own. Its ending sets it apart from the folder of all, which may have a material's name.
fn own_folder(path: &Path) -> Option<&Path> {
    let folder = path.parent()?;
    (file_within(folder)? == path).then_some(folder)
}

/// The folder that a document is in, its own left aside.
fn root(path: &Path) -> &Path {
    own_folder(path).unwrap_or(path).parent().unwrap_or(Path::new("."))
}

/// Moves a document's file, or its own folder with all that is in it, into a folder under another name, beside one that
/// has it already.
pub(super) fn moved(path: &Path, into: &Path, name: &str) -> Result<PathBuf, FileError> {
    fs::create_dir_all(into).map_err(FileError::writing(into))?;
    let from = own_folder(path).unwrap_or(path);
    let to = free_path(into, name, &ending(from));
    fs::rename(from, &to).map_err(FileError::writing(path))?;
    let (Some(moved), Some(file)) = (file_within(&to), path.file_name()) else {
        return Ok(to);
    };
    fs::rename(to.join(file), &moved).map_err(FileError::writing(&moved))?;
    Ok(moved)
}

/// Gives a material another name, and its file, too.
pub fn rename(path: &Path, name: &str) -> Result<PathBuf, FileError> {
    if load_material(path)?.value.name == name {
        return Ok(path.to_owned());
    }
    let renamed = moved(path, root(path), &file_stem(name))?;
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

/// A document that was removed, to be restored.
#[derive(Clone, Debug, PartialEq)]
pub struct Removed {
    pub path: PathBuf,
    /// Where it is hidden beside the others until the next one is removed.
    kept: PathBuf,
}

/// Ending of a folder for one material and its images. No material's file is called so.
const HOME: &str = ".material";

/// The folder in which the one that was removed last is kept.
const REMOVED: &str = ".removed";

/// Removes a document, with its folder where it has one.
pub fn remove(path: &Path) -> Result<Removed, FileError> {
    let hidden = root(path).join(REMOVED);
    if hidden.exists() {
        fs::remove_dir_all(&hidden).map_err(FileError::writing(&hidden))?;
    }
    Ok(Removed {
        path: path.to_owned(),
        kept: moved(path, &hidden, &stem(path))?,
    })
}

/// Puts what was removed back, beside one that has taken its name meanwhile.
pub fn restore(removed: &Removed) -> Result<PathBuf, FileError> {
    moved(&removed.kept, root(&removed.path), &stem(&removed.path))
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

/// A file of the folder that is not there yet: of this name, else with a number.
pub(super) fn free_path(folder: &Path, name: &str, ending: &str) -> PathBuf {
    let first = folder.join(format!("{name}{ending}"));
    let mut others = (2..).map(|number| folder.join(format!("{name} {number}{ending}")));
    match first.exists() {
        true => others.find(|path| !path.exists()).unwrap_or(first),
        false => first,
    }
}
