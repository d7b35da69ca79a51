//! What a parameter is: a key, what to call it, what it takes, and how to read and write it. Those of a material stand in
//! [`PARAMETERS`], those of the rest of a document in [`SETTINGS`].

mod accessors;
mod line;
mod of_document;
mod of_light;
mod of_material;
mod of_texture;
mod text;

use serde_json::Value as Json;

use super::{Document, MaterialSettings, custom_curve::CustomCurve};
use crate::named::{Named, joined};
use crate::scene::texture::{TextureTarget, UserTexture};
use text::shortened;

pub use of_document::SETTINGS;
pub use of_light::LIGHT_PARAMETERS;
pub use of_material::PARAMETERS;
pub use of_texture::TEXTURE_PARAMETERS;
pub use text::{ColorError, nearest, nearest_key, parse_color};

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number in the parameter's unit.
    Number(f64),
    /// Coordinates in scene units.
    Place([f64; 3]),
    /// Left to the program.
    Absent,
    /// Linear RGB, each in [0, 1].
    Color([f32; 3]),
    /// A number for each colour channel.
    Triple([f32; 3]),
    /// The name of one of the parameter's choices.
    Choice(&'static str),
    Toggle(bool),
    /// A curve's points (ξ, D).
    Curve(Vec<[f32; 2]>),
}

/// What a parameter takes.
#[derive(Clone, Debug)]
pub enum Kind {
    Number {
        /// Least and largest value that it takes.
        range: [f64; 2],
        /// Unit, or empty.
        unit: &'static str,
        precision: Precision,
    },
    /// Coordinates in scene units.
    Place {
        /// Least and largest value that each takes.
        range: [f64; 2],
    },
    /// What may be left to the program.
    Optional {
        /// What it takes otherwise.
        kind: Box<Kind>,
        /// How "left to the program" is written.
        word: &'static str,
        /// What it is once switched on; `None` if only the scene knows it.
        at_first: Option<Value>,
    },
    /// Linear RGB; above 1 it is a tint.
    Color {
        /// Largest value that each takes.
        most: f32,
    },
    /// A number for each colour channel.
    Triple {
        /// Least and largest value that each takes.
        range: [f32; 2],
    },
    Choice(Vec<Choice>),
    Toggle,
    /// The points of a [`CustomCurve`].
    Curve,
}

/// How a number is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    Single,
    Double,
    Whole,
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

/// How a panel shows and edits a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowStyle {
    /// What its bar spans; `None`: it has no bar.
    pub bar: Option<[f64; 2]>,
    /// Change per point of dragging where there is no bar.
    pub step: f64,
    /// Most digits behind the point.
    pub decimals: usize,
    /// True where a share is shown in per cent.
    pub is_percent: bool,
}

/// What a change of a parameter calls for. See [`super::Change`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// What has been rendered is shown again.
    Display,
    /// Rendering goes on towards another goal.
    Goal,
    /// The image starts over, seen by another camera.
    Camera,
    /// The image starts over at another size.
    Size,
    /// The image starts over, drawn by other numbers or another way.
    Sampling,
    /// The image starts over under other light.
    Lighting,
    /// Materials are compiled.
    Materials,
    /// Geometry is built.
    Geometry,
}

/// The choices of a closed list.
fn choices<T: Named>() -> Kind {
    let choice = |&choice: &T| Choice {
        name: choice.name(),
        label: choice.label(),
        help: choice.help(),
    };
    Kind::Choice(T::ALL.iter().map(choice).collect())
}

/// A parameter of a material or of a document, declared once for panels, files, the command line and tests.
#[derive(Clone, Debug)]
pub struct Parameter<T: 'static = MaterialSettings> {
    /// Name in files and on the command line.
    pub key: &'static str,
    /// Which parameters it is shown with.
    pub group: &'static str,
    /// Name in panels.
    pub label: &'static str,
    /// Name in the whole window, in the history and in the palette; empty where group and label say it.
    pub name: &'static str,
    /// Name of its option on the command line, where it has one.
    pub flag: Option<&'static str>,
    /// The paper's symbol, or the usual one; empty where there is none.
    pub symbol: &'static str,
    /// What it does to the image.
    pub help: &'static str,
    pub kind: Kind,
    /// How a panel edits it where it is a number.
    pub row: RowStyle,
    /// What a change of it calls for.
    pub stage: Stage,
    /// True where the parameter has an effect.
    pub applies: fn(&T) -> bool,
    /// Why a parameter that applies changes nothing at present: it is shown, and can't be edited.
    pub idle: fn(&T) -> Option<&'static str>,
    get: fn(&T) -> Value,
    /// Only called with values that `check` accepts.
    set: fn(&mut T, Value),
}

/// Why a parameter cannot be set.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ParameterError {
    /// Text that is no assignment.
    #[error("{text}: write KEY=VALUE, such as specular.roughness=0.3")]
    NoAssignment { text: String },
    /// No parameter of that name.
    #[error("no parameter is called {key}; {hint}")]
    UnknownKey { key: String, hint: String },
    /// A parameter of a texture that is not there.
    #[error("{key}: there is no such texture; put one there first: --texture {target}=FILE")]
    NoTexture { key: &'static str, target: &'static str },
    /// A value that the parameter does not take.
    #[error("{key} does not take {value}; {expected}")]
    Invalid {
        key: &'static str,
        value: String,
        expected: String,
    },
}

/// The parameter of a material with this key.
pub fn parameter(key: &str) -> Result<&'static Parameter, ParameterError> {
    let found = PARAMETERS.iter().find(|parameter| parameter.key == key);
    found.ok_or_else(|| unknown_key(key))
}

/// Parameter that an image textures, and parameter of the image, of a key such as `base.color_map.rotation`.
fn texture_key(key: &str) -> Option<(TextureTarget, &str)> {
    let (of_target, of_texture) = key.rsplit_once('.')?;
    Some((TextureTarget::of_key(of_target, "_map")?, of_texture))
}

/// The parameter of an image on a material with this key.
fn texture_parameter(key: &str) -> Result<&'static Parameter<UserTexture>, ParameterError> {
    let found = TEXTURE_PARAMETERS.iter().find(|parameter| parameter.key == key);
    found.ok_or_else(|| ParameterError::UnknownKey {
        key: key.to_owned(),
        hint: format!(
            "the parameters of a texture are {}",
            joined(TEXTURE_PARAMETERS.iter().map(|parameter| parameter.key), ", ")
        ),
    })
}

/// The setting of a document with this key.
pub fn setting(key: &str) -> Option<&'static Parameter<Document>> {
    SETTINGS.iter().find(|setting| setting.key == key)
}

/// The keys of materials, then those of documents.
pub fn keys() -> impl Iterator<Item = &'static str> {
    let of_documents = SETTINGS.iter().map(|setting| setting.key);
    PARAMETERS.iter().map(|parameter| parameter.key).chain(of_documents)
}

fn unknown_key(key: &str) -> ParameterError {
    ParameterError::UnknownKey {
        key: key.to_owned(),
        hint: match nearest_key(key) {
            Some(near) => format!("did you mean {near}?"),
            None => format!("the parameters are {}", joined(keys(), ", ")),
        },
    }
}

/// The key and the text of `KEY=VALUE`.
fn split_assignment(assignment: &str) -> Result<(&str, &str), ParameterError> {
    let split = assignment.split_once('=').map(|(key, text)| (key.trim(), text));
    split.ok_or_else(|| ParameterError::NoAssignment {
        text: assignment.to_owned(),
    })
}

/// Sets a parameter of a material from `KEY=VALUE`; see [`Parameter::parse`].
pub fn assign(material: &mut MaterialSettings, assignment: &str) -> Result<(), ParameterError> {
    let (key, text) = split_assignment(assignment)?;
    if let Some((target, key)) = texture_key(key) {
        let parameter = texture_parameter(key)?;
        let value = parameter.parse(text)?;
        let texture = material
            .user_textures
            .get_mut(target)
            .ok_or(ParameterError::NoTexture {
                key: target.map_key(),
                target: target.name(),
            })?;
        return parameter.set(texture, value);
    }
    let parameter = parameter(key)?;
    parameter.set(material, parameter.parse(text)?)
}

impl MaterialSettings {
    /// Brings numbers and colours into their ranges.
    pub fn bring_into_range(&mut self) {
        for parameter in PARAMETERS.iter() {
            let [least, most] = match &parameter.kind {
                Kind::Number { range, .. } => range.map(|end| end as f32),
                Kind::Color { most } => [0.0, *most],
                _ => continue,
            };
            if let Some(numbers) = parameter.rgb(self) {
                parameter.put_rgb(self, numbers.map(|x| x.clamp(least, most)));
            }
        }
    }
}

impl Document {
    /// Sets a setting of the document, or a parameter of all its materials, from `KEY=VALUE`; see [`Parameter::parse`].
    pub fn assign(&mut self, assignment: &str) -> Result<(), ParameterError> {
        let (key, text) = split_assignment(assignment)?;
        if let Some(setting) = setting(key) {
            return setting.set(self, setting.parse(text)?);
        }
        let mut materials = self.materials.iter_mut();
        materials.try_for_each(|material| assign(material, assignment))
    }
}

impl<T: Default> Parameter<T> {
    /// The value of a new material or document.
    pub fn default_value(&self) -> Value {
        self.get(&T::default())
    }
}

/// Whether a value lies in a range, both ends included; nothing that is not a number does.
fn within<N: PartialOrd + Copy>([low, high]: [N; 2], value: N) -> bool {
    (low..=high).contains(&value)
}

/// What a parameter takes, and how the field is read and written through the variant of [`Value`] that holds it.
type Takes<T> = (Kind, (fn(&T) -> Value, fn(&mut T, Value)));

impl<T> Parameter<T> {
    /// What it is called in the whole window, for the history, the palette, screen readers and tests.
    pub fn full_name(&self) -> String {
        match self.name {
            "" => format!("{} {}", self.group, self.label.to_lowercase()),
            name => name.to_owned(),
        }
    }

    /// The value that something has.
    pub fn get(&self, of: &T) -> Value {
        (self.get)(of)
    }

    /// Sets the value.
    ///
    /// # Errors
    /// [`ParameterError::Invalid`] where the value is of the wrong kind or out of range; nothing is changed then.
    pub fn set(&self, of: &mut T, value: Value) -> Result<(), ParameterError> {
        self.check(&value)?;
        self.put(of, value);
        Ok(())
    }

    /// Sets a value that may be out of range; one of another kind changes nothing.
    pub fn put(&self, of: &mut T, value: Value) {
        (self.set)(of, value);
    }

    /// The value as formats of other programs have it: a colour, or a number three times.
    pub fn rgb(&self, of: &T) -> Option<[f32; 3]> {
        match self.get(of) {
            Value::Number(x) => Some([x as f32; 3]),
            Value::Color(color) => Some(color),
            _ => None,
        }
    }

    /// Sets such a value, which may be out of range.
    pub fn put_rgb(&self, of: &mut T, numbers: [f32; 3]) {
        let value = match self.kind {
            Kind::Number { .. } => Value::Number(numbers[0].into()),
            Kind::Color { .. } => Value::Color(numbers),
            Kind::Toggle => Value::Toggle(numbers[0] != 0.0),
            _ => return,
        };
        self.put(of, value);
    }

    /// Whether the parameter takes a value.
    pub fn check(&self, value: &Value) -> Result<(), ParameterError> {
        let kind = match (&self.kind, value) {
            (Kind::Optional { .. }, Value::Absent) => return Ok(()),
            (Kind::Optional { kind, .. }, _) => kind,
            (kind, _) => kind,
        };
        let is_valid = match (kind, value) {
            (Kind::Number { range, .. }, Value::Number(x)) => within(*range, *x),
            (Kind::Place { range }, Value::Place(place)) => place.iter().all(|x| within(*range, *x)),
            (Kind::Color { most }, Value::Color(color)) => color.iter().all(|x| within([0.0, *most], *x)),
            (Kind::Triple { range }, Value::Triple(triple)) => triple.iter().all(|x| within(*range, *x)),
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

    /// The value written as on the command line: a number, `#rrggbb` (sRGB), `r,g,b` (linear), a name, `on`,
    /// `off` (or `true`, `false`), or `ξ:D,ξ:D,…`.
    pub fn parse(&self, text: &str) -> Result<Value, ParameterError> {
        let text = text.trim();
        let value = self
            .kind
            .parse(text)
            .ok_or_else(|| self.invalid(text, self.expected()))?;
        self.check(&value)?;
        Ok(value)
    }

    /// The value as [`Parameter::parse`] reads it, exact.
    pub fn text(&self, value: &Value) -> String {
        match value {
            Value::Number(x) => self.kind.precision().text(*x),
            Value::Place([x, y, z]) => format!("{x},{y},{z}"),
            Value::Absent => self.kind.word_for_absent().to_owned(),
            Value::Color([r, g, b]) | Value::Triple([r, g, b]) => format!("{r},{g},{b}"),
            Value::Choice(name) => (*name).to_owned(),
            Value::Toggle(on) => if *on { "on" } else { "off" }.to_owned(),
            Value::Curve(points) => joined(points.iter().map(|[xi, distance]| format!("{xi}:{distance}")), ","),
        }
    }

    /// The value read from a file.
    pub fn value_from_json(&self, json: &Json) -> Result<Value, ParameterError> {
        let value = self.kind.value_from_json(json);
        let value = value.ok_or_else(|| self.invalid(&shortened(json.to_string()), self.expected_in_json()))?;
        self.check(&value)?;
        Ok(value)
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
        format!("give {}", self.kind.expected())
    }

    fn expected_in_json(&self) -> String {
        match &self.kind {
            Kind::Color { most } => format!("give [r, g, b] (linear, each from 0 to {most})"),
            Kind::Triple { range: [low, high] } => format!("give [r, g, b], each from {low} to {high}"),
            Kind::Curve => "give points [[ξ, D], …] such as [[0, 0], [0.5, 0.4], [1, 1]]".to_owned(),
            _ => self.expected(),
        }
    }
}
