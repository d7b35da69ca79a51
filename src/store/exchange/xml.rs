//! Documents of elements with attributes, written.

use std::collections::HashMap;

pub use crate::import::xml::parse;

/// What stands before the elements of a document.
pub const HEAD: &str = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n";

/// An element of this name and these attributes, with others in it, each on lines of its own.
pub fn element(head: &str, inside: &str) -> String {
    if inside.is_empty() {
        return format!("<{head} />\n");
    }
    let name = head.split(' ').next().unwrap_or(head);
    let inside: String = inside.lines().map(|line| format!("  {line}\n")).collect();
    format!("<{head}>\n{inside}</{name}>\n")
}

/// Text as an attribute's value. Control characters, which XML has no place for, are left out.
pub fn escaped(text: &str) -> String {
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
pub fn identifier(name: &str, taken: &mut HashMap<String, usize>) -> String {
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
pub fn numbers(values: &[f32]) -> String {
    // Without a sign before 0.
    crate::named::joined(values.iter().map(|x| x + 0.0), ", ")
}
