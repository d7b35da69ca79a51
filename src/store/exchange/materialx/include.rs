//! Documents that include others (XInclude), as one text.

use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

use roxmltree::Node;

use crate::{
    import::limits::Reach,
    scene::Loading,
    store::exchange::{xml, xml::escaped},
};

/// Most files that one document includes, those that these include among them.
const FILES_MAX: usize = 256;
/// Attributes that hold for all that a document has in it; of an included one they are handed to its elements.
const PREFIX: &str = "fileprefix";
const COLORSPACE: &str = "colorspace";

/// The text of a document, with that of those which it includes in their places. Their paths are seen from the file at `path`.
pub fn whole_text(path: &Path, text: String, loading: &Loading) -> Result<String, String> {
    let mut files = vec![path.to_owned()];
    let text = expanded(path, text, &mut files, loading)?;
    // Included elements may have prefixes that their own document declared.
    Ok(if files.len() > 1 { strict(&text) } else { text })
}

fn expanded(path: &Path, text: String, files: &mut Vec<PathBuf>, loading: &Loading) -> Result<String, String> {
    let text = strict(&text);
    let document = xml::parse(&text)?;
    let includes = document.descendants().filter(is_include);
    let places: Vec<_> = includes
        .map(|node| (node.range(), node.attribute("href").unwrap_or_default().to_owned()))
        .collect();
    let mut whole = String::with_capacity(text.len());
    let mut done = 0;
    for (place, name) in places {
        whole += &text[done..place.start];
        whole += &included(path, &name, files, loading)?;
        done = place.end;
    }
    whole += &text[done..];
    Ok(whole)
}

fn is_include(node: &Node<'_, '_>) -> bool {
    node.has_tag_name(("http://www.w3.org/2001/XInclude", "include"))
}

/// The elements of a document beside another one.
fn included(path: &Path, name: &str, files: &mut Vec<PathBuf>, loading: &Loading) -> Result<String, String> {
    let wrong = |reason: String| format!("it includes {name}: {reason}");
    let relative = Path::new(name);
    let is_beside = relative
        .components()
        .all(|part| matches!(part, Component::Normal(_) | Component::CurDir | Component::ParentDir));
    if name.is_empty() || !is_beside || name.contains("://") {
        return Err(wrong(
            "only files are included that are named from the document's folder".to_owned(),
        ));
    }
    let file = path.parent().unwrap_or(Path::new("")).join(relative);
    if files.contains(&file) {
        // As MaterialX has it, what is there already is not read again.
        return Ok(String::new());
    }
    if files.len() >= FILES_MAX {
        return Err(wrong(format!("there are more than {FILES_MAX} files")));
    }
    let reach = Reach::of_folder(files[0].parent().unwrap_or(Path::new("")));
    reach.check(&file, loading).map_err(|error| wrong(error.to_string()))?;
    files.push(file.clone());
    let bytes = crate::store::file::read(&file).map_err(crate::in_words)?;
    let text = expanded(&file, String::from_utf8_lossy(&bytes).into_owned(), files, loading).map_err(wrong)?;
    let document = xml::parse(&text).map_err(wrong)?;
    let folder = relative.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.map_or_else(String::new, |folder| format!("{}/", folder.display()));
    let root = document.root_element();
    let elements = root.children().filter(Node::is_element);
    Ok(elements
        .map(|element| handed_down(&text, root, element, &folder))
        .collect())
}

/// An element with the attributes that it has from its document, whose files lie in `folder`.
fn handed_down(text: &str, root: Node<'_, '_>, element: Node<'_, '_>, folder: &str) -> String {
    let of_both = [root, element].map(|node| node.attribute(PREFIX).unwrap_or_default());
    let prefix = format!("{folder}{}", of_both.concat());
    let colorspace = element.attribute(COLORSPACE).or(root.attribute(COLORSPACE));
    let mut own = text[element.range()].to_owned();
    // From the back, so that places before stay.
    let start = element.range().start;
    let mut attributes: Vec<_> = element
        .attributes()
        .filter(|attribute| [PREFIX, COLORSPACE].contains(&attribute.name()))
        .map(|attribute| attribute.range())
        .collect();
    attributes.sort_by_key(|range| std::cmp::Reverse(range.start));
    for range in attributes {
        own.replace_range(range.start - start..range.end - start, "");
    }
    let name_end = own
        .find(|c: char| c.is_whitespace() || c == '>' || c == '/')
        .unwrap_or(1);
    let mut given = String::new();
    for (name, value) in [
        (PREFIX, Some(prefix.as_str()).filter(|prefix| !prefix.is_empty())),
        (COLORSPACE, colorspace),
    ] {
        if let Some(value) = value {
            given += &format!(" {name}=\"{}\"", escaped(value));
        }
    }
    own.insert_str(name_end, &given);
    own
}

/// The beginning of a document's outermost element.
const ROOT: &str = "<materialx";

/// A document's text as XML allows it: MaterialX's own reader takes `<` in values, as in `grid.<UDIM>.png`, and prefixes of names that
/// nothing declares.
fn strict(text: &str) -> String {
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
