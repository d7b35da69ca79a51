//! Pinned states: a folder of thumbnails that carry their documents.

use std::fs;
use std::io::{self, Cursor};
use std::path::{Path, PathBuf};

use super::FileError;
use super::library::free_path;
use super::picture::{parse_picture_document, png_bytes};
use super::project::document_text;
use super::replace::save_atomically;
use crate::document::Document;

/// Longest side of a pinned image, pixels.
pub const SIDE_MAX: u32 = 256;

/// A pinned state.
#[derive(Clone, Debug, PartialEq)]
pub struct Pinned {
    pub path: PathBuf,
    /// What it is called: the file's name.
    pub name: String,
    pub document: Document,
    /// Columns and rows of its image.
    pub size: [u32; 2],
    /// Red, green, blue and alpha of 8 bits, not premultiplied, row by row from the top.
    pub rgba: Vec<u8>,
}

/// The pinned states of a folder, the newest first, and what is wrong with files that cannot be read; none where it is
/// not there.
pub fn list(folder: &Path) -> Result<(Vec<Pinned>, Vec<String>), FileError> {
    let files = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok((Vec::new(), Vec::new())),
        other => other.map_err(FileError::reading(folder))?,
    };
    let (mut found, mut errors) = (Vec::new(), Vec::new());
    for file in files.flatten() {
        let path = file.path();
        if path
            .extension()
            .is_none_or(|ending| !ending.eq_ignore_ascii_case("png"))
        {
            continue;
        }
        let at = file.metadata().and_then(|metadata| metadata.modified()).ok();
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
    let content = |reason: String| FileError::content(path, reason);
    let picture = image::load_from_memory_with_format(&bytes, image::ImageFormat::Png)
        .map_err(|error| content(format!("not a whole PNG image ({error}); delete it")))?
        .into_rgba8();
    Ok(Pinned {
        path: path.to_owned(),
        name: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        document,
        size: [picture.width(), picture.height()],
        rgba: picture.into_raw(),
    })
}

/// Pins a document with its image (8 bits of red, green, blue and alpha a pixel), which is made smaller; its file is
/// named after its first material. The folder is made where it is not there.
pub fn add(folder: &Path, document: &Document, [width, height]: [u32; 2], rgba: &[u8]) -> Result<PathBuf, FileError> {
    fs::create_dir_all(folder).map_err(FileError::writing(folder))?;
    let first = document.materials.first().map_or("", |material| material.name.as_str());
    let path = free_path(folder, &file_stem(first), "png");
    let content = |reason: String| FileError::content(&path, reason);
    let picture = image::RgbaImage::from_raw(width, height, rgba.to_vec())
        .ok_or_else(|| content("the image's size is not that of its pixels; report it".to_owned()))?;
    let longest = width.max(height).max(1);
    let picture = if longest > SIDE_MAX {
        let side = |side: u32| (side * SIDE_MAX / longest).max(1);
        image::imageops::thumbnail(&picture, side(width), side(height))
    } else {
        picture
    };
    let text = document_text(&path, document)?;
    let bytes = png_bytes([picture.width(), picture.height()], picture.as_raw(), Some(&text)).map_err(content)?;
    save_atomically(&path, &bytes)?;
    Ok(path)
}

/// Gives a pinned state another name, beside one that has it already; what files can't be called is left out.
///
/// # Errors
/// [`FileError::Write`]; it then has its old name.
pub fn rename(path: &Path, name: &str) -> Result<PathBuf, FileError> {
    let stem = file_stem(name);
    if path.file_stem().is_some_and(|old| *old == *stem) {
        return Ok(path.to_owned());
    }
    let renamed = free_path(path.parent().unwrap_or(Path::new(".")), &stem, "png");
    fs::rename(path, &renamed).map_err(FileError::writing(path))?;
    Ok(renamed)
}

/// A name as that of a file, with what is allowed everywhere.
fn file_stem(name: &str) -> String {
    let allowed = |c: char| c.is_alphanumeric() || " -_.,()".contains(c);
    let name: String = name
        .chars()
        .map(|c| if allowed(c) { c } else { ' ' })
        .take(60)
        .collect();
    // Names that begin or end with a dot are hidden, or refused.
    match name.trim_matches([' ', '.']) {
        "" => "Snapshot".to_owned(),
        name => name.to_owned(),
    }
}
