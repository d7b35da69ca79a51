//! Reading and writing JSON files with care.

use std::{borrow::Cow, io::ErrorKind, path::Path, path::PathBuf};

use serde_json::{Map, Value as Json};

use super::error::{FileError, SIZE_MAX};
use crate::{
    import::limits,
    scene::path_text::{path_of_text, path_text},
};

/// What was read from a file, and what was odd about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded<T> {
    pub value: T,
    /// What the user should know, one sentence each.
    pub warnings: Vec<String>,
}

/// A whole file, or a shipped map, unless it is far too large.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, FileError> {
    limits::read(path, SIZE_MAX).map_err(|error| match error.kind() {
        ErrorKind::FileTooLarge => FileError::TooLarge { path: path.to_owned() },
        _ => FileError::reading(path)(error),
    })
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

/// Names of files as texts of the file `path`: as [`seen_from`] it, or addresses where they are not Unicode.
pub(super) fn written_in(path: &Path) -> impl Fn(&Path) -> PathBuf {
    let seen = seen_from(path);
    move |named| {
        let seen = seen(named);
        match path_text(&seen) {
            Cow::Borrowed(_) => seen,
            Cow::Owned(_) => path_text(&absolute(named)).into_owned().into(),
        }
    }
}

/// Files by their names in the file `path`, the inverse of [`written_in`].
pub(super) fn named_in(path: &Path) -> impl Fn(&Path) -> PathBuf {
    let folder = folder(path);
    move |named| folder.join(named.to_str().map_or(named.to_owned(), path_of_text))
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

/// A warning where a file's format is newer than the newest that is known.
pub(super) fn of_newer(path: &Path, version: u64, known: u64) -> Vec<String> {
    let path = path.display();
    let warning = || {
        format!(
            "{path}: written by a newer Glossmith (format {version}, this one knows {known}); what is new has no effect"
        )
    };
    (version > known).then(warning).into_iter().collect()
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
    let error = || format!("\"{mark}\" must be the version of the format, a whole number such as 1");
    number
        .as_u64()
        .map(Some)
        .ok_or_else(|| FileError::content(path, error()))
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
