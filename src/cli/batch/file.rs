//! A batch's file: lists in TOML. What an entry sets are the options of `glossmith render` without their dashes; what is
//! named with dots is what `--set` takes.

use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail};
use clap::Parser;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::cli::scene::SceneArguments;
use crate::document::turntable::Turn;
use crate::named::Named as _;
use crate::render::output::format_of;
use crate::scene::path_text::path_text;

/// The lists, in the order in which images count through them, each with the option that a plain text stands for.
const LISTS: [(&str, Option<&str>); 5] = [
    ("models", Some("model")),
    ("materials", Some("material")),
    ("environments", Some("environment")),
    ("cameras", None),
    ("settings", None),
];
/// What else stands at the top of the file.
const OTHERS: [&str; 5] = ["common", "folder", "formats", "frames", "turn"];
/// Options whose values name files: these are looked for beside the batch's file first.
const FILES: [&str; 4] = ["model", "material", "environment", "project"];
/// Most frames of a turn.
const FRAMES: std::ops::RangeInclusive<i64> = 1..=9999;

/// The part of the arguments of `glossmith render` that an entry may set; of options given twice the last counts.
#[derive(Debug, Parser)]
#[command(no_binary_name = true, args_override_self = true, disable_help_flag = true)]
pub(super) struct Scene {
    #[command(flatten)]
    pub(super) arguments: SceneArguments,
}

impl Scene {
    /// The scene of arguments as they are written on the command line.
    pub(super) fn parse(arguments: &[String]) -> anyhow::Result<Self> {
        Self::try_parse_from(arguments).map_err(|error| {
            let message = error.render().to_string();
            let first = message.lines().next().unwrap_or_default();
            anyhow!("{}", first.trim_start_matches("error: "))
        })
    }
}

/// An entry of a list.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entry {
    /// Its part of the images' names.
    pub(super) name: String,
    /// What it sets, as arguments of `glossmith render`.
    pub(super) arguments: Vec<String>,
}

/// What a file says.
#[derive(Clone, Debug)]
pub(super) struct BatchFile {
    /// Where it is.
    pub(super) path: PathBuf,
    /// Where the images go.
    pub(super) folder: PathBuf,
    /// Endings of the files of each image.
    pub(super) formats: Vec<String>,
    /// What all images have in common, as arguments.
    pub(super) common: Vec<String>,
    /// The lists that are there.
    pub(super) lists: Vec<Vec<Entry>>,
    /// Frames of a whole turn; none where nothing turns.
    pub(super) frames: Option<u32>,
    /// What turns.
    pub(super) turn: Turn,
}

/// A file's text with its name, to say where something is.
struct Source<'a> {
    path: &'a Path,
    text: &'a str,
}

type Value<'a> = Spanned<DeValue<'a>>;

impl Source<'_> {
    /// What is wrong at a place.
    fn wrong(&self, at: std::ops::Range<usize>, reason: impl std::fmt::Display) -> anyhow::Error {
        let line = 1 + self.text[..at.start.min(self.text.len())].matches('\n').count();
        anyhow!("{}, line {line}: {reason}", self.path.display())
    }

    fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    fn text_of<'v>(&self, value: &'v Value<'_>, key: &str) -> anyhow::Result<&'v str> {
        let expected = || self.wrong(value.span(), format!("{key} is no text; put it in quotation marks"));
        value.get_ref().as_str().ok_or_else(expected)
    }

    /// A value as it is written behind an option.
    fn scalar(&self, value: &Value<'_>, key: &str) -> anyhow::Result<String> {
        Ok(match value.get_ref() {
            DeValue::String(text) => text.to_string(),
            DeValue::Integer(number) if number.radix() == 10 => number.as_str().to_owned(),
            DeValue::Float(number) => number.as_str().to_owned(),
            DeValue::Boolean(is_on) => is_on.to_string(),
            DeValue::Array(list) => {
                let parts: anyhow::Result<Vec<String>> = list.iter().map(|part| self.scalar(part, key)).collect();
                parts?.join(",")
            }
            _ => {
                return Err(self.wrong(
                    value.span(),
                    format!("{key} takes a text, a number, true or false, or a list of these"),
                ));
            }
        })
    }

    /// The options that a table sets, as arguments. `skipped` is no option.
    fn arguments(&self, table: &DeTable<'_>, skipped: Option<&str>) -> anyhow::Result<Vec<String>> {
        let mut arguments = Vec::new();
        for (key, value) in table {
            let name = key.get_ref().as_ref();
            if Some(name) == skipped {
                continue;
            }
            let before = arguments.len();
            match value.get_ref() {
                DeValue::Table(inner) => self.assignments(name, inner, &mut arguments)?,
                // Several of an option that may be repeated.
                DeValue::Array(list) if list.iter().all(|part| part.get_ref().is_str()) => {
                    for part in list {
                        arguments.push(self.option(name, part)?);
                    }
                }
                _ => arguments.push(self.option(name, value)?),
            }
            Scene::parse(&arguments[before..]).map_err(|reason| self.wrong(key.span(), reason))?;
        }
        Ok(arguments)
    }

    fn option(&self, name: &str, value: &Value<'_>) -> anyhow::Result<String> {
        let mut text = self.scalar(value, name)?;
        if FILES.contains(&name) {
            let beside = self.folder().join(&text);
            if beside.exists() {
                text = path_text(&beside).into_owned();
            }
        }
        // A project is what an image begins with.
        Ok(if name == "project" {
            text
        } else {
            format!("--{name}={text}")
        })
    }

    /// `specular.roughness = 0.2`, however deep.
    fn assignments(&self, path: &str, table: &DeTable<'_>, arguments: &mut Vec<String>) -> anyhow::Result<()> {
        for (key, value) in table {
            let path = format!("{path}.{}", key.get_ref());
            match value.get_ref() {
                DeValue::Table(inner) => self.assignments(&path, inner, arguments)?,
                _ => arguments.push(format!("--set={path}={}", self.scalar(value, &path)?)),
            }
        }
        Ok(())
    }

    /// An entry: a text, or a table with a name and options.
    fn entry(&self, value: &Value<'_>, list: &str, option: Option<&str>) -> anyhow::Result<Entry> {
        match (value.get_ref(), option) {
            (DeValue::String(text), Some(option)) => {
                let argument = self.option(option, value)?;
                Scene::parse(std::slice::from_ref(&argument)).map_err(|reason| self.wrong(value.span(), reason))?;
                let stem = Path::new(text.as_ref()).file_stem().unwrap_or_default();
                Ok(Entry {
                    name: plain(&stem.to_string_lossy()),
                    arguments: vec![argument],
                })
            }
            (DeValue::Table(table), _) => {
                let Some(name) = table.get("name") else {
                    return Err(self.wrong(
                        value.span(),
                        format!("this entry of {list} has no name; add name = \"…\""),
                    ));
                };
                Ok(Entry {
                    name: plain(self.text_of(name, "name")?),
                    arguments: self.arguments(table, Some("name"))?,
                })
            }
            (_, Some(_)) => Err(self.wrong(
                value.span(),
                format!("an entry of {list} is a text, or a table with a name and options"),
            )),
            (_, None) => Err(self.wrong(
                value.span(),
                format!("an entry of {list} is a table, such as {{ name = \"a\", samples = 64 }}"),
            )),
        }
    }

    fn list(&self, value: &Value<'_>, key: &str, option: Option<&str>) -> anyhow::Result<Vec<Entry>> {
        let Some(list) = value.get_ref().as_array().filter(|list| !list.is_empty()) else {
            return Err(self.wrong(
                value.span(),
                format!("{key} is no list with entries; write {key} = [ … ]"),
            ));
        };
        let mut entries: Vec<Entry> = Vec::new();
        for value in list {
            let entry = self.entry(value, key, option)?;
            if entries.iter().any(|other| other.name == entry.name) {
                let reason = format!(
                    "{key} has two entries of the name {}; give one another name",
                    entry.name
                );
                return Err(self.wrong(value.span(), reason));
            }
            entries.push(entry);
        }
        Ok(entries)
    }

    fn formats(&self, value: &Value<'_>) -> anyhow::Result<Vec<String>> {
        let Some(list) = value.get_ref().as_array().filter(|list| !list.is_empty()) else {
            return Err(self.wrong(value.span(), "formats is no list of endings; write formats = [\"png\"]"));
        };
        let mut formats = Vec::new();
        for value in list {
            let ending = self.text_of(value, "a format")?.trim_start_matches('.').to_owned();
            let example = PathBuf::from(format!("a.{ending}"));
            if format_of(&example).is_err() || formats.contains(&ending) {
                return Err(self.wrong(value.span(), "formats are png, exr and hdr, each once"));
            }
            formats.push(ending);
        }
        Ok(formats)
    }
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
    /// What the file at `path` says.
    ///
    /// # Errors
    /// What is wrong with it, and in which line.
    pub(super) fn read(path: &Path) -> anyhow::Result<Self> {
        let text = std::fs::read_to_string(path)
            .with_context(|| format!("{}: cannot be read; give a batch's file in TOML", path.display()))?;
        Self::parse(path, &text)
    }

    fn parse(path: &Path, text: &str) -> anyhow::Result<Self> {
        let source = Source { path, text };
        let table = DeTable::parse(text).map_err(|error| {
            let reason = format!("{}; correct the TOML there", error.message().replace('\n', ", "));
            source.wrong(error.span().unwrap_or_default(), reason)
        })?;
        let table = table.get_ref();
        for key in table.keys() {
            let name = key.get_ref().as_ref();
            if !LISTS.iter().any(|(list, _)| *list == name) && !OTHERS.contains(&name) {
                let lists = LISTS.map(|(list, _)| list).join(", ");
                let reason = format!(
                    "{name} is no part of a batch; the parts are {lists}, {}",
                    OTHERS.join(", ")
                );
                return Err(source.wrong(key.span(), reason));
            }
        }
        let mut file = Self {
            path: path.to_owned(),
            folder: source.folder().join("pictures"),
            formats: vec!["png".to_owned()],
            common: Vec::new(),
            lists: Vec::new(),
            frames: None,
            turn: Turn::default(),
        };
        for (key, option) in LISTS {
            if let Some(value) = table.get(key) {
                file.lists.push(source.list(value, key, option)?);
            }
        }
        if let Some(value) = table.get("common") {
            let Some(common) = value.get_ref().as_table() else {
                return Err(source.wrong(value.span(), "common is no table; write [common] and options below it"));
            };
            file.common = source.arguments(common, None)?;
        }
        if let Some(value) = table.get("folder") {
            file.folder = source.folder().join(source.text_of(value, "folder")?);
        }
        if let Some(value) = table.get("formats") {
            file.formats = source.formats(value)?;
        }
        if let Some(value) = table.get("frames") {
            let count = source
                .scalar(value, "frames")?
                .parse()
                .ok()
                .filter(|n| FRAMES.contains(n));
            let expected = || source.wrong(value.span(), "frames is no number from 1 to 9999");
            file.frames = Some(count.ok_or_else(expected)? as u32);
        }
        if let Some(value) = table.get("turn") {
            let turn = Turn::by_name(source.text_of(value, "turn")?);
            file.turn = turn.ok_or_else(|| source.wrong(value.span(), "turn is camera, model or light"))?;
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
    pub(super) fn pictures(&self) -> Vec<Picture> {
        let mut pictures = vec![Picture::default()];
        pictures[0].arguments = self.common.clone();
        for list in &self.lists {
            let with = |picture: &Picture, entry: &Entry| Picture {
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
pub(super) struct Picture {
    /// The names of its entries.
    pub(super) name: String,
    /// What is rendered, as arguments of `glossmith render`.
    pub(super) arguments: Vec<String>,
    /// The frame of the turn, from 0.
    pub(super) frame: Option<u32>,
}
