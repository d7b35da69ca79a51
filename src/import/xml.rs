//! Documents of elements with attributes.

use roxmltree::Document;

/// Most attributes of an element: the reader compares each with all before it.
const ATTRIBUTES_MAX: usize = 1000;

/// Reads a document.
pub fn parse(text: &str) -> Result<Document<'_>, String> {
    if text.split('<').any(|tag| attributes(tag) > ATTRIBUTES_MAX) {
        return Err(format!("an element has more than {ATTRIBUTES_MAX} attributes"));
    }
    Document::parse(text).map_err(|error| error.to_string())
}

/// How often something is set equal to a text in quotes; in a tag that is how many attributes it has.
fn attributes(tag: &str) -> usize {
    let is_value = |after: &&str| after.trim_start().starts_with(['"', '\'']);
    tag.split('=').skip(1).filter(is_value).count()
}
