//! Lines of OBJ and MTL files: what the ufbx crate doesn't read of them, or refuses a whole file for.

use std::borrow::Cow;

use super::table::MTL_PARAMETERS;
use crate::files::text_or_latin_1;

/// Name of an unnamed material.
const UNNAMED: &str = "(unnamed)";

/// A model file.
#[derive(Default)]
pub struct Source<'a> {
    pub text: Cow<'a, str>,
    /// What follows each `mtllib`.
    pub libraries: Vec<String>,
    /// Smoothing group of each face, polyline and point; 0 is flat.
    pub groups: Vec<u32>,
    /// Objects, or groups where there are none: the first face, and the name.
    pub objects: Vec<(usize, String)>,
}

/// Reads a model file's lines. `usemtl` gets a name, `vt` two coordinates; comments go on in no next line.
pub fn of_model(bytes: &[u8]) -> Source<'_> {
    let text = text_of(bytes);
    let (mut source, mut is_odd) = (Source::default(), false);
    let (mut object, mut group, mut smoothing) = (String::new(), String::new(), 0);
    for line in text.lines() {
        is_odd |= repaired(line).is_some();
        let (key, rest) = keyword(line);
        let words = rest.split_whitespace().count();
        let faces = match key {
            "f" => words.min(1),
            "l" => words.saturating_sub(1),
            "p" => words,
            _ => 0,
        };
        match key {
            "mtllib" => source.libraries.push(rest.to_owned()),
            "o" => rest.clone_into(&mut object),
            "g" => rest.clone_into(&mut group),
            "s" => smoothing = if rest == "off" { 0 } else { rest.parse().unwrap_or(1) },
            _ => {}
        }
        if faces > 0 {
            let name = if object.is_empty() { &group } else { &object };
            if source.objects.last().is_none_or(|(_, last)| last != name) {
                source.objects.push((source.groups.len(), name.clone()));
            }
            source.groups.resize(source.groups.len() + faces, smoothing);
        }
    }
    source.text = text;
    if is_odd {
        let lines = source.text.lines();
        let lines: Vec<_> = lines
            .map(|line| repaired(line).map_or(line.into(), Cow::Owned))
            .collect();
        source.text = lines.join("\n").into();
    }
    source
}

/// A line as the crate reads it, where it would not.
fn repaired(line: &str) -> Option<String> {
    match keyword(line) {
        // A comment may end in a folder's name.
        (key, _) if key.starts_with('#') && line.trim_end().ends_with('\\') => Some(String::new()),
        ("usemtl", "") => Some(format!("usemtl {UNNAMED}")),
        ("vt", rest) => {
            let mut numbers = rest.split_whitespace().take_while(|word| !word.starts_with('#'));
            let (first, second) = (numbers.next()?, numbers.next());
            second.is_none().then(|| format!("vt {first} 0"))
        }
        _ => None,
    }
}

/// The first line that lacks numbers, or has words in their places.
pub fn broken(text: &str) -> Option<String> {
    // Windows writes -1.#IND and -nan(ind) for what is no number.
    let is_number = |word: &str| word.parse::<f32>().is_ok() || word.contains(['#', '(']);
    let is_broken = |line: &&str| {
        let (key, rest) = keyword(line);
        let least = match key {
            "v" | "vn" => 3,
            "vt" => 2,
            _ => 0,
        };
        let numbers = rest.split_whitespace().take(least).filter(|word| is_number(word));
        numbers.count() < least && !line.trim_end().ends_with('\\')
    };
    let mut lines = text.lines().enumerate();
    let (place, line) = lines.find(|(_, line)| is_broken(line))?;
    Some(format!("line {} (\"{}\") lacks a number", place + 1, line.trim()))
}

/// A line's first word, and the rest.
fn keyword(line: &str) -> (&str, &str) {
    let line = line.trim();
    let (key, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    (key, rest.trim_start())
}

/// The text of a file in UTF-8, UTF-16 or, if it is neither, Latin-1; lines that end in CR alone end in LF.
fn text_of(bytes: &[u8]) -> Cow<'_, str> {
    let of_units = |bytes: &[u8], unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes.as_chunks::<2>().0.iter().map(|pair| unit(*pair)).collect();
        Cow::Owned(String::from_utf16_lossy(&units))
    };
    let text = match bytes {
        [0xfe, 0xff, rest @ ..] => of_units(rest, u16::from_be_bytes),
        [0xff, 0xfe, rest @ ..] => of_units(rest, u16::from_le_bytes),
        _ => text_or_latin_1(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)),
    };
    let mut pairs = text.as_bytes().windows(2);
    match pairs.any(|pair| pair[0] == b'\r' && pair[1] != b'\n') {
        true => text.replace('\r', "\n").into(),
        false => text,
    }
}

/// A material of a library.
#[derive(Debug, Default)]
pub struct Material {
    pub name: String,
    /// Keywords as the table spells them, with what follows each; the last of a keyword counts.
    pub lines: Vec<(String, String)>,
}

impl Material {
    pub fn text(&self, keyword: &str) -> Option<&str> {
        let line = self.lines.iter().rfind(|(key, _)| key == keyword)?;
        Some(&line.1)
    }

    /// A number, if it is finite.
    pub fn number(&self, keyword: &str) -> Option<f32> {
        let number = numbers(self.text(keyword)?).first().copied();
        number.filter(|x| x.is_finite())
    }

    /// A colour: green and blue that are left out are as red, and what comes behind `xyz` is of CIE.
    pub fn color(&self, keyword: &str) -> Option<[f32; 3]> {
        let text = self.text(keyword)?;
        let numbers = numbers(text);
        let [a, b, c] = numbers.first_chunk().copied().or(Some([*numbers.first()?; 3]))?;
        if !text.starts_with("xyz") {
            return Some([a, b, c]);
        }
        // Columns: linear Rec. 709 red, green and blue of X, Y and Z.
        let rgb_from_xyz = glam::mat3(
            glam::vec3(3.240_97, -0.969_244, 0.055_630),
            glam::vec3(-1.537_383, 1.875_968, -0.203_977),
            glam::vec3(-0.498_611, 0.041_555, 1.056_972),
        );
        Some((rgb_from_xyz * glam::vec3(a, b, c)).to_array())
    }
}

/// The numbers at the beginning of a text.
pub fn numbers(text: &str) -> Vec<f32> {
    let text = text.strip_prefix("xyz").unwrap_or(text);
    text.split_whitespace().map_while(|word| word.parse().ok()).collect()
}

/// Materials of a library.
pub fn of_library(bytes: &[u8]) -> Vec<Material> {
    let mut materials: Vec<Material> = Vec::new();
    for line in joined(&text_of(bytes)) {
        let (key, rest) = keyword(&line);
        if key.eq_ignore_ascii_case("newmtl") {
            let name = if rest.is_empty() { UNNAMED } else { rest }.to_owned();
            let lines = Vec::new();
            materials.push(Material { name, lines });
        } else if let Some(material) = materials.last_mut()
            && !key.is_empty()
            && !key.starts_with('#')
        {
            let key = if key.eq_ignore_ascii_case("map_bump") {
                "bump"
            } else {
                key
            };
            let known = MTL_PARAMETERS.iter().find(|row| row.place.eq_ignore_ascii_case(key));
            let key = known.map_or(key, |row| row.place);
            material.lines.push((key.to_owned(), rest.to_owned()));
        }
    }
    materials
}

/// Lines, with those that end in `\` joined to the next. A comment may end in a folder's name.
fn joined(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut goes_on = false;
    for line in text.lines() {
        let (start, continues) = match line.trim_end().strip_suffix('\\') {
            Some(start) if goes_on || !line.trim_start().starts_with('#') => (start, true),
            _ => (line, false),
        };
        match lines.last_mut().filter(|_| goes_on) {
            Some(last) => *last = format!("{last} {start}"),
            None => lines.push(start.to_owned()),
        }
        goes_on = continues;
    }
    lines
}
