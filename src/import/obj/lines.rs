//! Lines of OBJ and MTL files, prepared for the tobj crate, which refuses a whole file for one bad line.

use std::borrow::Cow;

use crate::files::text_or_latin_1;
use crate::scene::report::{Fate, ImportReport};

/// Name of an unnamed material.
const UNNAMED: &str = "(unnamed)";

/// Lines of an OBJ file: continued lines are joined, numbers have no comment after them, `usemtl` gets a name, `vt` two
/// coordinates, and missing vertex colours are white. Polylines are left out: the crate fills them.
pub(super) fn of_model(bytes: &[u8]) -> Cow<'_, [u8]> {
    let text = text_of(bytes);
    let are_some_colored = has_some_colors(text.as_bytes());
    if let Cow::Borrowed(plain) = text
        && !are_some_colored
        && !plain.as_bytes().split(|byte| *byte == b'\n').any(is_odd)
    {
        return Cow::Borrowed(plain.as_bytes());
    }
    let lines = joined(&text).into_iter().map(|line| {
        let line = if is_of_numbers(line.trim().as_bytes()) {
            plain_numbers(&line)
        } else {
            line
        };
        let words = || line.split_whitespace();
        match (words().next(), words().count()) {
            (Some("usemtl"), 1) => format!("usemtl {UNNAMED}"),
            (Some("usemtl"), _) => line.replacen('\t', " ", 1),
            (Some("vt"), 2) => format!("{line} 0"),
            (Some("l"), _) => String::new(),
            (Some("v"), 4) if are_some_colored => format!("{line} 1 1 1"),
            _ => line,
        }
    });
    Cow::Owned(lines.collect::<Vec<_>>().join("\n").into_bytes())
}

/// Byte order mark of UTF-8.
const UTF_8: &[u8] = b"\xef\xbb\xbf";

/// The text of a file in UTF-8, UTF-16 or, if it is neither, Latin-1.
fn text_of(bytes: &[u8]) -> Cow<'_, str> {
    let of_units = |bytes: &[u8], unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes.as_chunks::<2>().0.iter().map(|pair| unit(*pair)).collect();
        Cow::Owned(String::from_utf16_lossy(&units))
    };
    match bytes {
        [0xfe, 0xff, rest @ ..] => of_units(rest, u16::from_be_bytes),
        [0xff, 0xfe, rest @ ..] => of_units(rest, u16::from_le_bytes),
        _ => text_or_latin_1(bytes.strip_prefix(UTF_8).unwrap_or(bytes)),
    }
}

/// Whether some vertices have a colour and others have none.
fn has_some_colors(bytes: &[u8]) -> bool {
    let vertices = bytes
        .split(|byte| *byte == b'\n')
        .filter(|line| line.starts_with(b"v "));
    let mut has_color = vertices.map(|line| words(line) > 6);
    let first = has_color.next();
    has_color.any(|has| Some(has) != first)
}

fn words(line: &[u8]) -> usize {
    let words = line.split(u8::is_ascii_whitespace);
    let words = words.filter(|word| !word.is_empty());
    words.take_while(|word| !word.starts_with(b"#")).count()
}

/// Whether a line is of a vertex, a face or a polyline.
fn is_of_numbers(line: &[u8]) -> bool {
    matches!(line.first(), Some(b'v' | b'f' | b'l'))
}

/// A line without the comment at its end, and with NaN for what C++ writes in its place on Windows: `-1.#IND`, `-nan(ind)`.
fn plain_numbers(line: &str) -> String {
    let words = line.split_whitespace().take_while(|word| !word.starts_with('#'));
    let plain = words.map(|word| if word.contains(['#', '(']) { "nan" } else { word });
    plain.collect::<Vec<_>>().join(" ")
}

fn is_odd(line: &[u8]) -> bool {
    let line = line.trim_ascii();
    line.ends_with(b"\\")
        || line.starts_with(b"usemtl") && !line.starts_with(b"usemtl ")
        || line.starts_with(b"vt") && words(line) == 2
        || is_of_numbers(line) && (line[0] == b'l' || line.iter().any(|byte| b"#(".contains(byte)))
}

/// Readable lines of a material library; the others are reported.
pub(super) fn of_library(bytes: &[u8], name: &str, report: &mut ImportReport) -> Vec<u8> {
    let mut lines = joined(&text_of(bytes));
    for line in &mut lines {
        match line.split_whitespace().collect::<Vec<_>>()[..] {
            ["newmtl"] => *line = format!("newmtl {UNNAMED}"),
            // Green and blue that are left out are as red; tobj panics without them.
            [key @ ("Ka" | "Kd" | "Ks" | "Ke"), ref numbers @ ..] if numbers.len() < 3 && are_numbers(numbers) => {
                let red = numbers.first().unwrap_or(&"-");
                *line = format!("{key} {red} {red} {red}");
            }
            _ => {}
        }
    }
    lines.retain(|line| {
        let alone = format!("newmtl alone\n{line}\n");
        let is_read = tobj::load_mtl_buf(&mut alone.as_bytes()).is_ok();
        if !is_read {
            let what = format!("a line of a library of materials (\"{}\")", line.trim());
            report.note(Fate::Ignored, what, name);
        }
        is_read
    });
    lines.join("\n").into_bytes()
}

fn are_numbers(words: &[&str]) -> bool {
    words.iter().all(|word| word.parse::<f32>().is_ok())
}

/// Lines, with those that end in `\` joined to the next, which become empty. A comment may end in a folder's name.
fn joined(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    // The line that goes on.
    let mut open = None;
    for line in text.lines() {
        let (line, continues) = match line.trim_end().strip_suffix('\\') {
            Some(start) if open.is_some() || !line.trim_start().starts_with('#') => (start, true),
            _ => (line, false),
        };
        let place = open.unwrap_or(lines.len());
        if let Some(first) = lines.get_mut(place) {
            *first = format!("{first} {line}");
            lines.push(String::new());
        } else {
            lines.push(line.to_owned());
        }
        open = continues.then_some(place);
    }
    lines
}
