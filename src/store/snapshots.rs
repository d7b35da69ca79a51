//! Pinned states: a folder of thumbnails that carry their documents.

use std::{fs, io::Cursor, path::Path, path::PathBuf};

use image::RgbaImage;

use super::{
    FileError,
    library::{free_path, moved, paths_in},
    picture::{parse_picture_document, png_bytes, png_image},
    project::document_text,
    replace::save_atomically,
};
use crate::{document::Document, import::endings::has_ending};

/// Longest side of a pinned image, pixels.
pub const SIDE_MAX: u32 = 256;

/// A pinned state.
#[derive(Clone, Debug, PartialEq)]
pub struct Pinned {
    pub path: PathBuf,
    /// What it is called: the file's name.
    pub name: String,
    pub document: Document,
    /// Alpha is not premultiplied.
    pub picture: RgbaImage,
}

/// The pinned states of a folder, the newest first, and what is wrong with files that cannot be read; none where it is
/// not there.
pub fn list(folder: &Path) -> Result<(Vec<Pinned>, Vec<String>), FileError> {
    let is_png = |path: &PathBuf| has_ending(path, &["png"]);
    let (mut found, mut errors) = (Vec::new(), Vec::new());
    for path in paths_in(folder)?.into_iter().filter(is_png) {
        let at = fs::metadata(&path).and_then(|metadata| metadata.modified()).ok();
        match read(&path) {
            Ok(pinned) => found.push((at, pinned)),
            Err(error) => errors.push(error.to_string()),
        }
    }
    found.sort_by(|(at, a), (other, b)| other.cmp(at).then_with(|| b.path.cmp(&a.path)));
    Ok((found.into_iter().map(|(_, pinned)| pinned).collect(), errors))
}

fn read(path: &Path) -> Result<Pinned, FileError> {
    let bytes = fs::read(path).map_err(FileError::reading(path))?;
    let document = parse_picture_document(path, Cursor::new(&bytes))?.value;
    let picture = png_image(&bytes)
        .map_err(|error| FileError::content(path, format!("not a whole PNG image ({error}); delete it")))?;
    Ok(Pinned {
        path: path.to_owned(),
        name: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        document,
        picture,
    })
}

/// Pins a document with its image, which is made smaller; its file is named after its first material. The folder is made
/// where it is not there.
pub fn add(folder: &Path, document: &Document, picture: &RgbaImage) -> Result<PathBuf, FileError> {
    fs::create_dir_all(folder).map_err(FileError::writing(folder))?;
    let first = document.materials.first().map_or("", |material| material.name.as_str());
    let path = free_path(folder, &file_stem(first), ".png");
    save(&path, document, picture)?;
    Ok(path)
}

/// Writes a pinned state.
pub fn save(path: &Path, document: &Document, picture: &RgbaImage) -> Result<(), FileError> {
    let longest = picture.width().max(picture.height()).max(SIDE_MAX);
    let side = |side: u32| (side * SIDE_MAX / longest).max(1);
    let picture = image::imageops::thumbnail(picture, side(picture.width()), side(picture.height()));
    let text = document_text(path, document)?;
    let bytes = png_bytes(picture.dimensions().into(), &picture, Some(&text));
    save_atomically(path, &bytes.map_err(|reason| FileError::content(path, reason))?)
}

/// Gives a pinned state another name, beside one that has it already; what files can't be called is left out.
pub fn rename(path: &Path, name: &str) -> Result<PathBuf, FileError> {
    let stem = file_stem(name);
    if path.file_stem().is_some_and(|old| *old == *stem) {
        return Ok(path.to_owned());
    }
    moved(path, path.parent().unwrap_or(Path::new(".")), &stem)
}

/// A name as that of a file, with what is allowed everywhere.
fn file_stem(name: &str) -> String {
    let allowed = |c: char| c.is_alphanumeric() || " -_.,()".contains(c);
    let chars = name.chars().map(|c| if allowed(c) { c } else { ' ' });
    let name: String = chars.take(60).collect();
    // Names that begin or end with a dot are hidden, or refused.
    match name.trim_matches([' ', '.']) {
        "" => "Snapshot".to_owned(),
        name => name.to_owned(),
    }
}
