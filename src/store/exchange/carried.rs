//! The exact parameters of a material inside a file of another program's.
//!
//! They are the text of a material's own file, in one line, in a place that the format leaves to applications: a custom
//! property, or a comment after [`MARK`].

use std::path::Path;

use serde_json::{Map, Value as Json};

use super::{ExchangeError, ReadOptions, Subject};
use crate::{document::MaterialSettings, store::file, store::preset};

/// What stands before the parameters in a comment, and the name of the property elsewhere.
pub const MARK: &str = "glossmith_material";

/// The parameters in one line.
pub fn json(material: &MaterialSettings) -> Json {
    let mut object = Map::new();
    object.insert(preset::MARK.to_owned(), preset::VERSION.into());
    object.extend(Map::from(material.clone()));
    Json::Object(object)
}

/// The parameters as text in one line. It ends no comment: neither `--` nor `*/` is in it.
pub fn line(material: &MaterialSettings) -> String {
    json(material)
        .to_string()
        .replace("--", "-\\u002d")
        .replace("*/", "*\\u002f")
        .replace("?>", "?\\u003e")
}

pub fn comment(material: &MaterialSettings) -> String {
    format!("{MARK} {}", line(material))
}

/// The material of a property's value.
pub fn from_text(text: &str) -> Option<MaterialSettings> {
    from_json(serde_json::from_str(text).ok()?)
}

/// The material of an object.
pub fn from_json(json: Json) -> Option<MaterialSettings> {
    let Json::Object(object) = json else { return None };
    MaterialSettings::try_from(object).ok()
}

/// The materials in the comments of a file.
pub fn in_comments(path: &Path, _options: ReadOptions) -> Result<Subject, ExchangeError> {
    let bytes = file::read(path)?;
    let text = String::from_utf8_lossy(&bytes);
    let found: Vec<_> = text
        .split(&format!("{MARK} "))
        .skip(1)
        .filter_map(|rest| {
            let mut values = serde_json::Deserializer::from_str(rest).into_iter::<Json>();
            from_json(values.next()?.ok()?)
        })
        .collect();
    subject(path, found)
}

/// What a file holds of which the exact parameters alone are read.
pub fn subject(path: &Path, materials: Vec<MaterialSettings>) -> Result<Subject, ExchangeError> {
    if materials.is_empty() {
        return Err(ExchangeError::NothingCarried { path: path.to_owned() });
    }
    Ok(Subject {
        materials,
        ..Subject::default()
    })
}
