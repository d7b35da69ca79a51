//! Lines of OBJ and MTL files as the tobj crate takes them: it refuses a whole file for one that it cannot read.

use std::borrow::Cow;

use crate::scene::report::{Fate, ImportReport};

/// What a material is called whose name is left out.
const UNNAMED: &str = "(unnamed)";

/// The lines of an OBJ file: those that go on after a `\` are joined, `usemtl` has a name, `vt` two coordinates.
pub(super) fn of_model(bytes: &[u8]) -> Cow<'_, [u8]> {
    let is_text = std::str::from_utf8(bytes).is_ok();
    if is_text && !bytes.split(|byte| *byte == b'\n').any(is_odd) {
        return Cow::Borrowed(bytes);
    }
    let text = String::from_utf8_lossy(bytes);
    let lines = joined(&text).into_iter().map(|line| {
        let words = || line.split_whitespace();
        match (words().next(), words().count()) {
            (Some("usemtl"), 1) => format!("usemtl {UNNAMED}"),
            (Some("usemtl"), _) => line.replacen('\t', " ", 1),
            (Some("vt"), 2) => format!("{line} 0"),
            _ => line,
        }
    });
    Cow::Owned(lines.collect::<Vec<_>>().join("\n").into_bytes())
}

fn is_odd(line: &[u8]) -> bool {
    let line = line.trim_ascii();
    line.ends_with(b"\\")
        || line.starts_with(b"usemtl") && !line.starts_with(b"usemtl ")
        || line.starts_with(b"vt")
            && line
                .split(u8::is_ascii_whitespace)
                .filter(|word| !word.is_empty())
                .count()
                == 2
}

/// The lines of a library of materials that can be read; the others are told.
pub(super) fn of_library(bytes: &[u8], name: &str, report: &mut ImportReport) -> Vec<u8> {
    let mut lines = joined(&String::from_utf8_lossy(bytes));
    for line in lines.iter_mut().filter(|line| line.trim() == "newmtl") {
        *line = format!("newmtl {UNNAMED}");
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

/// Lines, those that end in `\` with the next one. A comment may end in a folder's name.
fn joined(text: &str) -> Vec<String> {
    let mut lines = Vec::new();
    let mut goes_on = false;
    for line in text.lines() {
        let (line, next_goes_on) = match line.trim_end().strip_suffix('\\') {
            Some(start) if goes_on || !line.trim_start().starts_with('#') => (start, true),
            _ => (line, false),
        };
        match lines.last_mut() {
            Some(last) if goes_on => {
                String::push(last, ' ');
                last.push_str(line);
            }
            _ => lines.push(line.to_owned()),
        }
        goes_on = next_goes_on;
    }
    lines
}
