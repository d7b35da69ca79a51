//! Mending of OBJ lines that the tobj crate refuses: an unreadable line costs itself alone.

use crate::scene::report::{Fate, ImportReport};

/// Numbers of coordinates that a line declares.
#[derive(Clone, Copy, Default)]
struct Declared {
    positions: usize,
    uvs: usize,
    normals: usize,
}

/// The lines of a prepared file that can be read. Others keep their place, so that the numbers of faces still count:
/// positions become NaN, whose triangles are dropped, texture coordinates and normals zero. Faces are left out.
pub(super) fn mended(bytes: &[u8], report: &mut ImportReport) -> Vec<u8> {
    let text = String::from_utf8_lossy(bytes);
    let color = if text
        .lines()
        .any(|line| line.starts_with("v ") && line.split_whitespace().count() > 6)
    {
        " 1 1 1"
    } else {
        ""
    };
    let mut declared = Declared::default();
    let mut lines = Vec::new();
    for (place, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        let key = words.next();
        let words: Vec<&str> = words.collect();
        let mut replaced = |what: &str, substitute: String| {
            let what = format!("{what} of an OBJ file that cannot be read; export the model again");
            report.note(Fate::Ignored, what, &format!("line {}", place + 1));
            substitute
        };
        let line = match key {
            Some("v") => {
                declared.positions += 1;
                match finite(&words, 3) {
                    _ if is_position(&words) && (color.is_empty() || words.len() == 6) => line.to_owned(),
                    true => replaced(
                        "the colour or weight of a vertex",
                        format!("v {}{color}", words[..3].join(" ")),
                    ),
                    false => replaced("a vertex", format!("v nan nan nan{color}")),
                }
            }
            Some("vt") => {
                declared.uvs += 1;
                match finite(&words, 2) {
                    true => line.to_owned(),
                    false => replaced("a texture coordinate", "vt 0 0".to_owned()),
                }
            }
            Some("vn") => {
                declared.normals += 1;
                match finite(&words, 3) {
                    true => line.to_owned(),
                    false => replaced("a normal", "vn 0 0 0".to_owned()),
                }
            }
            Some("f") if words.len() < 3 || !words.iter().all(|corner| is_corner(corner, declared)) => {
                replaced("a face", String::new())
            }
            Some("l") => String::new(),
            _ => line.to_owned(),
        };
        lines.push(line);
    }
    lines.join("\n").into_bytes()
}

/// Whether the first words are numbers.
fn finite(words: &[&str], count: usize) -> bool {
    let numbers = words.iter().take(count).filter(|word| word.parse::<f32>().is_ok());
    numbers.count() == count
}

/// Whether a vertex has three coordinates and nothing else, a divisor, or a colour.
fn is_position(words: &[&str]) -> bool {
    let divides = |word: &str| word.parse().is_ok_and(|w: f32| w != 0.0);
    match words.len() {
        4 => finite(words, 3) && divides(words[3]),
        count => matches!(count, 3 | 6) && finite(words, count),
    }
}

/// Whether a corner of a face is one of the coordinates so far, each counted from the first or back from the last.
fn is_corner(word: &str, declared: Declared) -> bool {
    let known = [declared.positions, declared.uvs, declared.normals];
    let numbers: Vec<&str> = word.split('/').collect();
    let is_known = |(place, number): (usize, &&str)| match number.parse::<isize>() {
        Ok(number) => number != 0 && known.get(place).is_some_and(|&most| number.unsigned_abs() <= most),
        Err(_) => number.is_empty() && place > 0,
    };
    numbers.iter().enumerate().all(is_known)
}
