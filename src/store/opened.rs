//! Files of any kind that holds what is edited.

use std::path::Path;

use super::{FileError, Loaded, file, picture, preset, project};
use crate::document::{Document, MaterialSettings};

/// A file that holds what is edited.
#[derive(Clone, Debug, PartialEq)]
pub enum Opened {
    Material(Box<Loaded<MaterialSettings>>),
    Document(Box<Loaded<Document>>),
    /// An image with the document that it shows.
    Picture(Box<Loaded<Document>>),
}

/// Opens a material, a project file or an image with a document inside, whichever it is.
pub fn open(path: &Path) -> Result<Opened, FileError> {
    if picture::is_png(path) {
        let text = picture::document_text_in(path)?;
        return Ok(Opened::Picture(Box::new(project::open_document(
            path,
            text.as_bytes(),
        )?)));
    }
    let bytes = file::read(path)?;
    if file::object(path, &bytes)?.contains_key(project::MARK) {
        Ok(Opened::Document(Box::new(project::open_document(path, &bytes)?)))
    } else {
        Ok(Opened::Material(Box::new(preset::open_material(path, &bytes)?)))
    }
}
