//! Tables of colours in `.cube` files (Adobe, "Cube LUT Specification" 1.0, and DaVinci Resolve's additions to it).
//!
//! The crate that exists (`lut_parser` 2.1) refuses tables without a title, and most tables have none.

use std::path::Path;
use std::sync::Arc;

use super::{FileError, file};
use crate::import::remembered::Remembered;
use crate::optics::tone::Lut;

/// Most entries along a side, of a cube and of curves.
const SIZES: [usize; 2] = [129, 65536];
/// Tables that are remembered.
const REMEMBERED: usize = 4;

/// The table in a file.
pub fn load(path: &Path) -> Result<Lut, FileError> {
    let bytes = file::read(path)?;
    parse(&String::from_utf8_lossy(&bytes))
        .map_err(|reason| FileError::content(path, format!("not a table of colours: {reason}; choose a .cube file")))
}

fn parse(text: &str) -> Result<Lut, String> {
    let mut size = None;
    let mut domain = [[0.0; 3], [1.0; 3]];
    let mut entries: Vec<[f32; 3]> = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.trim().trim_start_matches('\u{feff}');
        let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let wrong = || format!("line {number} is \"{}\"", line.chars().take(40).collect::<String>());
        match word {
            "" | "TITLE" => {}
            comment if comment.starts_with('#') => {}
            "LUT_1D_SIZE" | "LUT_3D_SIZE" if size.is_some() => {
                return Err("it holds two tables; save curves and cube apart".to_owned());
            }
            "LUT_1D_SIZE" | "LUT_3D_SIZE" => {
                let is_one_dimensional = word == "LUT_1D_SIZE";
                let most = SIZES[usize::from(is_one_dimensional)];
                let count = rest.trim().parse().ok().filter(|count| (2..=most).contains(count));
                size = Some((count.ok_or_else(wrong)?, is_one_dimensional));
            }
            "DOMAIN_MIN" => domain[0] = numbers(rest).ok_or_else(wrong)?,
            "DOMAIN_MAX" => domain[1] = numbers(rest).ok_or_else(wrong)?,
            "LUT_1D_INPUT_RANGE" | "LUT_3D_INPUT_RANGE" => {
                let [low, high] = numbers(rest).ok_or_else(wrong)?;
                domain = [[low; 3], [high; 3]];
            }
            _ => entries.push(numbers(line).ok_or_else(wrong)?),
        }
    }
    let (size, is_one_dimensional) = size.ok_or("it does not say its size (LUT_3D_SIZE)")?;
    let wanted = if is_one_dimensional { size } else { size.pow(3) };
    if entries.len() != wanted {
        return Err(format!("it has {} of {wanted} entries", entries.len()));
    }
    if (0..3).any(|i| domain[0][i] >= domain[1][i]) {
        return Err("its domain is empty".to_owned());
    }
    Ok(Lut {
        size,
        is_one_dimensional,
        domain,
        entries,
    })
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
