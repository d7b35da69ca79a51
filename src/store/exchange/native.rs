//! Glossmith's own files: nothing is lost.

use std::path::Path;

use super::{
    ExchangeError, ReadOptions, Subject, Written,
    report::{EVERYTHING, Entry, MaterialReport},
};
use crate::{
    import::endings::has_ending,
    store::{opened, opened::Opened, preset::material_text, project::own_text},
};

pub fn write(subject: &Subject, path: &Path) -> Result<Written, ExchangeError> {
    if has_ending(path, &["png"]) {
        return Err(ExchangeError::NotWritten { path: path.to_owned() });
    }
    let text = match &subject.document {
        Some(document) if subject.materials.len() > 1 => own_text(path, document)?,
        _ => material_text(path, subject.only(path)?),
    };
    let report = |material| MaterialReport::of(material, vec![Entry::exact(EVERYTHING)]);
    Ok(Written::text(text, subject.materials.iter().map(report).collect()))
}

pub fn read(path: &Path, _options: ReadOptions) -> Result<Subject, ExchangeError> {
    Ok(match opened::open(path)? {
        Opened::Material(material) => Subject::of(material.value),
        Opened::Document(document) | Opened::Picture(document) => Subject {
            materials: document.value.materials.clone(),
            document: Some(Box::new(document.value)),
            losses: Vec::new(),
        },
    })
}
