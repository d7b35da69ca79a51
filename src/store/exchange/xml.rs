//! Documents of elements with attributes, read and written.

use std::collections::HashMap;
use std::fmt::Write as _;

use roxmltree::Document;

/// Most attributes of an element: the reader compares each with all before it.
const ATTRIBUTES_MAX: usize = 1000;

/// Reads a document.
pub(super) fn parse(text: &str) -> Result<Document<'_>, String> {
    if text.split('<').any(|tag| attributes(tag) > ATTRIBUTES_MAX) {
        return Err(format!("an element has more than {ATTRIBUTES_MAX} attributes"));
    }
    Document::parse(text).map_err(crate::in_words)
}

/// How often something is set equal to a text in quotes; in a tag that is how many attributes it has.
fn attributes(tag: &str) -> usize {
    let is_value = |after: &&str| after.trim_start().starts_with(['"', '\'']);
    tag.split('=').skip(1).filter(is_value).count()
}

/// An element of a document.
#[derive(Clone, Debug, Default)]
pub(super) struct Element {
    name: &'static str,
    attributes: Vec<(&'static str, String)>,
    children: Vec<Element>,
}

impl Element {
    pub fn new(name: &'static str) -> Self {
        Self {
            name,
            ..Self::default()
        }
    }

    /// The same with another attribute.
    pub fn with(mut self, name: &'static str, value: impl Into<String>) -> Self {
        self.attributes.push((name, value.into()));
        self
    }

    /// The same with another child.
    pub fn child(mut self, child: Element) -> Self {
        self.children.push(child);
        self
    }

    pub fn push(&mut self, child: Element) {
        self.children.push(child);
    }

    /// The document of which it is the root, after a comment where there is one.
    pub fn document(&self, comment: Option<&str>) -> String {
        let mut text = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n".to_owned();
        if let Some(comment) = comment {
            let _ = writeln!(text, "<!-- {comment} -->");
        }
        self.write(&mut text, 0);
        text
    }

    fn write(&self, text: &mut String, depth: usize) {
        let indent = "  ".repeat(depth);
        let _ = write!(text, "{indent}<{}", self.name);
        for (name, value) in &self.attributes {
            let _ = write!(text, " {name}=\"{}\"", escaped(value));
        }
        if self.children.is_empty() {
            text.push_str(" />\n");
            return;
        }
        text.push_str(">\n");
        for child in &self.children {
            child.write(text, depth + 1);
        }
        let _ = writeln!(text, "{indent}</{}>", self.name);
    }
}

/// Text as an attribute's value. Control characters, which XML has no place for, are left out.
pub(super) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\n' => escaped.push_str("&#10;"),
            '\t' => escaped.push_str("&#9;"),
            c if c.is_control() || c == '\u{fffe}' || c == '\u{ffff}' => {}
            c => escaped.push(c),
        }
    }
    escaped
}

/// A name of letters, digits and underscores that begins with a letter and is not among `taken`, to which it is added. There each name
/// has the number that is tried next for one like it.
pub(super) fn identifier(name: &str, taken: &mut HashMap<String, usize>) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let mut base: String = name.trim().chars().map(plain).collect();
    if !base.starts_with(|c: char| c.is_ascii_alphabetic()) {
        base.insert_str(0, "material_");
    }
    let mut name = base.clone();
    let mut number = taken.get(&base).copied().unwrap_or(2);
    while taken.contains_key(&name) {
        name = format!("{base}_{number}");
        number += 1;
    }
    taken.insert(base, number);
    taken.entry(name.clone()).or_insert(2);
    name
}

/// Numbers with a comma and a blank between them.
pub(super) fn numbers(values: &[f32]) -> String {
    let texts: Vec<String> = values.iter().map(f32::to_string).collect();
    texts.join(", ")
}
