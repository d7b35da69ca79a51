//! The header of a PLY file, and the rows of its elements, as text or bytes in either order.

use crate::files::text_or_latin_1;

/// How a number is stored.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

use Kind::{F32, F64, I8, I16, I32, U8, U16, U32};

/// Both names of each kind, and its size in bytes.
const KINDS: [(Kind, [&str; 2], usize); 8] = [
    (I8, ["char", "int8"], 1),
    (U8, ["uchar", "uint8"], 1),
    (I16, ["short", "int16"], 2),
    (U16, ["ushort", "uint16"], 2),
    (I32, ["int", "int32"], 4),
    (U32, ["uint", "uint32"], 4),
    (F32, ["float", "float32"], 4),
    (F64, ["double", "float64"], 8),
];

impl Kind {
    fn named(name: &str) -> Result<Self, String> {
        let found = KINDS.iter().find(|(_, names, _)| names.contains(&name));
        found
            .map(|(kind, ..)| *kind)
            .ok_or_else(|| format!("its header has numbers of a kind \"{name}\""))
    }

    /// The number in the last bytes of eight, highest first.
    fn number(self, eight: [u8; 8]) -> f64 {
        let bits = u64::from_be_bytes(eight);
        match self {
            I8 => f64::from(bits as i8),
            I16 => f64::from(bits as i16),
            I32 => f64::from(bits as i32),
            U8 | U16 | U32 => bits as f64,
            F32 => f64::from(f32::from_bits(bits as u32)),
            F64 => f64::from_bits(bits),
        }
    }
}

pub struct Property {
    pub name: String,
    kind: Kind,
    /// Of the number of values, in a list.
    count: Option<Kind>,
}

impl Property {
    pub fn is_list(&self) -> bool {
        self.count.is_some()
    }

    /// The code of a colour's 1.
    pub fn white(&self) -> f64 {
        match self.kind {
            U8 => 255.0,
            U16 => 65535.0,
            _ => 1.0,
        }
    }
}

pub struct Element {
    pub name: String,
    pub rows: u64,
    pub properties: Vec<Property>,
}

/// What is left of a file.
pub struct Rows<'a> {
    left: &'a [u8],
    format: Format,
}

#[derive(Clone, Copy, PartialEq)]
enum Format {
    Text,
    LowestFirst,
    HighestFirst,
}

/// The values of a row.
#[derive(Default)]
pub struct Row {
    values: Vec<f64>,
    /// Where those of each property end.
    ends: Vec<usize>,
}

impl Row {
    /// The values of a property.
    pub fn of(&self, property: usize) -> &[f64] {
        let start = property.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.values[start..self.ends[property]]
    }
}

/// The elements and the texture files of a file, and what comes after its header.
pub fn header(bytes: &[u8]) -> Result<(Vec<Element>, Vec<String>, Rows<'_>), String> {
    let (mut elements, mut textures): (Vec<Element>, _) = (Vec::new(), Vec::new());
    let mut rows = Rows {
        left: bytes,
        format: Format::Text,
    };
    if rows.line()? != "ply" {
        return Err("it does not begin with \"ply\"".to_owned());
    }
    loop {
        let line = rows.line().map_err(|_| "its header has no end")?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let unknown = || format!("its header has the line \"{line}\"");
        let (kind, count, name) = match words[..] {
            ["end_header"] => return Ok((elements, textures, rows)),
            ["comment", "TextureFile", ..] => {
                textures.extend(line.split_once("TextureFile").map(|(_, name)| name.trim().to_owned()));
                continue;
            }
            ["comment" | "obj_info", ..] => continue,
            ["format", name, ..] => {
                rows.format = match name {
                    "ascii" => Format::Text,
                    "binary_little_endian" => Format::LowestFirst,
                    "binary_big_endian" => Format::HighestFirst,
                    _ => return Err(unknown()),
                };
                continue;
            }
            ["element", name, count] => {
                elements.push(Element {
                    name: name.to_owned(),
                    rows: count.parse().map_err(|_| unknown())?,
                    properties: Vec::new(),
                });
                continue;
            }
            ["property", "list", count, kind, name] => (kind, Some(count), name),
            ["property", kind, name] => (kind, None, name),
            _ => return Err(unknown()),
        };
        let property = Property {
            name: name.to_owned(),
            kind: Kind::named(kind)?,
            count: count.map(Kind::named).transpose()?,
        };
        elements.last_mut().ok_or_else(unknown)?.properties.push(property);
    }
}

impl<'a> Rows<'a> {
    /// The next line that is not empty. Lines end as on any system.
    fn line(&mut self) -> Result<std::borrow::Cow<'a, str>, String> {
        loop {
            let end = self.left.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
            if self.left.is_empty() {
                return Err("the file ends before it".to_owned());
            }
            let (line, rest) = self.left.split_at(end.unwrap_or(self.left.len()));
            let is_pair = rest.starts_with(b"\r\n");
            self.left = rest.get(if is_pair { 2 } else { 1 }..).unwrap_or_default();
            if !line.trim_ascii().is_empty() {
                return Ok(text_or_latin_1(line.trim_ascii()));
            }
        }
    }

    /// Reads a row of an element with these properties, which are not none.
    pub fn read(&mut self, properties: &[Property], row: &mut Row) -> Result<(), String> {
        if self.format == Format::Text {
            let line = self.line()?;
            let mut words = line.split_ascii_whitespace();
            return row.fill(properties, |_| {
                let word = words.next().ok_or("a number is missing")?;
                word.parse().map_err(|_| format!("\"{word}\" is no number"))
            });
        }
        row.fill(properties, |kind| {
            let (.., size) = KINDS[kind as usize];
            let (bytes, left) = self.left.split_at_checked(size).ok_or("the file ends in it")?;
            self.left = left;
            let mut eight = [0; 8];
            eight[8 - size..].copy_from_slice(bytes);
            if self.format == Format::LowestFirst {
                eight[8 - size..].reverse();
            }
            Ok(kind.number(eight))
        })
    }
}

impl Row {
    fn fill(
        &mut self,
        properties: &[Property],
        mut next: impl FnMut(Kind) -> Result<f64, String>,
    ) -> Result<(), String> {
        self.values.clear();
        self.ends.clear();
        for property in properties {
            let count = property.count.map_or(Ok(1.0), &mut next)?;
            if count < 0.0 || count.fract() != 0.0 {
                return Err(format!("a list has {count} values"));
            }
            for _ in 0..count as u64 {
                self.values.push(next(property.kind)?);
            }
            self.ends.push(self.values.len());
        }
        Ok(())
    }
}
