//! A batch's file: lists in TOML. What an entry sets are the options of `glossmith render` without their dashes; what is
//! named with dots is what `--set` takes.

use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail};
use clap::Parser;
use serde::Deserialize;
use toml::{Spanned, Table, Value};

use crate::{
    cli::scene::SceneArguments, document::turntable::Turn, render::output::format_of, scene::path_text::path_text,
};

/// Options whose values name files: these are looked for beside the batch's file first.
const FILES: [&str; 4] = ["model", "material", "environment", "project"];

type List = Option<Spanned<Vec<Spanned<Value>>>>;

/// The file as it is written. The lists stand in the order in which images count through them.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Parts {
    models: List,
    materials: List,
    environments: List,
    cameras: List,
    settings: List,
    common: Option<Spanned<Table>>,
    folder: Option<PathBuf>,
    formats: Option<Spanned<Vec<String>>>,
    frames: Option<Spanned<u32>>,
    #[serde(default)]
    turn: Turn,
}

/// The part of the arguments of `glossmith render` that an entry may set; of options given twice the last counts.
#[derive(Debug, Parser)]
#[command(no_binary_name = true, args_override_self = true, disable_help_flag = true)]
pub struct Scene {
    #[command(flatten)]
    pub arguments: SceneArguments,
}

impl Scene {
    /// The scene of arguments as they are written on the command line.
    pub fn parse(arguments: &[String]) -> anyhow::Result<Self> {
        Self::try_parse_from(arguments).map_err(|error| {
            let message = error.render().to_string();
            let first = message.lines().next().unwrap_or_default();
            anyhow!("{}", first.trim_start_matches("error: "))
        })
    }
}

/// An entry of a list.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// Its part of the images' names.
    pub name: String,
    /// What it sets, as arguments of `glossmith render`.
    pub arguments: Vec<String>,
}

/// What a file says.
#[derive(Clone, Debug)]
pub struct BatchFile {
    /// Where it is.
    pub path: PathBuf,
    /// Where the images go.
    pub folder: PathBuf,
    /// Endings of the files of each image.
    pub formats: Vec<String>,
    /// What all images have in common, as arguments.
    pub common: Vec<String>,
    /// The lists that are there.
    pub lists: Vec<Vec<Variant>>,
    /// Frames of a whole turn; none where nothing turns.
    pub frames: Option<u32>,
    /// What turns.
    pub turn: Turn,
}

/// Values as they are written on the command line.
fn text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(list) => crate::named::joined(list.iter().map(text), ","),
        Value::Integer(number) => number.to_string(),
        Value::Float(number) => number.to_string(),
        Value::Boolean(is_on) => is_on.to_string(),
        Value::Datetime(_) | Value::Table(_) => "{…}".to_owned(),
    }
}

/// The arguments of an entry's options; a list of texts gives its option several times.
fn arguments(folder: &Path, table: &Table) -> anyhow::Result<Vec<String>> {
    let mut arguments = Vec::new();
    for (name, value) in table.iter().filter(|(name, _)| *name != "name") {
        match value {
            Value::Table(inner) => assignments(name, inner, &mut arguments),
            Value::Array(list) if list.iter().all(Value::is_str) => {
                arguments.extend(list.iter().map(|value| option(folder, name, value)));
            }
            _ => arguments.push(option(folder, name, value)),
        }
    }
    Scene::parse(&arguments)?;
    Ok(arguments)
}

fn option(folder: &Path, name: &str, value: &Value) -> String {
    let mut text = text(value);
    let beside = folder.join(&text);
    if FILES.contains(&name) && beside.exists() {
        text = path_text(&beside).into_owned();
    }
    match name {
        "project" => text,
        _ => format!("--{name}={text}"),
    }
}

fn assignments(path: &str, table: &Table, arguments: &mut Vec<String>) {
    for (key, value) in table {
        let path = format!("{path}.{key}");
        match value {
            Value::Table(inner) => assignments(&path, inner, arguments),
            _ => arguments.push(format!("--set={path}={}", text(value))),
        }
    }
}

/// An entry of a list whose texts stand for an option.
fn entry(folder: &Path, value: &Value, option: Option<&str>) -> anyhow::Result<Variant> {
    let (name, options) = match (value, option) {
        (Value::String(text), Some(option)) => {
            let stem = Path::new(text)
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            (stem, &Table::from_iter([(option.to_owned(), value.clone())]))
        }
        (Value::Table(table), _) => match table.get("name") {
            Some(Value::String(name)) => (name.clone(), table),
            _ => bail!("an entry has no name; add name = \"…\""),
        },
        (_, Some(_)) => bail!("an entry is a text, or a table with a name and options"),
        (_, None) => bail!("an entry is a table, such as {{ name = \"a\", samples = 64 }}"),
    };
    Ok(Variant {
        name: plain(&name),
        arguments: arguments(folder, options)?,
    })
}

/// A name that is a part of a file's name everywhere.
fn plain(name: &str) -> String {
    let letter = |c: char| {
        if c.is_alphanumeric() || "_.+".contains(c) {
            c
        } else {
            '-'
        }
    };
    let name: String = name.chars().map(letter).collect();
    name.trim_matches(['-', '.']).to_owned()
}

impl BatchFile {
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let text = std::fs::read_to_string(path)
            .with_context(|| format!("{}: cannot be read; give a batch's file in TOML", path.display()))?;
        let wrong = |at: std::ops::Range<usize>, reason: String| {
            let line = 1 + text[..at.start.min(text.len())].matches('\n').count();
            anyhow!("{}, line {line}: {reason}", path.display())
        };
        let parts: Parts = toml::from_str(&text).map_err(|error| {
            let reason = format!("{}; correct the TOML there", error.message().replace('\n', ", "));
            wrong(error.span().unwrap_or_default(), reason)
        })?;
        let beside = path.parent().unwrap_or(Path::new(""));
        let mut file = Self {
            path: path.to_owned(),
            folder: beside.join(parts.folder.unwrap_or("pictures".into())),
            formats: vec!["png".to_owned()],
            common: Vec::new(),
            lists: Vec::new(),
            frames: None,
            turn: parts.turn,
        };
        let lists = [
            ("models", Some("model"), parts.models),
            ("materials", Some("material"), parts.materials),
            ("environments", Some("environment"), parts.environments),
            ("cameras", None, parts.cameras),
            ("settings", None, parts.settings),
        ];
        for (key, option, list) in lists {
            let Some(list) = list else { continue };
            let mut entries: Vec<Variant> = Vec::new();
            for value in list.get_ref() {
                let entry = entry(beside, value.get_ref(), option);
                let entry = entry.map_err(|error| wrong(value.span(), format!("{key}: {error:#}")))?;
                if entries.iter().any(|other| other.name == entry.name) {
                    let reason = format!(
                        "{key} has two entries of the name {}; give one another name",
                        entry.name
                    );
                    return Err(wrong(value.span(), reason));
                }
                entries.push(entry);
            }
            if entries.is_empty() {
                return Err(wrong(
                    list.span(),
                    format!("{key} is no list with entries; write {key} = [ … ]"),
                ));
            }
            file.lists.push(entries);
        }
        if let Some(common) = parts.common {
            let arguments = arguments(beside, common.get_ref());
            file.common = arguments.map_err(|error| wrong(common.span(), format!("common: {error:#}")))?;
        }
        if let Some(formats) = parts.formats {
            let span = formats.span();
            file.formats = formats.into_inner();
            let is_known = |ending: &String| format_of(Path::new(&format!("a.{ending}"))).is_ok();
            let mut once = file.formats.clone();
            once.sort();
            once.dedup();
            if file.formats.is_empty() || once.len() < file.formats.len() || !once.iter().all(is_known) {
                return Err(wrong(span, "formats are png, exr and hdr, each once".to_owned()));
            }
        }
        if let Some(frames) = parts.frames {
            file.frames = Some(*frames.get_ref());
            if !(1..=9999).contains(frames.get_ref()) {
                return Err(wrong(frames.span(), "frames is no number from 1 to 9999".to_owned()));
            }
        }
        if file.lists.is_empty() && file.frames.is_none() {
            bail!(
                "{}: nothing to render; add a list, such as materials = [\"gold\", \"silver\"]",
                path.display()
            );
        }
        Ok(file)
    }

    /// The folder of the images, and the names and arguments of all, in order. Frames of a turn follow one another.
    pub fn pictures(&self) -> Vec<Picture> {
        let mut pictures = vec![Picture::default()];
        pictures[0].arguments = self.common.clone();
        for list in &self.lists {
            let with = |picture: &Picture, entry: &Variant| Picture {
                name: joined(&picture.name, &entry.name),
                arguments: [&picture.arguments[..], &entry.arguments].concat(),
                ..*picture
            };
            pictures = pictures
                .iter()
                .flat_map(|picture| list.iter().map(|entry| with(picture, entry)).collect::<Vec<_>>())
                .collect();
        }
        let Some(frames) = self.frames else { return pictures };
        let framed = |picture: &Picture, frame: u32| Picture {
            name: joined(&picture.name, &format!("{:04}", frame + 1)),
            frame: Some(frame),
            ..picture.clone()
        };
        pictures
            .iter()
            .flat_map(|picture| (0..frames).map(|frame| framed(picture, frame)).collect::<Vec<_>>())
            .collect()
    }
}

fn joined(first: &str, second: &str) -> String {
    if first.is_empty() {
        second.to_owned()
    } else {
        format!("{first}-{second}")
    }
}

/// An image of a batch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// The names of its entries.
    pub name: String,
    /// What is rendered, as arguments of `glossmith render`.
    pub arguments: Vec<String>,
    /// The frame of the turn, from 0.
    pub frame: Option<u32>,
}
