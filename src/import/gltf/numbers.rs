//! Numbers that JSON or single precision cannot hold: each costs its own value.

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

/// Removes the values whose numbers single precision cannot hold, and reports the way to each. Returns whether that is so of
/// the value itself.
pub(super) fn drop_unreadable(value: &mut Json, pointer: &mut String, report: &mut ImportReport) -> bool {
    let is_beyond = |value: &Json| value.as_f64().is_some_and(|number| (number as f32).is_infinite());
    let mut within = |key: &dyn std::fmt::Display, value: &mut Json, pointer: &mut String| {
        if !value.is_array() && !value.is_object() {
            return is_beyond(value);
        }
        let length = pointer.len();
        pointer.push_str(&format!("/{key}"));
        let is_unreadable = drop_unreadable(value, pointer, report);
        pointer.truncate(length);
        is_unreadable
    };
    match value {
        Json::Array(values) => {
            let unreadable = values.iter_mut().enumerate();
            let unreadable = unreadable.filter_map(|(place, value)| within(&place, value, pointer).then_some(()));
            unreadable.count() > 0
        }
        Json::Object(values) => {
            let mut names = Vec::new();
            values.retain(|key, value| {
                let is_unreadable = within(key, value, pointer);
                if is_unreadable {
                    names.push(format!("{pointer}/{key}"));
                }
                !is_unreadable
            });
            for name in names {
                let what = "a number that cannot be read, its default instead; export the model again";
                report.note(Fate::Ignored, what, &name);
            }
            false
        }
        other => is_beyond(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bare_word_becomes_json() {
        let text = br#"{"a\"NaN": [NaN, -Infinity, 1e999, .5, +2, 0.25, 01, true, null, "1e999\\"], "b": 1,5x}"#;
        let expected = r#"{"a\"NaN": [1e300, 1e300, 1e300, 0.5, 2.0, 0.25, 1.0, true, null, "1e999\\"], "b": 1,1e300}"#;
        assert_eq!(String::from_utf8_lossy(&readable(text)), expected);
        for cut in 0..text.len() {
            readable(&text[..cut]);
        }
    }

    #[test]
    fn the_way_to_each_value_is_told() {
        let mut value = serde_json::json!({"a": [{"b": [1, 1e300, 2], "c": 1e39, "d": 3.4028235e38}], "e": [1e40]});
        let mut report = ImportReport::default();
        assert!(!drop_unreadable(&mut value, &mut String::new(), &mut report));
        assert_eq!(value, serde_json::json!({"a": [{"d": 3.4028235e38}]}));
        assert_eq!(report.entries[0].names, ["/a/0/b", "/a/0/c", "/e"]);
    }
}
