//! The pages of the book in `docs/` as the manual shows them.

/// Pages of the book: path in `docs/`, and text. `src/main.rs` embeds them, so that an edit of a page compiles the
/// program alone.
pub type Pages = &'static [(&'static str, &'static str)];

/// The address of the list of all pages.
pub const CONTENTS: &str = "SUMMARY.md";
/// Addresses of what the sheets over the window are about: a page with an anchor or without.
pub const OF_SHEETS: [&str; 6] = [KEYS, UNSAVED, EXPLAIN, EXPORT, MODEL_FILE, TURNTABLE];
pub const KEYS: &str = "reference/window.md#keyboard-and-files";
pub const UNSAVED: &str = "reference/window.md#unsaved-work";
pub const EXPLAIN: &str = "how-to/explain.md";
pub const EXPORT: &str = "how-to/export.md";
pub const MODEL_FILE: &str = "FORMATS.md#models";
pub const TURNTABLE: &str = "how-to/turntable.md";

/// Scheme of links from page to page, as [`sections`] writes them.
pub const SCHEME: &str = "book:";

/// A heading with the text below it, up to the next heading.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Section {
    /// Number of `#`.
    pub level: usize,
    /// The heading without marks.
    pub heading: String,
    /// The name that links give it.
    pub anchor: String,
    /// Markdown without images and comments, tables as lists.
    pub text: String,
}

/// What a link leads to.
type Resolve<'a> = &'a dyn Fn(&str) -> String;

/// The heading's anchor as GitHub and mdBook make it.
pub fn anchor(heading: &str) -> String {
    let kept = heading.to_lowercase().replace(' ', "-");
    let is_kept = |c: &char| c.is_alphanumeric() || matches!(c, '-' | '_');
    kept.chars().filter(is_kept).collect()
}

/// Page and anchor of an address; the anchor is empty without one.
pub fn parts(address: &str) -> (&str, &str) {
    address.split_once('#').unwrap_or((address, ""))
}

/// The sections of a page; none if the book has no such page.
pub fn sections(pages: Pages, path: &str) -> Vec<Section> {
    let Some((_, page)) = pages.iter().find(|(name, _)| *name == path) else {
        return Vec::new();
    };
    let folder = path.rsplit_once('/').map_or("", |(folder, _)| folder);
    let resolve: Resolve<'_> = &|target| resolved(target, folder, pages);
    let mut sections: Vec<Section> = Vec::new();
    let mut is_code = false;
    let mut head = None;
    for line in page.lines() {
        is_code ^= line.starts_with("```");
        let marks = line.len() - line.trim_start_matches('#').len();
        if marks > 0 && !is_code {
            let heading = line[marks..].trim().replace('`', "");
            let anchor = anchor(&heading);
            sections.push(Section {
                level: marks,
                heading,
                anchor,
                text: String::new(),
            });
            continue;
        }
        let Some(section) = sections.last_mut() else { continue };
        if is_code {
            section.text += line;
        } else if line.starts_with('|') {
            section.text += &row(&cells(line), &mut head, resolve);
        } else {
            head = None;
            if !line.starts_with("<!--") {
                section.text += &linked(line, resolve);
            }
        }
        section.text.push('\n');
    }
    sections
}

/// The cells of a line of a table.
fn cells(line: &str) -> Vec<String> {
    let inner = line.trim().trim_matches('|').replace("\\|", "\u{1}");
    inner.split('|').map(|cell| cell.trim().replace('\u{1}', "|")).collect()
}

/// A line of a table as an item of a list: it wraps in a narrow window. The first line of a table becomes its head.
fn row(cells: &[String], head: &mut Option<Vec<String>>, resolve: Resolve<'_>) -> String {
    let Some(head) = head else {
        *head = Some(cells.to_vec());
        return String::new();
    };
    let mut texts = cells.iter().map(|cell| linked(cell, resolve));
    let first = texts.next().unwrap_or_default();
    if first.trim_start_matches([':', '-']).is_empty() {
        return String::new();
    }
    // Bold does not go over code and links, which are marked as they are.
    let mut text = match first.contains(['`', '[', '*']) {
        true => format!("- {first}"),
        false => format!("- **{first}**"),
    };
    for (name, cell) in head.iter().skip(1).zip(texts).filter(|(_, cell)| !cell.is_empty()) {
        text += &match cells.len() {
            0..=2 => format!(": {cell}"),
            _ => format!("; {name}: {cell}"),
        };
    }
    text
}

/// The line with links that [`SCHEME`] marks where they lead to a page of the book; images by their descriptions.
fn linked(line: &str, resolve: Resolve<'_>) -> String {
    let mut text = String::new();
    let mut rest = line;
    while let Some((before, after)) = rest.split_once("](") {
        let Some((target, after)) = after.split_once(')') else {
            break;
        };
        rest = after;
        match before.rfind("![") {
            Some(image) if !before[image..].contains(']') => {
                text += &before[..image];
                text += &format!("(image: {})", &before[image + 2..]);
            }
            _ => text += &format!("{before}]({})", resolve(target)),
        }
    }
    text + rest
}

/// A link's target: with [`SCHEME`] and from `docs/` on where it is a page of the book.
fn resolved(target: &str, folder: &str, pages: Pages) -> String {
    let (file, anchor) = parts(target);
    let mut path: Vec<&str> = folder.split('/').filter(|part| !part.is_empty()).collect();
    for part in file.split('/') {
        match part {
            ".." => drop(path.pop()),
            part => path.push(part),
        }
    }
    let path = path.join("/");
    let is_page = pages.iter().any(|(name, _)| *name == path);
    match (is_page, anchor) {
        (true, "") => format!("{SCHEME}{path}"),
        (true, anchor) => format!("{SCHEME}{path}#{anchor}"),
        _ => target.to_owned(),
    }
}
