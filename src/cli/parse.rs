//! What stands behind an option on the command line: text to value, or a sentence that says what is expected.

use std::{convert::Infallible, fs::OpenOptions, ops::RangeInclusive, path::Path, path::PathBuf};

use anyhow::Context;
use clap::builder::{OsStringValueParser, PathBufValueParser, TypedValueParser};

use crate::{
    document::{Background, Document, ParameterError, parameter::parse_color, range},
    instructions::{Instructions, Missing},
    render::output::{OutputError, format_of},
    scene::{
        ModelSource,
        environment::EnvironmentEncoding,
        path_text::{path_of_text, path_text},
    },
    store::replace::check_saving,
};

/// An instruction set that this processor has.
pub fn instructions(text: &str) -> Result<Instructions, String> {
    let chosen: Instructions = super::names::choice(text)?;
    chosen
        .level()
        .map(|_| chosen)
        .ok_or_else(|| Missing(chosen).to_string())
}

/// A parser for a number in a range; it refuses NaN.
pub fn number_in(range: RangeInclusive<f64>) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync {
    move |text| {
        let number = text.trim().parse().ok().filter(|x| range.contains(x));
        number.ok_or_else(|| format!("give a number from {} to {}", range.start(), range.end()))
    }
}

/// A parser for numbers with commas between them, each in its range.
pub fn numbers_in<const N: usize>(
    ranges: [RangeInclusive<f64>; N],
) -> impl Fn(&str) -> Result<[f64; N], String> + Clone + Send + Sync {
    move |text| {
        let parts: Vec<&str> = text.split(',').collect();
        if parts.len() != N {
            let example = vec!["1"; N].join(",");
            return Err(format!("give {N} numbers with commas between them, such as {example}"));
        }
        let mut numbers = [0.0; N];
        for ((number, part), range) in numbers.iter_mut().zip(parts).zip(&ranges) {
            *number = number_in(range.clone())(part).map_err(|expected| format!("{part}: {expected}"))?;
        }
        Ok(numbers)
    }
}

/// The part of an image: left, top, right, bottom as shares of it.
pub fn region(text: &str) -> Result<[f64; 4], String> {
    let sides = numbers_in([range::REGION, range::REGION, range::REGION, range::REGION])(text)?;
    if sides[0] >= sides[2] || sides[1] >= sides[3] {
        return Err("left must be less than right, and top less than bottom".to_owned());
    }
    Ok(sides)
}

/// Two whole numbers around a letter.
pub fn pair(text: &str, between: &[char]) -> Option<[u32; 2]> {
    let (first, second) = text.split_once(between)?;
    Some([first.trim().parse().ok()?, second.trim().parse().ok()?])
}

/// Width and height, as in 640x480.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    let size = pair(text, &['x', 'X']).filter(|size| size.iter().all(|side| range::SIZE.contains(&f64::from(*side))));
    let [least, most] = [range::SIZE.start(), range::SIZE.end()];
    size.ok_or_else(|| format!("give a width and a height from {least} to {most}, such as 640x480"))
}

/// Column and row of a pixel, as in 40,22.
pub fn pixel(text: &str) -> Result<[u32; 2], String> {
    let place = pair(text, &[',']);
    place.ok_or_else(|| "give a column and a row from 0,0 at the top left, such as 40,22".to_owned())
}

/// What the camera sees where it hits nothing.
pub fn background(text: &str) -> Result<Background, String> {
    match text {
        "environment" => Ok(Background::Environment),
        "transparent" => Ok(Background::Transparent),
        color => parse_color(color)
            .map(Background::Color)
            .map_err(|_| "give environment, transparent or a colour such as #808080".to_owned()),
    }
}

/// `KEY=VALUE`, checked: whether a parameter takes a value does not depend on the document.
pub fn assignment(text: &str) -> Result<String, ParameterError> {
    match Document::default().assign(text) {
        // The texture comes with another option, or with the document.
        Ok(()) | Err(ParameterError::NoTexture { .. }) => Ok(text.to_owned()),
        Err(error) => Err(error),
    }
}

/// The name of a file or of something built in: files whose names are not Unicode go by their addresses.
pub fn name_of_file<T, E>(
    read: impl Fn(&str) -> Result<T, E> + Clone + Send + Sync + 'static,
) -> impl TypedValueParser<Value = T>
where
    T: Clone + Send + Sync + 'static,
    E: Into<Box<dyn std::error::Error + Send + Sync>>,
{
    OsStringValueParser::new().try_map(move |name| match name.to_str() {
        Some(name) => read(name),
        None => read(&path_text(Path::new(&name))),
    })
}

/// A model.
pub fn model(text: &str) -> Result<ModelSource, Infallible> {
    Ok(text.into())
}

/// A file.
pub fn file(text: &str) -> Result<PathBuf, Infallible> {
    Ok(path_of_text(text))
}

/// A file to open. A word without an ending that names no file is taken for a command.
pub fn opened() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path: PathBuf| match path.extension() {
        None if !path.exists() => {
            let hint = super::meant(&path.display().to_string());
            Err(format!("no such command or file; {hint}"))
        }
        _ => Ok(path),
    })
}

/// The name of an image; its ending is one of those that are written.
pub fn picture() -> impl TypedValueParser<Value = PathBuf> {
    let checked = |path: PathBuf| -> Result<PathBuf, OutputError> { format_of(&path).map(|_| path) };
    PathBufValueParser::new().try_map(checked)
}

/// Whether a file can be saved there, asked before the work that fills it. What is there stays as it is.
///
/// # Errors
/// What the system says.
pub fn check_writable(path: &Path) -> anyhow::Result<()> {
    let existed = path.exists();
    if !existed || path.is_file() {
        let opened = OpenOptions::new().append(true).create(true).open(path);
        opened.with_context(|| {
            format!(
                "{}: cannot be written; check the folder and its permissions",
                path.display()
            )
        })?;
    }
    if !existed {
        // What is left here holds nothing.
        let _ = std::fs::remove_file(path);
    }
    Ok(check_saving(path)?)
}

/// `display` or `linear`.
pub fn environment_encoding(text: &str) -> Result<EnvironmentEncoding, String> {
    serde_json::from_value(text.into()).map_err(|_| format!("{text} is neither display nor linear"))
}
