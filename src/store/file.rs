//! Reading and writing JSON files with care: errors that say what to do.

use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

use serde_json::{Map, Value as Json};

use super::{own, picture, preset, project};
use crate::document::{Document, MaterialSettings};
use crate::scene::resource::{self, Reach};

/// Files larger than this many bytes are taken for something else.
pub(super) const SIZE_MAX: u64 = 16 << 20;

/// What was read from a file, and what was odd about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded<T> {
    /// The contents.
    pub value: T,
    /// What the user should know, one sentence each.
    pub warnings: Vec<String>,
}

/// Why a material or project file cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The system can't read it.
    #[error("{}: cannot be read: {source}; check the path and its permissions", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Too large to be one.
    #[error("{}: too large for a material or project (over {} MiB); choose another file", path.display(), SIZE_MAX >> 20)]
    TooLarge {
        /// The file.
        path: PathBuf,
    },
    /// Not JSON, or cut short.
    #[error("{}: not valid JSON: {reason}; correct it there or save the file again", path.display())]
    NotJson {
        /// The file.
        path: PathBuf,
        /// What and where.
        reason: String,
    },
    /// JSON of something else.
    #[error("{}: not a Glossmith {expected}: it has no \"{mark}\" number; choose a file saved as {expected}", path.display())]
    WrongKind {
        /// The file.
        path: PathBuf,
        /// `material` or `project`.
        expected: &'static str,
        /// The key that tells.
        mark: &'static str,
    },
    /// A picture that was not saved by Glossmith, or whose text another program left out.
    #[error("{}: a picture without a Glossmith document inside; open one that was saved here", path.display())]
    NoDocument {
        /// The file.
        path: PathBuf,
    },
    /// Contents out of range, with what would be right.
    #[error("{}: {reason}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong and what would be right.
        reason: String,
    },
    /// It names files that lie elsewhere.
    #[error("{}: names files outside of its surroundings, which are read only where that is allowed: {}; where you trust it, allow them (--allow-outside)", path.display(), list(files))]
    Outside {
        /// The file.
        path: PathBuf,
        /// What it names.
        files: Vec<PathBuf>,
    },
    /// No such preset, no such file.
    #[error("no material is called {name} and there is no such file; the shipped ones are {known}")]
    UnknownMaterial {
        /// What was asked for.
        name: String,
        /// The names that there are.
        known: String,
    },
    /// The file cannot be written.
    #[error("{}: cannot be saved: {source}; check the folder's permissions and free space", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

fn list(files: &[PathBuf]) -> String {
    let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    names.join(", ")
}

/// Refuses a file from elsewhere that names what lies outside of its surroundings; says what of it was allowed. What was saved
/// by this user is trusted.
///
/// # Errors
/// [`FileError::Outside`].
pub(super) fn check_reach(path: &Path, mark: Option<&Json>, named: &[PathBuf]) -> Result<Vec<String>, FileError> {
    let reach = Reach::of_folder(folder(path));
    let is_own = mark.is_some_and(|mark| mark.as_str() == own::mark(path, named).as_deref());
    let is_meant = |named: &PathBuf| is_own && own::leads_away(path, named);
    let outside = named.iter().filter(|named| !is_meant(named) && !reach.encloses(named));
    let (allowed, files): (Vec<_>, Vec<_>) = outside.cloned().partition(|named| reach.has(named));
    if !files.is_empty() {
        let path = path.to_owned();
        return Err(FileError::Outside { path, files });
    }
    let told = |named: &PathBuf| format!("{}: names {}, which lies elsewhere", path.display(), named.display());
    Ok(allowed.iter().map(told).collect())
}

/// A file that holds what is edited.
#[derive(Clone, Debug, PartialEq)]
pub enum Opened {
    /// A material.
    Material(Box<Loaded<MaterialSettings>>),
    /// A whole document.
    Document(Box<Loaded<Document>>),
    /// A picture with the document that it shows.
    Picture(Box<Loaded<Document>>),
}

/// Opens a material, a project file or a picture with a document inside, whichever it is.
///
/// # Errors
/// What is wrong with the file.
pub fn open(path: &Path) -> Result<Opened, FileError> {
    if picture::is_png(path) {
        let text = picture::document_text_in(path)?;
        return Ok(Opened::Picture(Box::new(project::open_document(
            path,
            text.as_bytes(),
        )?)));
    }
    let bytes = read(path)?;
    if object(path, &bytes)?.contains_key(project::MARK) {
        Ok(Opened::Document(Box::new(project::open_document(path, &bytes)?)))
    } else {
        Ok(Opened::Material(Box::new(preset::open_material(path, &bytes)?)))
    }
}

/// A whole file, unless it is far too large.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, FileError> {
    let mut bytes = Vec::new();
    let result = resource::open(path).and_then(|file| file.take(SIZE_MAX + 1).read_to_end(&mut bytes));
    match result {
        Err(source) => Err(FileError::Read {
            path: path.to_owned(),
            source,
        }),
        Ok(_) if bytes.len() as u64 > SIZE_MAX => Err(FileError::TooLarge { path: path.to_owned() }),
        Ok(_) => Ok(bytes),
    }
}

/// The folder of a file.
pub(super) fn folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// Names of files as they are written into the file `path`: relative to its folder where they lie in it, so that the folder
/// can be moved.
pub(super) fn seen_from(path: &Path) -> impl Fn(&Path) -> PathBuf {
    let folder = absolute(folder(path));
    move |named| {
        let named = absolute(named);
        named.strip_prefix(&folder).map(Path::to_owned).unwrap_or(named)
    }
}

/// The path from the root, nothing looked up; as it is where the current folder is gone.
fn absolute(path: &Path) -> PathBuf {
    let path = if path.as_os_str().is_empty() {
        Path::new(".")
    } else {
        path
    };
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

/// The JSON object that a file is.
pub(super) fn object(path: &Path, bytes: &[u8]) -> Result<Map<String, Json>, FileError> {
    // Some editors put a byte order mark before the text.
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    serde_json::from_slice(bytes).map_err(|error| FileError::NotJson {
        path: path.to_owned(),
        reason: error.to_string(),
    })
}

/// The version number under `mark`, `None` where there is none.
pub(super) fn version(path: &Path, object: &Map<String, Json>, mark: &str) -> Result<Option<u64>, FileError> {
    let Some(number) = object.get(mark) else {
        return Ok(None);
    };
    let error = || FileError::Content {
        path: path.to_owned(),
        reason: format!("\"{mark}\" must be the version of the format, a whole number such as 1"),
    };
    number.as_u64().map(Some).ok_or_else(error)
}

/// JSON to be read by people: a key a line, lists of numbers on one.
pub(super) fn text(object: &Map<String, Json>) -> String {
    let mut text = String::new();
    write_object(&mut text, object, 0);
    text.push('\n');
    text
}

fn write_object(text: &mut String, object: &Map<String, Json>, depth: usize) {
    let entries = object.iter().map(|(key, value)| (Some(key.as_str()), value));
    write_entries(text, ['{', '}'], entries, depth);
}

fn write_entries<'a>(
    text: &mut String,
    [open, close]: [char; 2],
    entries: impl Iterator<Item = (Option<&'a str>, &'a Json)>,
    depth: usize,
) {
    let mut is_empty = true;
    text.push(open);
    for (key, value) in entries {
        text.push_str(if is_empty { "\n" } else { ",\n" });
        text.push_str(&"  ".repeat(depth + 1));
        if let Some(key) = key {
            text.push_str(&format!("{}: ", Json::from(key)));
        }
        write_value(text, value, depth + 1);
        is_empty = false;
    }
    if !is_empty {
        text.push('\n');
        text.push_str(&"  ".repeat(depth));
    }
    text.push(close);
}

fn write_value(text: &mut String, value: &Json, depth: usize) {
    match value {
        Json::Object(object) => write_object(text, object, depth),
        Json::Array(list) if list.iter().any(has_object) => {
            write_entries(text, ['[', ']'], list.iter().map(|item| (None, item)), depth);
        }
        Json::Array(list) => {
            text.push('[');
            for (i, item) in list.iter().enumerate() {
                text.push_str(if i > 0 { ", " } else { "" });
                write_value(text, item, depth);
            }
            text.push(']');
        }
        simple => text.push_str(&simple.to_string()),
    }
}

fn has_object(value: &Json) -> bool {
    match value {
        Json::Object(_) => true,
        Json::Array(list) => list.iter().any(has_object),
        _ => false,
    }
}
