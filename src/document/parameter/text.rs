//! Values as text and as JSON.

use std::{fmt::Write as _, str::FromStr};

use serde_json::Value as Json;

use super::{Choice, Kind, Parameter, Precision, Value, keys};
use crate::{
    document::custom_curve::DISTANCE_MAX, named::joined, optics::tone::linear_from_srgb, optics::vector::Vec3,
};

impl Kind {
    /// The value that a text says; `None` where it says none of this kind. Ranges are not looked at.
    pub(super) fn parse(&self, text: &str) -> Option<Value> {
        match self {
            Kind::Number { precision, .. } => match precision {
                Precision::Single => parse_number::<f32>(text).map(f64::from),
                Precision::Double => parse_number(text),
                Precision::Whole => text.parse::<u32>().ok().map(f64::from),
            }
            .map(Value::Number),
            Kind::Place { .. } => parse_list(text).map(Value::Place),
            Kind::Optional { word, .. } if text == *word => Some(Value::Absent),
            Kind::Optional { kind, .. } => kind.parse(text),
            Kind::Color { .. } => parse_hex_color(text).or_else(|| parse_list(text)).map(Value::Color),
            Kind::Triple { .. } => parse_list(text).map(Value::Triple),
            Kind::Choice(choices) => choose(choices, text),
            Kind::Toggle => match text {
                "true" | "on" => Some(Value::Toggle(true)),
                "false" | "off" => Some(Value::Toggle(false)),
                _ => None,
            },
            Kind::Curve => parse_points(text).map(Value::Curve),
        }
    }

    /// The value that a file says; `None` where it says none of this kind. Ranges are not looked at.
    pub(super) fn value_from_json(&self, json: &Json) -> Option<Value> {
        match (self, json) {
            (Kind::Number { precision, .. }, json) => match precision {
                Precision::Single => json_number(json).map(f64::from),
                Precision::Double => json.as_f64(),
                Precision::Whole => json.as_u64()?.try_into().ok().map(|n: u32| n.into()),
            }
            .map(Value::Number),
            (Kind::Place { .. }, Json::Array(place)) => {
                let numbers: Option<Vec<f64>> = place.iter().map(Json::as_f64).collect();
                numbers?.try_into().ok().map(Value::Place)
            }
            (Kind::Optional { .. }, Json::Null) => Some(Value::Absent),
            (Kind::Optional { kind, .. }, json) => kind.value_from_json(json),
            (Kind::Color { .. }, json) => json_numbers(json).map(Value::Color),
            (Kind::Triple { .. }, json) => json_numbers(json).map(Value::Triple),
            (Kind::Choice(choices), Json::String(name)) => choose(choices, name),
            (Kind::Toggle, Json::Bool(on)) => Some(Value::Toggle(*on)),
            (Kind::Curve, Json::Array(points)) => {
                points.iter().map(json_numbers).collect::<Option<_>>().map(Value::Curve)
            }
            _ => None,
        }
    }

    /// What it takes, in words.
    pub(super) fn expected(&self) -> String {
        match self {
            Kind::Number { range, unit, precision } => {
                let whole = if *precision == Precision::Whole { "whole " } else { "" };
                let space = if unit.is_empty() { "" } else { " " };
                let [low, high] = range.map(|end| precision.text(end));
                format!("a {whole}number from {low} to {high}{space}{unit}")
            }
            Kind::Place { range: [low, high] } => format!("x,y,z: three numbers, each from {low} to {high}"),
            Kind::Optional { kind, word, .. } => format!("{}, or {word}", kind.expected()),
            Kind::Color { most } => format!("#rrggbb (sRGB) or r,g,b (linear, each from 0 to {most})"),
            Kind::Triple { range: [low, high] } => format!("r,g,b: three numbers, each from {low} to {high}"),
            Kind::Choice(choices) => format!("one of {}", joined(choices.iter().map(|choice| choice.name), ", ")),
            Kind::Toggle => "on or off".to_owned(),
            Kind::Curve => {
                format!("points ξ:D,ξ:D,… such as 0:0,0.5:0.4,1:1, ξ from 0 to 1, D rising to at most {DISTANCE_MAX}")
            }
        }
    }

    /// What stands for its values in the help of the command line.
    pub fn placeholder(&self) -> String {
        let of_unit = |unit: &str| match unit {
            "°" => "DEG".to_owned(),
            "s" => "SECONDS".to_owned(),
            "m" => "METRES".to_owned(),
            "" => "X".to_owned(),
            unit => unit.to_owned(),
        };
        match self {
            Kind::Number {
                precision: Precision::Whole,
                ..
            } => "N".to_owned(),
            Kind::Number { unit, .. } => of_unit(unit),
            Kind::Place { .. } => "X,Y,Z".to_owned(),
            Kind::Optional { kind, word, .. } => format!("{}|{word}", kind.placeholder()),
            Kind::Color { .. } => "#RRGGBB".to_owned(),
            Kind::Triple { .. } => "R,G,B".to_owned(),
            Kind::Choice(choices) => joined(choices.iter().map(|choice| choice.name), "|"),
            Kind::Toggle => "on|off".to_owned(),
            Kind::Curve => "ξ:D,…".to_owned(),
        }
    }

    /// How its numbers are kept.
    pub(super) fn precision(&self) -> Precision {
        match self {
            Kind::Number { precision, .. } => *precision,
            Kind::Optional { kind, .. } => kind.precision(),
            _ => Precision::Double,
        }
    }

    /// The word for what is left to the program; empty where nothing can be.
    pub(super) fn word_for_absent(&self) -> &'static str {
        match self {
            Kind::Optional { word, .. } => word,
            _ => "",
        }
    }
}

impl Precision {
    /// A number that reads back as it is.
    pub(super) fn text(self, x: f64) -> String {
        match self {
            Self::Single => (x as f32).to_string(),
            Self::Double | Self::Whole => x.to_string(),
        }
    }
}

impl<T> Parameter<T> {
    /// The value as it is written to files, exact.
    pub fn json_from_value(&self, value: &Value) -> Json {
        match value {
            Value::Number(x) => match self.kind.precision() {
                Precision::Single => json_from_number(*x as f32),
                Precision::Double => Json::from(*x),
                Precision::Whole => Json::from(*x as u32),
            },
            Value::Place(place) => place.iter().copied().collect(),
            Value::Absent => Json::Null,
            Value::Color(triple) | Value::Triple(triple) => triple.iter().map(|x| json_from_number(*x)).collect(),
            Value::Choice(name) => Json::from(*name),
            Value::Toggle(on) => Json::from(*on),
            Value::Curve(points) => {
                let point = |point: &[f32; 2]| point.iter().map(|x| json_from_number(*x)).collect::<Json>();
                points.iter().map(point).collect()
            }
        }
    }
}

/// A finite number; f32 that overflows counts as none.
pub fn parse_number<N: FromStr + Into<f64> + Copy>(text: &str) -> Option<N> {
    let number: Option<N> = text.trim().parse().ok();
    number.filter(|x| (*x).into().is_finite())
}

/// Three numbers with commas between them.
pub fn parse_list<N: FromStr + Into<f64> + Copy>(text: &str) -> Option<[N; 3]> {
    let numbers: Option<Vec<N>> = text.split(',').map(parse_number).collect();
    numbers?.try_into().ok()
}

/// A text that is no colour.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0} is no colour; give {COLOR_EXPECTED}")]
pub struct ColorError(String);

const COLOR_EXPECTED: &str = "#rrggbb (sRGB) or r,g,b (linear, each from 0 to 1)";

/// Linear RGB, each in [0, 1], from `#rrggbb` (sRGB) or `r,g,b` (linear).
pub fn parse_color(text: &str) -> Result<[f32; 3], ColorError> {
    let color = parse_hex_color(text).or_else(|| parse_list(text));
    let color = color.filter(|color| color.iter().all(|x| (0.0..=1.0).contains(x)));
    color.ok_or_else(|| ColorError(shortened(text.to_owned())))
}

/// Linear RGB from `#rrggbb` in sRGB.
fn parse_hex_color(text: &str) -> Option<[f32; 3]> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6)?;
    // A sign would pass as part of a number.
    let digits = Some(digits).filter(|digits| digits.bytes().all(|digit| digit.is_ascii_hexdigit()))?;
    let byte = |i: usize| u8::from_str_radix(&digits[2 * i..2 * i + 2], 16).ok();
    let srgb = [byte(0)?, byte(1)?, byte(2)?].map(|b| f64::from(b) / 255.0);
    Some(linear_from_srgb(Vec3::<f64>::from_f64(srgb)).to_f32())
}

pub fn parse_points(text: &str) -> Option<Vec<[f32; 2]>> {
    let point = |text: &str| {
        let (xi, distance) = text.split_once(':')?;
        Some([parse_number(xi)?, parse_number(distance)?])
    };
    text.split(',').map(point).collect()
}

pub fn choose(choices: &[Choice], name: &str) -> Option<Value> {
    let choice = choices.iter().find(|choice| choice.name == name)?;
    Some(Value::Choice(choice.name))
}

pub fn json_number(json: &Json) -> Option<f32> {
    json.as_f64().map(|x| x as f32).filter(|x| x.is_finite())
}

pub fn json_numbers<const N: usize>(json: &Json) -> Option<[f32; N]> {
    let numbers: Option<Vec<f32>> = json.as_array()?.iter().map(json_number).collect();
    numbers?.try_into().ok()
}

/// The shortest number that reads back as the same f32.
pub fn json_from_number(x: f32) -> Json {
    Json::from(x.to_string().parse().unwrap_or(f64::from(x)))
}

/// At most 60 characters of what a user gave, for messages.
pub fn shortened(text: String) -> String {
    match text.char_indices().nth(60) {
        None => text,
        Some((end, _)) => {
            let mut start = text[..end].to_owned();
            let _ = write!(start, "…");
            start
        }
    }
}

/// The key that was probably meant, the group being left out or not.
pub fn nearest_key(key: &str) -> Option<&'static str> {
    let short = |known: &'static str| known.rsplit_once('.').map_or(known, |(_, short)| short);
    nearest(key, keys().flat_map(|known| [(known, known), (short(known), known)]))
}

/// What belongs to the name that was probably meant: the nearest by edits, of which a third of the letters may be needed.
pub fn nearest<'a, T>(name: &str, known: impl Iterator<Item = (&'a str, T)>) -> Option<T> {
    let near = known
        .map(|(known, of_it)| (edit_distance(name, known), of_it))
        .min_by_key(|(edits, _)| *edits);
    near.filter(|(edits, _)| 3 * edits <= name.chars().count())
        .map(|(_, of_it)| of_it)
}

/// Fewest insertions, removals and replacements of characters that turn one text into the other.
fn edit_distance(from: &str, to: &str) -> usize {
    let mut row: Vec<usize> = (0..=to.chars().count()).collect();
    for (i, a) in from.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, b) in to.chars().enumerate() {
            let replaced = diagonal + usize::from(a != b);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row.last().copied().unwrap_or_default()
}
