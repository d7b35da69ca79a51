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
        other => other.map_err(FileError::reading(folder))?,
    };
    let paths = files.flatten().flat_map(|file| materials_at(&file.path()));
    let mut entries: Vec<Entry> = paths
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
///
/// # Errors
/// [`FileError::Write`].
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
///
/// # Errors
/// What is wrong with the file, or [`FileError::Write`].
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
    /// A file's contents.
    Bytes(Vec<u8>),
    /// Its folder, hidden beside the others until the next one is removed.
    Folder(PathBuf),
}

/// Ending of a folder for one material and its images. No material's file is called so.
const HOME: &str = "material";

/// The folder in which the one that was removed last is kept.
const REMOVED: &str = ".removed";

impl Removed {
    /// Where it was.
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
///
/// # Errors
/// [`FileError::Write`].
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
        // One with the name of the folder of all.
        material.name = "Materials".to_owned();
        let path = add(&folder, &material).expect("added");
        rename(&path, "Alpha 2").expect("renamed");
        assert_eq!(list(&folder).expect("listed").len(), 4);
    }

    /// A material with images is a folder of its own, which holds all that it needs and comes back whole.
    #[test]
    fn materials_with_images_are_folders() {
        use crate::scene::texture::{TextureTarget, UserTexture};

        let place = tempfile::tempdir().expect("a temporary folder");
        let folder = place.path().join("materials");
        let images = [place.path().join("a/wood.png"), place.path().join("b/wood.png")];
        let mut material = PRESETS[0].clone();
        material.name = "Oak floor".to_owned();
        let targets = [TextureTarget::BaseColor, TextureTarget::Roughness, TextureTarget::Coat];
        let files = [images[0].clone(), images[1].clone(), place.path().join("gone.png")];
        for (number, image) in images.iter().enumerate() {
            fs::create_dir_all(image.parent().expect("a folder")).expect("made");
            fs::write(image, [number as u8]).expect("written");
        }
        for (target, file) in std::iter::zip(targets, files) {
            material.put_texture(
                target,
                UserTexture {
                    file,
                    ..UserTexture::default()
                },
            );
        }
        let path = add(&folder, &material).expect("added");
        assert_eq!(path, folder.join("oak-floor.material/oak-floor.json"));
        // Nothing of it lies elsewhere but what was gone before.
        fs::remove_dir_all(place.path().join("a")).expect("removed");
        let load = |path: &Path| load_material(path).expect("a material").value;
        let image = |material: &MaterialSettings, target: usize| {
            let texture = material.user_textures.get(targets[target]).expect("it has one");
            fs::read(&texture.file).ok()
        };
        let has_all = |path: &Path| [0, 1, 2].map(|target| image(&load(path), target));
        let whole = [Some(vec![0]), Some(vec![1]), None];
        assert_eq!(has_all(&path), whole);
        assert!(
            !fs::read_to_string(&path).expect("text").contains("/b/"),
            "by a name beside it"
        );
        fs::write(path.with_file_name("notes.txt"), "mine").expect("written");
        let renamed = rename(&path, "Floor").expect("renamed");
        assert!(
            renamed.with_file_name("notes.txt").is_file(),
            "what else is there moves along"
        );
        assert_eq!(renamed, folder.join("floor.material/floor.json"));
        assert_eq!(has_all(&renamed), whole);
        let copy = duplicate(&renamed).expect("copied");
        assert_eq!(has_all(&copy), whole);
        let removed = remove(&renamed).expect("removed");
        let names = |folder: &Path| {
            list(folder)
                .expect("listed")
                .iter()
                .map(Entry::name)
                .collect::<Vec<_>>()
        };
        assert_eq!(names(&folder), ["Floor copy"]);
        assert_eq!(restore(&removed).expect("restored"), renamed);
        assert_eq!(has_all(&renamed), whole);
        // Beside one that took its name meanwhile.
        let removed = remove(&renamed).expect("removed");
        add(&folder, &load(&copy))
            .and_then(|path| rename(&path, "Floor"))
            .expect("added");
        let restored = restore(&removed).expect("restored");
        assert_eq!(restored, folder.join("floor 2.material/floor 2.json"));
        assert_eq!(has_all(&restored), whole);
        assert_eq!(names(&folder), ["Floor", "Floor", "Floor copy"]);
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
