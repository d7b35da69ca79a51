//! Light profiles in `.ies` files (ANSI/IES LM-63 of 1986 to 2019, type C photometry).
//!
//! Of the crates that read them, `eulumdat` has a licence that this program can't take, and `lidrs` brings five crates, for
//! a list of numbers behind a line.

use std::{path::Path, path::PathBuf, sync::Arc};

use super::{limits, remembered::Remembered};
use crate::scene::light_profile::{ANGLES_MAX, LightProfile};

/// Profiles that are remembered.
const REMEMBERED: usize = 64;

/// The most bytes of a file.
const BYTES_MAX: u64 = 16 << 20;

/// Why a light profile can't be read.
#[derive(Debug, thiserror::Error)]
#[error("{path}: {reason}")]
pub struct LightProfileError {
    path: PathBuf,
    reason: String,
}

/// The profile in a file.
pub fn load(path: &Path) -> Result<LightProfile, LightProfileError> {
    let read = || {
        let bytes = limits::read(path, BYTES_MAX)
            .map_err(|error| format!("cannot be read: {error}; check the path and its permissions"))?;
        parse(&String::from_utf8_lossy(&bytes))
            .map_err(|reason| format!("not a light profile: {reason}; choose an .ies file of type C photometry"))
    };
    read().map_err(|reason| LightProfileError {
        path: path.to_owned(),
        reason,
    })
}

/// The profile in a file, read again if the file was saved since. `None`, logged once, if it can't be read.
pub fn remembered(path: &Path) -> Option<Arc<LightProfile>> {
    static PROFILES: Remembered<LightProfile> = Remembered::new(REMEMBERED);
    PROFILES.get(path, load, "the light shines evenly")
}

fn parse(text: &str) -> Result<LightProfile, String> {
    let mut lines = text.lines();
    let tilt = lines.find_map(|line| line.trim().strip_prefix("TILT="));
    let tilt = tilt.ok_or("it has no line TILT=")?.trim();
    let words = lines.flat_map(|line| line.split([' ', '\t', ',']));
    let mut numbers = words.filter(|word| !word.is_empty()).map(|word| {
        let number = word.parse().ok().filter(|x: &f32| x.is_finite());
        number.ok_or_else(|| format!("\"{}\" is no number", word.chars().take(40).collect::<String>()))
    });
    let mut number = || numbers.next().ok_or_else(|| "it ends too early".to_owned())?;
    match tilt {
        "NONE" => {}
        "INCLUDE" => {
            // How the lamp dims where it is tilted: this one hangs as it was measured.
            number()?;
            let pairs = count("tilt", number()?)?;
            (0..2 * pairs).try_for_each(|_| number().map(drop))?;
        }
        other => return Err(format!("its tilt is in {}", other.chars().take(40).collect::<String>())),
    }
    let [_lamps, _lumens, multiplier] = [number()?, number()?, number()?];
    let verticals = count("vertical", number()?)?;
    let horizontals = count("horizontal", number()?)?;
    let photometry = number()?;
    if photometry != 1.0 {
        return Err(format!(
            "its photometry is of type {}",
            if photometry == 2.0 { "B" } else { "A" }
        ));
    }
    // Units and dimensions of the opening.
    (0..4).try_for_each(|_| number().map(drop))?;
    let [ballast, of_future_use, _watts] = [number()?, number()?, number()?];
    let of_future_use = if of_future_use > 0.0 { of_future_use } else { 1.0 };
    let factor = multiplier * ballast * of_future_use;
    let mut list = |count: usize| (0..count).map(|_| number()).collect::<Result<Vec<f32>, String>>();
    let (vertical_deg, horizontal_deg) = (list(verticals)?, list(horizontals)?);
    let mut candela = list(verticals * horizontals)?;
    candela.iter_mut().for_each(|candela| *candela *= factor);
    LightProfile::new(vertical_deg, &horizontal_deg, &candela)
}

fn count(kind: &str, number: f32) -> Result<usize, String> {
    let is_count = number.fract() == 0.0 && (1.0..=ANGLES_MAX as f32).contains(&number);
    match is_count {
        true => Ok(number as usize),
        false => Err(format!("it has {number} {kind} angles")),
    }
}
