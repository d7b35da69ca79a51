//! Mending of text PLY files that the ply-rs crate refuses: an unreadable number costs itself alone.

use ply_rs_bw::ply::{ElementDef, Header, PropertyType, ScalarType};

use crate::scene::report::{Fate, ImportReport};

/// The last line of a header.
const HEADER_END: &str = "end_header";

/// The file with a readable row for every element. Unreadable coordinates become infinite, and their triangles are dropped; of an
/// unreadable list nothing is left. Elements after the file's end are reported as missing.
pub(super) fn mended(bytes: &[u8], header: &Header, report: &mut ImportReport) -> Vec<u8> {
    let text = String::from_utf8_lossy(bytes);
    let mut lines = text.lines().enumerate();
    let mut rows: Vec<String> = Vec::new();
    for (_, line) in lines.by_ref() {
        rows.push(line.to_owned());
        if line.trim() == HEADER_END {
            break;
        }
    }
    for element in header.elements.values() {
        for place in 0..element.count {
            let Some((number, line)) = lines.next() else {
                // As many as could have been there: the count may be wrong as well.
                let missing = (element.count - place).min(bytes.len() / 16);
                let what = format!("elements called {} after the end of the file", element.name);
                report.count(Fate::Missing, what, "", missing);
                rows.extend(std::iter::repeat_n(row(element, "").0, missing));
                break;
            };
            let (row, is_whole) = row(element, line);
            if !is_whole {
                let what = format!(
                    "a number of a PLY file that cannot be read, in elements called {}; export the model again",
                    element.name
                );
                report.note(Fate::Ignored, what, &format!("line {}", number + 1));
            }
            rows.push(row);
        }
    }
    rows.push(String::new());
    rows.join("\n").into_bytes()
}

/// An element's row of a line, and whether all of the line could be read.
fn row(element: &ElementDef, line: &str) -> (String, bool) {
    let mut words = line.split_whitespace();
    let mut is_whole = true;
    let mut row: Vec<String> = Vec::new();
    for property in element.properties.values() {
        match &property.data_type {
            PropertyType::Scalar(kind) => {
                let number = words.next().and_then(|word| number(kind, word));
                is_whole &= number.is_some();
                row.push(number.unwrap_or_else(|| substitute(kind).to_owned()));
            }
            PropertyType::List(_, kind) => {
                let length = words.next().and_then(|count| count.parse::<usize>().ok());
                let items: Vec<&str> = words.by_ref().take(length.unwrap_or(0)).collect();
                let numbers: Option<Vec<String>> = items.iter().map(|item| number(kind, item)).collect();
                match numbers {
                    Some(numbers) if length == Some(numbers.len()) => {
                        row.push(numbers.len().to_string());
                        row.extend(numbers);
                    }
                    _ => {
                        is_whole = false;
                        row.push("0".to_owned());
                    }
                }
            }
        }
    }
    (row.join(" "), is_whole && words.next().is_none())
}

/// A word as the crate reads it, which knows neither `.5` nor `nan`; `None` if it is no number of its kind.
fn number(kind: &ScalarType, word: &str) -> Option<String> {
    let of_integer = |range: std::ops::RangeInclusive<i64>| {
        let value = word.parse::<i64>().ok().filter(|value| range.contains(value));
        value.map(|value| value.to_string())
    };
    match kind {
        ScalarType::Float | ScalarType::Double => {
            let value = word.parse::<f64>().ok().filter(|value| value.is_finite());
            value.map(|value| format!("{value:e}"))
        }
        ScalarType::Char => of_integer(-128..=127),
        ScalarType::UChar => of_integer(0..=255),
        ScalarType::Short => of_integer(-32_768..=32_767),
        ScalarType::UShort => of_integer(0..=65_535),
        ScalarType::Int => of_integer(i64::from(i32::MIN)..=i64::from(i32::MAX)),
        ScalarType::UInt => of_integer(0..=i64::from(u32::MAX)),
    }
}

/// What stands in place of an unreadable number.
fn substitute(kind: &ScalarType) -> &'static str {
    match kind {
        ScalarType::Float | ScalarType::Double => "1e999",
        _ => "0",
    }
}
