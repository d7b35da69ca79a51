//! Mending of text PLY files that the ply-rs crate refuses: an unreadable number costs itself alone.

use ply_rs_bw::ply::{ElementDef, Header, PropertyType, ScalarType};

use crate::scene::report::{Fate, ImportReport};

/// The last line of a header.
const HEADER_END: &str = "end_header";

/// The file with a readable row for every element. Unreadable coordinates become NaN, whose triangles are dropped; of an
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
    let mut row: Vec<&str> = Vec::new();
    for property in element.properties.values() {
        match &property.data_type {
            PropertyType::Scalar(kind) => {
                let word = words.next().filter(|word| is_number(kind, word));
                is_whole &= word.is_some();
                row.push(word.unwrap_or(substitute(kind)));
            }
            PropertyType::List(_, kind) => {
                let count = words.next();
                let length = count.and_then(|count| count.parse::<usize>().ok());
                let items: Vec<&str> = words.by_ref().take(length.unwrap_or(0)).collect();
                match count {
                    Some(count) if length == Some(items.len()) && items.iter().all(|item| is_number(kind, item)) => {
                        row.push(count);
                        row.extend(items);
                    }
                    _ => {
                        is_whole = false;
                        row.push("0");
                    }
                }
            }
        }
    }
    (row.join(" "), is_whole && words.next().is_none())
}

fn is_number(kind: &ScalarType, word: &str) -> bool {
    match kind {
        ScalarType::Float | ScalarType::Double => word.parse::<f64>().is_ok(),
        ScalarType::Char => word.parse::<i8>().is_ok(),
        ScalarType::UChar => word.parse::<u8>().is_ok(),
        ScalarType::Short => word.parse::<i16>().is_ok(),
        ScalarType::UShort => word.parse::<u16>().is_ok(),
        ScalarType::Int => word.parse::<i32>().is_ok(),
        ScalarType::UInt => word.parse::<u32>().is_ok(),
    }
}

/// What stands in place of an unreadable number.
fn substitute(kind: &ScalarType) -> &'static str {
    match kind {
        ScalarType::Float | ScalarType::Double => "nan",
        _ => "0",
    }
}
