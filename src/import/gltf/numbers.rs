//! Numbers that JSON or single precision cannot hold: each costs its own value.

use std::fmt::Display;

use serde_json::Value as Json;

use crate::scene::report::{Fate, ImportReport};

/// A legal number that single precision cannot hold, in place of an unreadable one.
const BEYOND: &str = "1e300";

/// JSON whose bare words can be read: `NaN`, `1e999` and what is no number become [`BEYOND`], `.5` becomes `0.5`.
pub(super) fn readable(text: &[u8]) -> Vec<u8> {
    let mut out = Vec::with_capacity(text.len());
    let mut rest = text;
    while let Some((&first, after)) = rest.split_first() {
        let length = match first {
            b'"' => string_length(rest),
            byte if is_between(byte) => 1,
            _ => rest
                .iter()
                .take_while(|&&byte| byte != b'"' && !is_between(byte))
                .count(),
        };
        let (piece, others) = rest.split_at(length.clamp(1, after.len() + 1));
        match is_between(first) || first == b'"' {
            true => out.extend(piece),
            false => out.extend(word(piece).as_bytes()),
        }
        rest = others;
    }
    out
}

/// Whether a byte stands between words.
fn is_between(byte: u8) -> bool {
    byte.is_ascii_whitespace() || b"{}[]:,".contains(&byte)
}

/// The length of the string that bytes begin with, quotes included.
fn string_length(bytes: &[u8]) -> usize {
    let mut is_escaped = true;
    let end = bytes.iter().position(|&byte| {
        let ends = byte == b'"' && !is_escaped;
        // The first quote opens the string.
        is_escaped = byte == b'\\' && !is_escaped;
        ends
    });
    end.map_or(bytes.len(), |end| end + 1)
}

/// A bare word as JSON.
fn word(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    if serde_json::from_str::<Json>(&text).is_ok() {
        return text.into_owned();
    }
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => format!("{number:?}"),
        _ => BEYOND.to_owned(),
    }
}

/// Lists of nodes, which can do without one of them.
const LISTS: [&str; 2] = ["/nodes", "/children"];

/// Removes the values whose numbers single precision cannot hold, and reports the way to each. Returns whether that is so of
/// the value itself.
pub(super) fn drop_unreadable(value: &mut Json, pointer: &mut String, report: &mut ImportReport) -> bool {
    match value {
        Json::Array(values) if LISTS.iter().any(|list| pointer.ends_with(list)) => {
            let mut place = 0;
            values.retain_mut(|value| {
                let is_unreadable = is_unreadable(&place, value, pointer, report);
                if is_unreadable {
                    note(report, &place, pointer);
                }
                place += 1;
                !is_unreadable
            });
            false
        }
        Json::Array(values) => {
            let mut is_any = false;
            for (place, value) in values.iter_mut().enumerate() {
                is_any |= is_unreadable(&place, value, pointer, report);
            }
            is_any
        }
        Json::Object(values) => {
            values.retain(|key, value| {
                let is_unreadable = is_unreadable(key, value, pointer, report);
                if is_unreadable {
                    note(report, key, pointer);
                }
                !is_unreadable
            });
            false
        }
        other => is_beyond(other),
    }
}

/// Whether the value at a key of an array or object is unreadable.
fn is_unreadable(key: &dyn Display, value: &mut Json, pointer: &mut String, report: &mut ImportReport) -> bool {
    if !value.is_array() && !value.is_object() {
        return is_beyond(value);
    }
    let length = pointer.len();
    pointer.push_str(&format!("/{key}"));
    let is_unreadable = drop_unreadable(value, pointer, report);
    pointer.truncate(length);
    is_unreadable
}

fn note(report: &mut ImportReport, key: &dyn Display, pointer: &str) {
    let what = "a number that cannot be read, its default instead; export the model again";
    report.note(Fate::Ignored, what, &format!("{pointer}/{key}"));
}

fn is_beyond(value: &Json) -> bool {
    value.as_f64().is_some_and(|number| (number as f32).is_infinite())
}
