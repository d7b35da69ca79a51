//! Tables of colours in `.cube` files (Adobe, "Cube LUT Specification" 1.0, and DaVinci Resolve's additions to it).
//!
//! The crate that exists (`lut_parser` 2.1) refuses tables without a title, and most tables have none.

use std::{path::Path, sync::Arc};

use super::{FileError, file};
use crate::{import::remembered::Remembered, optics::tone::Lut};

/// Most entries along a side, of curves and of a cube.
const SIZES: [usize; 2] = [65536, 129];
/// Tables that are remembered.
const REMEMBERED: usize = 4;

/// The table in a file.
pub fn load(path: &Path) -> Result<Lut, FileError> {
    let bytes = file::read(path)?;
    parse(&String::from_utf8_lossy(&bytes))
        .map_err(|reason| FileError::content(path, format!("not a table of colours: {reason}; choose a .cube file")))
}

fn parse(text: &str) -> Result<Lut, String> {
    // Of curves and of a cube: codes go through the curves first (DaVinci Resolve).
    let (mut sizes, mut domains) = ([None; 2], [[[0.0; 3], [1.0; 3]]; 2]);
    let mut entries: Vec<[f32; 3]> = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.trim().trim_start_matches('\u{feff}');
        let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let wrong = || format!("line {number} is \"{}\"", line.chars().take(40).collect::<String>());
        let kind = usize::from(word.starts_with("LUT_3D"));
        match word {
            "" | "TITLE" => {}
            comment if comment.starts_with('#') => {}
            "LUT_1D_SIZE" | "LUT_3D_SIZE" => {
                let count = rest.trim().parse().ok();
                let count = count.filter(|count| (2..=SIZES[kind]).contains(count));
                if sizes[kind].replace(count.ok_or_else(wrong)?).is_some() {
                    return Err("it holds two tables of one kind; save them apart".to_owned());
                }
            }
            "DOMAIN_MIN" | "DOMAIN_MAX" => {
                let end = numbers(rest).ok_or_else(wrong)?;
                domains
                    .iter_mut()
                    .for_each(|domain| domain[usize::from(word == "DOMAIN_MAX")] = end);
            }
            "LUT_1D_INPUT_RANGE" | "LUT_3D_INPUT_RANGE" => {
                let [low, high] = numbers(rest).ok_or_else(wrong)?;
                domains[kind] = [[low; 3], [high; 3]];
            }
            _ => entries.push(numbers(line).ok_or_else(wrong)?),
        }
    }
    let counts = [sizes[0].unwrap_or(0), sizes[1].map_or(0, |size| size.pow(3))];
    let wanted = counts[0] + counts[1];
    if wanted > 0 && entries.len() != wanted {
        return Err(format!("it has {} of {wanted} entries", entries.len()));
    }
    let of_cube = entries.split_off(counts[0].min(entries.len()));
    let mut lut = None;
    for (kind, entries) in [entries, of_cube].into_iter().enumerate() {
        let (Some(size), domain) = (sizes[kind], domains[kind]) else {
            continue;
        };
        if (0..3).any(|i| domain[0][i] >= domain[1][i]) {
            return Err("its domain is empty".to_owned());
        }
        lut = Some(Lut {
            before: lut.map(Box::new),
            size,
            is_one_dimensional: kind == 0,
            domain,
            entries,
        });
    }
    lut.ok_or_else(|| "it does not say its size (LUT_3D_SIZE)".to_owned())
}

/// Finite numbers with blanks between them.
fn numbers<const N: usize>(text: &str) -> Option<[f32; N]> {
    let number = |word: &str| word.parse().ok().filter(|x: &f32| x.is_finite());
    let all: Option<Vec<f32>> = text.split_whitespace().map(number).collect();
    all?.try_into().ok()
}

/// The table in a file, read again if the file was saved since. `None`, logged once, if it can't be read.
pub fn remembered(path: &Path) -> Option<Arc<Lut>> {
    static TABLES: Remembered<Lut> = Remembered::new(REMEMBERED);
    TABLES.get(path, load, "the image is shown without it")
}
