//! MaterialX's documents as XML has them: its own reader takes `<` in values, as in `grid.<UDIM>.png`, and prefixes of names
//! that nothing declares.

use std::collections::BTreeSet;

/// The beginning of a document's outermost element.
const ROOT: &str = "<materialx";

/// A document's text as XML allows it.
pub(super) fn strict(text: &str) -> String {
    let mut whole = String::with_capacity(text.len());
    let mut prefixes = BTreeSet::new();
    let mut rest = text;
    while let Some(start) = rest.find('<') {
        whole += &rest[..start];
        rest = &rest[start..];
        if rest.starts_with("<!--") {
            let end = rest.find("-->").map_or(rest.len(), |end| end + 3);
            whole += &rest[..end];
            rest = &rest[end..];
            continue;
        }
        prefixes.extend(prefix(rest));
        let end = take_tag(rest, &mut whole);
        rest = &rest[end..];
    }
    whole += rest;
    prefixes.retain(|prefix| !text.contains(&format!("xmlns:{prefix}")));
    if let Some(start) = whole.find(ROOT) {
        let declared = prefixes.iter().map(|prefix| format!(" xmlns:{prefix}=\"{prefix}\""));
        whole.insert_str(start + ROOT.len(), &declared.collect::<String>());
    }
    whole
}

/// Takes a tag over with `<` written as `&lt;` in its values; where it ends.
fn take_tag(text: &str, whole: &mut String) -> usize {
    let mut quote = None;
    for (place, letter) in text.char_indices() {
        match (letter, quote) {
            ('<', Some(_)) => {
                whole.push_str("&lt;");
                continue;
            }
            (_, Some(open)) if letter == open => quote = None,
            ('"' | '\'', None) => quote = Some(letter),
            _ => {}
        }
        whole.push(letter);
        if letter == '>' && quote.is_none() {
            return place + 1;
        }
    }
    text.len()
}

/// The prefix of the name that a tag begins with.
fn prefix(tag: &str) -> Option<&str> {
    let name = tag.trim_start_matches(['<', '/']);
    let end = name.find(|letter: char| !(letter.is_alphanumeric() || matches!(letter, '_' | '-' | '.')))?;
    (end > 0 && name[end..].starts_with(':')).then_some(&name[..end])
}
