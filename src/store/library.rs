//! A folder of the user's materials; what is removed can be restored.

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
    /// The file.
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
///
/// # Errors
/// [`FileError::Read`] where the folder can't be read.
pub fn list(folder: &Path) -> Result<Vec<Entry>, FileError> {
    let files = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        other => other.map_err(|source| FileError::Read {
            path: folder.to_owned(),
            source,
        })?,
    };
    let paths = files.flatten().map(|file| file.path());
    let mut entries: Vec<Entry> = paths
        .filter(|path| {
            path.extension()
                .is_some_and(|ending| ending.eq_ignore_ascii_case("json"))
        })
        .map(|path| Entry {
            material: load_material(&path)
                .map(|loaded| loaded.value)
                .map_err(|error| error.to_string()),
            path,
        })
        .collect();
    entries.sort_by_key(|entry| (entry.name().to_lowercase(), entry.path.clone()));
    Ok(entries)
}

/// Adds a material in a file named after it; no other file is replaced. The folder is made where it is not there.
///
/// # Errors
/// [`FileError::Write`].
pub fn add(folder: &Path, material: &MaterialSettings) -> Result<PathBuf, FileError> {
    fs::create_dir_all(folder).map_err(cannot_write(folder))?;
    let path = free_path(folder, &file_stem(&material.name), "json");
    save_material(&path, material)?;
    Ok(path)
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
    material.name = name.to_owned();
    let renamed = add(path.parent().unwrap_or(Path::new(".")), &material)?;
    remove(path)?;
    Ok(renamed)
}

/// Adds a copy of a material under another name.
///
/// # Errors
/// What is wrong with the file, or [`FileError::Write`].
pub fn duplicate(path: &Path) -> Result<PathBuf, FileError> {
    let mut material = load_material(path)?.value;
    material.name.push_str(" copy");
    add(path.parent().unwrap_or(Path::new(".")), &material)
}

/// A file that was removed, to be restored.
#[derive(Clone, Debug, PartialEq)]
pub struct Removed {
    path: PathBuf,
    bytes: Vec<u8>,
}

impl Removed {
    /// Where it was.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Removes a file.
///
/// # Errors
/// [`FileError`]; the file is then still there.
pub fn remove(path: &Path) -> Result<Removed, FileError> {
    let bytes = fs::read(path).map_err(|source| FileError::Read {
        path: path.to_owned(),
        source,
    })?;
    fs::remove_file(path).map_err(cannot_write(path))?;
    Ok(Removed {
        path: path.to_owned(),
        bytes,
    })
}

/// Puts a removed file back, beside one that has taken its name meanwhile.
///
/// # Errors
/// [`FileError::Write`].
pub fn restore(removed: &Removed) -> Result<PathBuf, FileError> {
    let text = |part: Option<&std::ffi::OsStr>| part.unwrap_or_default().to_string_lossy().into_owned();
    let folder = removed.path.parent().unwrap_or(Path::new("."));
    let path = free_path(folder, &text(removed.path.file_stem()), &text(removed.path.extension()));
    save_atomically(&path, &removed.bytes)?;
    Ok(path)
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

/// A file of the folder that is not there yet: `stem.ending`, else with a number.
pub(super) fn free_path(folder: &Path, stem: &str, ending: &str) -> PathBuf {
    let first = folder.join(format!("{stem}.{ending}"));
    let others = (2..).map(|number| folder.join(format!("{stem} {number}.{ending}")));
    let is_free = |path: &PathBuf| !path.exists();
    std::iter::once(first.clone())
        .chain(others)
        .find(is_free)
        .unwrap_or(first)
}

fn cannot_write(path: &Path) -> impl FnOnce(io::Error) -> FileError {
    let path = path.to_owned();
    move |source| FileError::Write { path, source }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::PRESETS;

    #[test]
    fn materials_are_added_listed_renamed_and_removed() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let folder = folder.path().join("materials");
        assert_eq!(list(&folder).expect("nothing is no error"), []);
        let mut material = PRESETS[3].clone();
        material.name = "../Odd: name".to_owned();
        let paths = [0, 1].map(|_| add(&folder, &material).expect("added"));
        assert_ne!(paths[0], paths[1], "no file is replaced");
        assert!(paths.iter().all(|path| path.parent() == Some(&*folder)), "{paths:?}");
        let renamed = rename(&paths[0], "Alpha").expect("renamed");
        fs::write(folder.join("broken.json"), "{").expect("a temporary file");
        let names: Vec<String> = list(&folder).expect("listed").iter().map(Entry::name).collect();
        assert_eq!(names, ["../Odd: name", "Alpha", "broken"]);
        material.name = "Alpha".to_owned();
        assert_eq!(load_material(&renamed).expect("whole").value, material);
        let removed = remove(&renamed).expect("removed");
        assert_eq!(list(&folder).expect("listed").len(), 2);
        assert_eq!(restore(&removed).expect("restored"), renamed);
        let copy = duplicate(&renamed).expect("copied");
        assert_eq!(load_material(&copy).expect("whole").value.name, "Alpha copy");
        remove(&renamed).expect("removed");
        assert_eq!(list(&folder).expect("listed").len(), 3);
        assert!(remove(&renamed).is_err() && rename(&renamed, "Beta").is_err());
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_an_error() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("file");
        fs::write(&file, "no folder").expect("a temporary file");
        let error = add(&file.join("materials"), &PRESETS[0]).expect_err("a file is no folder");
        assert!(error.to_string().contains("permissions"), "{error}");
    }
}
