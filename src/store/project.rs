//! Whole documents in JSON files: `{"glossmith-document": 1, "model": "teapot", "materials": […], …}`. What is left out
//! has its default; what this version does not know is kept and written back. Files inside the project's folder are
//! named relative to it, so that the folder can be moved.

use std::{cell::RefCell, path::Path, path::PathBuf};

use serde_json::{Map, Value as Json, json};

use super::{FileError, Loaded, error::SIZE_MAX, file, own, preset, replace::save_atomically};
use crate::{
    document::{Document, MaterialSettings, ProfileFile},
    scene::{ModelSource, environment::EnvironmentSource, texture::TextureTarget, texture::UserTexture},
};

/// The version of the format.
pub const VERSION: u64 = 1;
/// Slots before which older files may put an image: each makes the materials before it.
const SLOTS_MAX: usize = 1 << 12;
/// Most materials of a file that is read: each takes kilobytes, of which the file may say none.
const MATERIALS_MAX: usize = 1 << 16;
/// The least bytes that a material takes in a file that is written.
const MATERIAL_BYTES: u64 = 1 << 10;
/// The key of the version, by which such a file is known.
pub const MARK: &str = "glossmith-document";

/// The document in a project file.
pub fn load_document(path: &Path) -> Result<Loaded<Document>, FileError> {
    parse_document(path, &file::read(path)?)
}

/// The document in a project's contents that may come from elsewhere: what lies outside of its surroundings is only named by
/// the user's own.
pub(super) fn open_document(path: &Path, bytes: &[u8]) -> Result<Loaded<Document>, FileError> {
    own::within_reach(path, bytes, parse_document(path, bytes)?, named)
}

/// The files that a document names.
fn named(document: &Document) -> Vec<PathBuf> {
    let files = RefCell::new(Vec::new());
    map_paths(&mut document.clone(), |path| {
        files.borrow_mut().push(path.to_owned());
        path.to_owned()
    });
    files.into_inner()
}

/// The document in a project file's contents. Relative file names are relative to `path`'s folder.
pub fn parse_document(path: &Path, bytes: &[u8]) -> Result<Loaded<Document>, FileError> {
    let mut object = file::object(path, bytes)?;
    let pictures = pictures_of_slots(&mut object);
    let version = file::version(path, &object, MARK)?.ok_or_else(|| FileError::WrongKind {
        path: path.to_owned(),
        expected: "project",
        mark: MARK,
    })?;
    let content = |reason: String| FileError::content(path, reason);
    let count = object.get("materials").and_then(Json::as_array).map_or(0, Vec::len);
    if count > MATERIALS_MAX {
        return Err(content(format!(
            "{count} materials, and at most {MATERIALS_MAX} are read; take out what no model shows"
        )));
    }
    let mut document = document_from_json(&object).map_err(|reason| content(format!("{reason}; correct it there")))?;
    document.check().map_err(|error| content(error.to_string()))?;
    // Materials keep by themselves what they do not know: one stands for all.
    let materials = std::mem::replace(&mut document.materials, vec![MaterialSettings::default()]);
    let known = known_part(&document).map_err(content)?;
    document.materials = materials;
    document.extra = unknown_part(&object, &known);
    document.extra.shift_remove(MARK);
    document.extra.shift_remove(own::KEY);
    for (slot, file) in pictures {
        let texture = UserTexture::of(file);
        document
            .material_mut(slot)
            .user_textures
            .set(TextureTarget::BaseColor, Some(texture));
    }
    map_paths(&mut document, file::named_in(path));
    let mut warnings = file::of_newer(path, version, VERSION);
    for material in &document.materials {
        let unknown = preset::unknown_keys(material);
        warnings.extend(unknown.map(|warning| format!("{}: {}: {warning}", path.display(), material.name)));
    }
    Ok(Loaded {
        value: document,
        warnings,
    })
}

/// Removes the base-colour textures of slots that older files kept beside the model.
fn pictures_of_slots(object: &mut Map<String, Json>) -> Vec<(usize, PathBuf)> {
    let import = object.get_mut("import").and_then(Json::as_object_mut);
    let Some(Json::Array(pictures)) = import.and_then(|import| import.shift_remove("pictures")) else {
        return Vec::new();
    };
    let picture = |picture: &Json| Some((picture["slot"].as_u64()? as usize, picture["file"].as_str()?.into()));
    let is_meant = |(slot, _): &(usize, PathBuf)| *slot < SLOTS_MAX;
    pictures.iter().filter_map(picture).filter(is_meant).collect()
}

/// Reads one part after the other before the whole, so that the message can say which one is wrong.
fn document_from_json(object: &Map<String, Json>) -> Result<Document, String> {
    for (part, json) in object {
        let mut only = Map::new();
        only.insert(part.clone(), json.clone());
        serde_json::from_value::<Document>(Json::Object(only)).map_err(|error| format!("\"{part}\": {error}"))?;
    }
    serde_json::from_value(Json::Object(object.clone())).map_err(crate::in_words)
}

/// Saves a document, replacing the file at once.
///
/// # Errors
/// [`FileError::Write`]; the old file is then untouched.
pub fn save_document(path: &Path, document: &Document) -> Result<(), FileError> {
    save_atomically(path, own_text(path, document)?.as_bytes())
}

/// The contents of a document's file at `path`, with the mark of the user's own where it names files elsewhere.
pub fn own_text(path: &Path, document: &Document) -> Result<String, FileError> {
    let count = document.materials.len();
    let too_large = || FileError::Content {
        path: path.to_owned(),
        reason: format!(
            "{count} materials do not fit the {} MiB of a project; join those of the model that are alike",
            SIZE_MAX >> 20
        ),
    };
    if count as u64 > SIZE_MAX / MATERIAL_BYTES {
        return Err(too_large());
    }
    let mut object = document_object(path, document)?;
    if let Some(mark) = own::mark(path, &named(document)) {
        object.insert(own::KEY.to_owned(), mark.into());
    }
    let text = file::text(&object);
    if text.len() as u64 > SIZE_MAX {
        return Err(too_large());
    }
    Ok(text)
}

/// The contents of a document's file at `path`, the same for every user who saves it.
pub fn document_text(path: &Path, document: &Document) -> Result<String, FileError> {
    Ok(file::text(&document_object(path, document)?))
}

fn document_object(path: &Path, document: &Document) -> Result<Map<String, Json>, FileError> {
    let mut document = document.clone();
    map_paths(&mut document, file::written_in(path));
    let content = |reason: String| FileError::content(path, reason);
    let known = known_part(&document).map_err(content)?;
    let mut object = Map::new();
    object.insert(MARK.to_owned(), json!(VERSION));
    object.extend(known);
    add_unknown(&mut object, &document.extra);
    Ok(object)
}

/// The document as JSON, `extra` left out. By way of text, so that an f32 is written with no more digits than it has.
fn known_part(document: &Document) -> Result<Map<String, Json>, String> {
    let text = serde_json::to_string(document).map_err(crate::in_words)?;
    serde_json::from_str(&text).map_err(crate::in_words)
}

/// What `object` has that `known` lacks, objects inside it searched too. Materials keep what they do not know themselves.
fn unknown_part(object: &Map<String, Json>, known: &Map<String, Json>) -> Map<String, Json> {
    let mut unknown = Map::new();
    for (key, value) in object {
        match (value, known.get(key)) {
            (_, None) => {
                unknown.insert(key.clone(), value.clone());
            }
            (Json::Object(inner), Some(Json::Object(known))) => {
                let inner = unknown_part(inner, known);
                if !inner.is_empty() {
                    unknown.insert(key.clone(), Json::Object(inner));
                }
            }
            _ => {}
        }
    }
    unknown
}

fn add_unknown(object: &mut Map<String, Json>, unknown: &Map<String, Json>) {
    for (key, value) in unknown {
        match (object.get_mut(key), value) {
            (None, _) => {
                object.insert(key.clone(), value.clone());
            }
            (Some(Json::Object(known)), Json::Object(inner)) => add_unknown(known, inner),
            // Known by now: what the document says counts.
            _ => {}
        }
    }
}

fn map_paths(document: &mut Document, map: impl Fn(&Path) -> PathBuf) {
    if let ModelSource::File(path) = &mut document.model {
        *path = map(path);
    }
    if let EnvironmentSource::File(path) = &mut document.lighting.environment {
        *path = map(path);
    }
    for file in &mut document.import.beside {
        *file = map(file);
    }
    if let Some(file) = &mut document.view.lut {
        *file = map(file);
    }
    for light in &mut document.lighting.area_lights {
        light.profile = light.profile.map(|profile| ProfileFile::new(&map(profile.path())));
    }
    if let Some(reference) = &mut document.view.reference {
        reference.file = map(&reference.file);
    }
    for material in &mut document.materials {
        material.user_textures.map_files(&map);
    }
}
