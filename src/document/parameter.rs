//! What a parameter is: a key, what to call it, what it takes, and how to read and write it. The parameters themselves
//! stand in [`super::PARAMETERS`].

use std::fmt::Write as _;

use serde_json::Value as Json;

use super::custom_curve::{CustomCurve, DISTANCE_MAX};
use super::{MaterialSettings, PARAMETERS};
use crate::optics::tone::linear_from_srgb;
use crate::optics::vector::Vec3;

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number in the parameter's unit.
    Number(f32),
    /// Linear RGB, each in [0, 1].
    Color([f32; 3]),
    /// A number for each colour channel.
    Triple([f32; 3]),
    /// The name of one of the parameter's choices.
    Choice(&'static str),
    /// On or off.
    Toggle(bool),
    /// A curve's points (ξ, D).
    Curve(Vec<[f32; 2]>),
}

/// What a parameter takes.
#[derive(Clone, Debug)]
pub enum Kind {
    /// A number.
    Number {
        /// Least and largest value that it takes.
        range: [f32; 2],
        /// What a slider spans.
        soft_range: [f32; 2],
        /// Unit, or empty.
        unit: &'static str,
        /// What an arrow key changes it by.
        step: f32,
    },
    /// Linear RGB, each in [0, 1].
    Color,
    /// A number for each colour channel.
    Triple {
        /// Least and largest value that each takes.
        range: [f32; 2],
    },
    /// One of several.
    Choice(Vec<Choice>),
    /// On or off.
    Toggle,
    /// The points of a [`CustomCurve`].
    Curve,
}

/// One of several values to choose from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// Name in files and on the command line.
    pub name: &'static str,
    /// Name in the menus.
    pub label: &'static str,
    /// When to choose it.
    pub help: &'static str,
}

/// A parameter of a material, declared once for panels, files, the command line and tests.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Name in files and on the command line.
    pub key: &'static str,
    /// Which parameters it is shown with.
    pub group: &'static str,
    /// Name in panels.
    pub label: &'static str,
    /// The paper's symbol, or the usual one; empty where there is none.
    pub symbol: &'static str,
    /// What it does to the picture.
    pub help: &'static str,
    /// What it takes.
    pub kind: Kind,
    /// True where the parameter has an effect on this material.
    pub applies: fn(&MaterialSettings) -> bool,
    pub(super) get: fn(&MaterialSettings) -> Value,
    /// Only called with values that `check` accepts.
    pub(super) set: fn(&mut MaterialSettings, Value),
}

/// Why a parameter cannot be set.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ParameterError {
    /// Text that is no assignment.
    #[error("{text}: write KEY=VALUE, such as specular.roughness=0.3")]
    NoAssignment {
        /// The text.
        text: String,
    },
    /// No parameter of that name.
    #[error("no parameter is called {key}; {hint}")]
    UnknownKey {
        /// The name.
        key: String,
        /// The nearest name, or all of them.
        hint: String,
    },
    /// A value that the parameter does not take.
    #[error("{key} does not take {value}; {expected}")]
    Invalid {
        /// The parameter.
        key: &'static str,
        /// The value as it was given.
        value: String,
        /// What it takes.
        expected: String,
    },
}

/// The parameter with this key.
///
/// # Errors
/// [`ParameterError::UnknownKey`], which suggests the nearest.
pub fn parameter(key: &str) -> Result<&'static Parameter, ParameterError> {
    let found = PARAMETERS.iter().find(|parameter| parameter.key == key);
    found.ok_or_else(|| ParameterError::UnknownKey {
        key: key.to_owned(),
        hint: match nearest_key(key) {
            Some(near) => format!("did you mean {near}?"),
            None => {
                let keys: Vec<_> = PARAMETERS.iter().map(|parameter| parameter.key).collect();
                format!("the parameters are {}", keys.join(", "))
            }
        },
    })
}

/// Sets a parameter from `KEY=VALUE`; see [`Parameter::parse`].
///
/// # Errors
/// Says what is wrong and what would be right.
pub fn assign(material: &mut MaterialSettings, assignment: &str) -> Result<(), ParameterError> {
    let (key, text) = assignment.split_once('=').ok_or_else(|| ParameterError::NoAssignment {
        text: assignment.to_owned(),
    })?;
    let parameter = parameter(key.trim())?;
    parameter.set(material, parameter.parse(text)?)
}

impl Parameter {
    /// The material's value.
    pub fn get(&self, material: &MaterialSettings) -> Value {
        (self.get)(material)
    }

    /// Sets the material's value.
    ///
    /// # Errors
    /// [`ParameterError::Invalid`] where the value is of the wrong kind or out of range; the material stays as it was.
    pub fn set(&self, material: &mut MaterialSettings, value: Value) -> Result<(), ParameterError> {
        self.check(&value)?;
        (self.set)(material, value);
        Ok(())
    }

    /// The value of a new material.
    pub fn default_value(&self) -> Value {
        self.get(&MaterialSettings::default())
    }

    /// Whether the parameter takes a value.
    ///
    /// # Errors
    /// [`ParameterError::Invalid`] where it does not.
    pub fn check(&self, value: &Value) -> Result<(), ParameterError> {
        let within = |[low, high]: &[f32; 2], x: &f32| (*low..=*high).contains(x);
        let is_valid = match (&self.kind, value) {
            (Kind::Number { range, .. }, Value::Number(x)) => within(range, x),
            (Kind::Color, Value::Color(color)) => color.iter().all(|x| within(&[0.0, 1.0], x)),
            (Kind::Triple { range }, Value::Triple(triple)) => triple.iter().all(|x| within(range, x)),
            (Kind::Choice(choices), Value::Choice(name)) => choices.iter().any(|choice| choice.name == *name),
            (Kind::Toggle, Value::Toggle(_)) => true,
            (Kind::Curve, Value::Curve(points)) => {
                return match CustomCurve::try_from(points.clone()) {
                    Ok(_) => Ok(()),
                    Err(error) => Err(self.invalid(&self.text(value), error.to_string())),
                };
            }
            _ => false,
        };
        if is_valid {
            Ok(())
        } else {
            Err(self.invalid(&self.text(value), self.expected()))
        }
    }

    /// The value written as on the command line: a number, `#rrggbb` (sRGB), `r,g,b` (linear), a name, `true`,
    /// `false`, or `ξ:D,ξ:D,…`.
    ///
    /// # Errors
    /// [`ParameterError::Invalid`], which says what the parameter takes.
    pub fn parse(&self, text: &str) -> Result<Value, ParameterError> {
        let text = text.trim();
        let value = match &self.kind {
            Kind::Number { .. } => parse_number(text).map(Value::Number),
            Kind::Color => parse_color(text).ok().map(Value::Color),
            Kind::Triple { .. } => parse_triple(text).map(Value::Triple),
            Kind::Choice(choices) => choose(choices, text),
            Kind::Toggle => text.parse().ok().map(Value::Toggle),
            Kind::Curve => parse_points(text).map(Value::Curve),
        };
        let value = value.ok_or_else(|| self.invalid(text, self.expected()))?;
        self.check(&value)?;
        Ok(value)
    }

    /// The value as [`Parameter::parse`] reads it, exact.
    pub fn text(&self, value: &Value) -> String {
        match value {
            Value::Number(x) => x.to_string(),
            Value::Color([r, g, b]) | Value::Triple([r, g, b]) => format!("{r},{g},{b}"),
            Value::Choice(name) => (*name).to_owned(),
            Value::Toggle(on) => on.to_string(),
            Value::Curve(points) => {
                let points: Vec<_> = points.iter().map(|[xi, distance]| format!("{xi}:{distance}")).collect();
                points.join(",")
            }
        }
    }

    /// The value read from a file.
    ///
    /// # Errors
    /// [`ParameterError::Invalid`], which says what the parameter takes.
    pub fn value_from_json(&self, json: &Json) -> Result<Value, ParameterError> {
        let value = match (&self.kind, json) {
            (Kind::Number { .. }, json) => json_number(json).map(Value::Number),
            (Kind::Color, json) => json_numbers(json).map(Value::Color),
            (Kind::Triple { .. }, json) => json_numbers(json).map(Value::Triple),
            (Kind::Choice(choices), Json::String(name)) => choose(choices, name),
            (Kind::Toggle, Json::Bool(on)) => Some(Value::Toggle(*on)),
            (Kind::Curve, Json::Array(points)) => {
                points.iter().map(json_numbers).collect::<Option<_>>().map(Value::Curve)
            }
            _ => None,
        };
        let value = value.ok_or_else(|| self.invalid(&shortened(json.to_string()), self.expected_in_json()))?;
        self.check(&value)?;
        Ok(value)
    }

    /// The value as it is written to files, exact.
    pub fn json_from_value(&self, value: &Value) -> Json {
        match value {
            Value::Number(x) => json_from_number(*x),
            Value::Color(triple) | Value::Triple(triple) => triple.iter().map(|x| json_from_number(*x)).collect(),
            Value::Choice(name) => Json::from(*name),
            Value::Toggle(on) => Json::from(*on),
            Value::Curve(points) => {
                let point = |point: &[f32; 2]| point.iter().map(|x| json_from_number(*x)).collect::<Json>();
                points.iter().map(point).collect()
            }
        }
    }

    fn invalid(&self, value: &str, expected: String) -> ParameterError {
        ParameterError::Invalid {
            key: self.key,
            value: if value.is_empty() {
                "nothing".to_owned()
            } else {
                shortened(value.to_owned())
            },
            expected,
        }
    }

    /// What the parameter takes, as a request.
    pub fn expected(&self) -> String {
        match &self.kind {
            Kind::Number {
                range: [low, high],
                unit,
                ..
            } => {
                let space = if unit.is_empty() { "" } else { " " };
                format!("give a number from {low} to {high}{space}{unit}")
            }
            Kind::Color => format!("give {COLOR_EXPECTED}"),
            Kind::Triple { range: [low, high] } => {
                format!("give r,g,b: three numbers, each from {low} to {high}")
            }
            Kind::Choice(choices) => {
                let names: Vec<_> = choices.iter().map(|choice| choice.name).collect();
                format!("give one of {}", names.join(", "))
            }
            Kind::Toggle => "give true or false".to_owned(),
            Kind::Curve => {
                format!(
                    "give points ξ:D,ξ:D,… such as 0:0,0.5:0.4,1:1, ξ from 0 to 1, D rising to at most {DISTANCE_MAX}"
                )
            }
        }
    }

    fn expected_in_json(&self) -> String {
        match &self.kind {
            Kind::Color => "give [r, g, b] (linear, each from 0 to 1)".to_owned(),
            Kind::Triple { range: [low, high] } => format!("give [r, g, b], each from {low} to {high}"),
            Kind::Curve => "give points [[ξ, D], …] such as [[0, 0], [0.5, 0.4], [1, 1]]".to_owned(),
            _ => self.expected(),
        }
    }
}

/// A finite number; f32 that overflows counts as none.
fn parse_number(text: &str) -> Option<f32> {
    text.trim().parse().ok().filter(|x: &f32| x.is_finite())
}

fn parse_triple(text: &str) -> Option<[f32; 3]> {
    let numbers: Option<Vec<f32>> = text.split(',').map(parse_number).collect();
    numbers?.try_into().ok()
}

/// A text that is no colour.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0} is no colour; give {COLOR_EXPECTED}")]
pub struct ColorError(String);

const COLOR_EXPECTED: &str = "#rrggbb (sRGB) or r,g,b (linear, each from 0 to 1)";

/// Linear RGB, each in [0, 1], from `#rrggbb` (sRGB) or `r,g,b` (linear).
///
/// # Errors
/// Says what would be right.
pub fn parse_color(text: &str) -> Result<[f32; 3], ColorError> {
    let color = parse_hex_color(text).or_else(|| parse_triple(text));
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

fn parse_points(text: &str) -> Option<Vec<[f32; 2]>> {
    let point = |text: &str| {
        let (xi, distance) = text.split_once(':')?;
        Some([parse_number(xi)?, parse_number(distance)?])
    };
    text.split(',').map(point).collect()
}

fn choose(choices: &[Choice], name: &str) -> Option<Value> {
    let choice = choices.iter().find(|choice| choice.name == name)?;
    Some(Value::Choice(choice.name))
}

fn json_number(json: &Json) -> Option<f32> {
    json.as_f64().map(|x| x as f32).filter(|x| x.is_finite())
}

fn json_numbers<const N: usize>(json: &Json) -> Option<[f32; N]> {
    let numbers: Option<Vec<f32>> = json.as_array()?.iter().map(json_number).collect();
    numbers?.try_into().ok()
}

/// The shortest number that reads back as the same f32.
fn json_from_number(x: f32) -> Json {
    Json::from(x.to_string().parse().unwrap_or(f64::from(x)))
}

/// At most 60 characters of what a user gave, for messages.
fn shortened(text: String) -> String {
    match text.char_indices().nth(60) {
        None => text,
        Some((end, _)) => {
            let mut start = text[..end].to_owned();
            let _ = write!(start, "…");
            start
        }
    }
}

/// The key that was probably meant: nearest by edits, the group being left out or not.
pub(crate) fn nearest_key(key: &str) -> Option<&'static str> {
    let distance = |known: &str| {
        let short = known.rsplit_once('.').map_or(known, |(_, short)| short);
        edit_distance(key, known).min(edit_distance(key, short))
    };
    let near = PARAMETERS
        .iter()
        .map(|p| (distance(p.key), p.key))
        .min_by_key(|(edits, _)| *edits);
    near.filter(|(edits, _)| 3 * edits <= key.chars().count())
        .map(|(_, key)| key)
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
