//! Materials in other programs' formats, there and back: one file a format, one line in a registry.
//!
//! None of them has the geometric lobe. What is written is the GGX that looks nearest ([`surface`]), a report says how far
//! off it is ([`report`]), and the exact parameters travel along where the format leaves room for them ([`carried`]).

mod blender;
pub mod carried;
mod gltf;
mod materialx;
mod measured;
mod mitsuba;
mod native;
pub mod report;
mod snippet;
pub mod surface;
mod table;
mod textures;
mod usd;
mod xml;

use std::path::{Path, PathBuf};

use self::report::{Entry, MaterialReport, Report};
use self::surface::{Surface, Takes};
use super::{FileError, Loaded, opened, opened::Opened, preset, replace::save_atomically};
use crate::{
    document::{Document, ImportLobe, MaterialSettings},
    import::{ModelError, endings::ending},
    named::joined,
    scene::{Loading, path_text::path_of_text},
};

pub use self::{materialx::SURFACES, materialx::SurfaceKind, snippet::Language};

/// What the files of a format have in them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Holds {
    /// Glossmith's own: materials and documents, as text.
    Documents,
    /// Materials of another program, as text, which fits a clipboard.
    Materials,
    /// A model with all its materials.
    Model,
    Measurement,
}

/// A line of the registry.
pub struct Registered {
    /// Name on the command line.
    pub name: &'static str,
    /// Name in the window.
    pub label: &'static str,
    /// Endings of its files, without the dot. What several formats share belongs to the first.
    pub extensions: &'static [&'static str],
    holds: Holds,
    write: fn(&Subject, &Path) -> Result<Written, ExchangeError>,
    /// None of a format that is only written.
    #[expect(clippy::type_complexity, reason = "a function")]
    read: Option<fn(&Path, ReadOptions) -> Result<Subject, ExchangeError>>,
    pub help: &'static str,
}

impl Registered {
    /// Whether files of it are read.
    pub fn is_read(&self) -> bool {
        self.read.is_some()
    }

    /// Whether its files are text, which fits a clipboard.
    pub fn is_text(&self) -> bool {
        matches!(self.holds, Holds::Documents | Holds::Materials)
    }

    /// Whether it takes a model with all its materials.
    pub fn takes_models(&self) -> bool {
        self.holds == Holds::Model
    }

    /// Whether its files hold materials of another program, and nothing else that is opened.
    pub fn is_material_alone(&self) -> bool {
        self.is_read() && self.holds == Holds::Materials
    }
}

impl std::fmt::Debug for Registered {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

macro_rules! registered {
    ($($name:literal $label:literal $extensions:expr, $holds:ident $write:expr, $read:expr, $help:literal;)*) => {
        &[$(Registered {
            name: $name,
            label: $label,
            extensions: &$extensions,
            holds: Holds::$holds,
            write: $write,
            read: $read,
            help: $help,
        },)*]
    };
}

/// Every format, in the order of the menus: name, label, endings, what it holds, how it is written and read, what it is.
pub static FORMATS: &[Registered] = registered! {
    "glossmith" "Glossmith" ["json", "png"], Documents native::write, Some(native::read),
        "Glossmith's own materials and projects; images with a document inside are read.";
    "materialx" "MaterialX, OpenPBR" ["mtlx"], Materials |subject, path| materialx::write(subject, path, false), Some(materialx::read),
        "MaterialX 1.39 with an OpenPBR surface.";
    "standard-surface" "MaterialX, Standard Surface" ["mtlx"], Materials |subject, path| materialx::write(subject, path, true), Some(materialx::read),
        "MaterialX 1.39 with a standard_surface.";
    "gltf" "glTF" ["glb", "gltf"], Model gltf::write, Some(gltf::read),
        "glTF 2.0: a project's model with its materials and textures, or a ball with the material.";
    "usd" "USD" ["usda"], Materials usd::write, Some(usd::read),
        "USD as text, with UsdPreviewSurface and an OpenPBR surface of MaterialX, which are read.";
    "mitsuba" "Mitsuba 3" ["xml"], Materials mitsuba::write, Some(carried::in_comments),
        "A scene for Mitsuba 3: a ball with the material. Read are the exact parameters alone.";
    "blender" "Blender" ["py"], Materials blender::write, Some(carried::in_comments),
        "A Python script that makes the material in Blender. Read are the exact parameters alone.";
    "merl" "MERL measurement" ["binary"], Measurement measured::write, None,
        "The whole reflectance in a table, as the MERL BRDF database has it.";
    "table" "Table of the lobe" ["csv"], Materials table::write, Some(carried::in_comments),
        "Values and densities of the lobe over directions. Read are the exact parameters alone.";
    "glsl" "Sampler in GLSL" ["glsl"], Materials |subject, path| Language::Glsl.write(subject, path), Some(carried::in_comments),
        "A function that samples the geometric lobe.";
    "wgsl" "Sampler in WGSL" ["wgsl"], Materials |subject, path| Language::Wgsl.write(subject, path), Some(carried::in_comments),
        "A function that samples the geometric lobe.";
    "hlsl" "Sampler in HLSL" ["hlsl"], Materials |subject, path| Language::Hlsl.write(subject, path), Some(carried::in_comments),
        "A function that samples the geometric lobe.";
    "osl" "Sampler in OSL" ["osl"], Materials |subject, path| Language::Osl.write(subject, path), Some(carried::in_comments),
        "A function that samples the geometric lobe.";
    "c" "Sampler in C" ["c", "h"], Materials |subject, path| Language::C.write(subject, path), Some(carried::in_comments),
        "A function that samples the geometric lobe.";
};

/// How files are read.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// Who hears which files were refused that the file names.
    pub loading: Loading,
    /// The lobe of materials that know only GGX.
    pub lobe: ImportLobe,
    /// Take what the file shows, though it also has the exact parameters.
    pub is_plain: bool,
}

/// What is written, or was read.
#[derive(Clone, Debug, Default)]
pub struct Subject {
    /// The materials, at least one.
    pub materials: Vec<MaterialSettings>,
    /// The document that they belong to, where there is one.
    pub document: Option<Box<Document>>,
    /// What was lost in reading, for each of the materials.
    pub losses: Vec<Vec<Entry>>,
}

/// A file to be written, and what became of the materials.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    pub bytes: Vec<u8>,
    /// Files beside it that it refers to, by their names.
    pub beside: Vec<(String, Vec<u8>)>,
    /// What became of each material.
    pub materials: Vec<MaterialReport>,
}

/// Why a material cannot be taken to or from another program.
#[derive(Debug, thiserror::Error)]
pub enum ExchangeError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Model(#[from] ModelError),
    /// An ending that no format has.
    #[error("{path}: no format has this ending; the formats are {known}")]
    Ending { path: PathBuf, known: String },
    /// A format that is only read.
    #[error("{path}: this format is only read; choose another ending")]
    NotWritten { path: PathBuf },
    /// A format that is only written.
    #[error(
        "{path}: this format is only written; `glossmith fit --target` finds a material that looks like a measurement"
    )]
    NotRead { path: PathBuf },
    /// A file of another program that Glossmith did not write.
    #[error(
        "{path}: has no exact parameters of Glossmith, which alone are read of this format; convert the material itself"
    )]
    NothingCarried { path: PathBuf },
    /// Not what the ending says.
    #[error("{path}: not a {format} document: {reason}; export it again")]
    Contents {
        path: PathBuf,
        format: &'static str,
        reason: String,
    },
    /// No material in it that can be shown.
    #[error("{path}: has no material that can be taken: {reason}")]
    NoMaterial { path: PathBuf, reason: String },
    /// Several where one has a place.
    #[error("{path}: holds one material, and there are {count}: {names}; choose one with --material")]
    Several { path: PathBuf, count: usize, names: String },
    /// A material that this format cannot hold.
    #[error("{path}: {reason}")]
    Unsuitable { path: PathBuf, reason: String },
}

impl Subject {
    pub fn of(material: MaterialSettings) -> Self {
        Self {
            materials: vec![material],
            ..Self::default()
        }
    }

    /// The only material.
    fn only(&self, path: &Path) -> Result<&MaterialSettings, ExchangeError> {
        match &self.materials[..] {
            [material] => Ok(material),
            several => Err(ExchangeError::Several {
                path: path.to_owned(),
                count: several.len(),
                names: joined(several.iter().map(|material| &material.name), ", "),
            }),
        }
    }
}

impl Written {
    fn text(text: String, materials: Vec<MaterialReport>) -> Self {
        Self {
            bytes: text.into_bytes(),
            beside: Vec::new(),
            materials,
        }
    }
}

/// A material as a format shows it, and what becomes of it there.
fn shown(material: &MaterialSettings, takes: &Takes) -> (Surface, MaterialReport) {
    let (surface, highlight) = Surface::of(material);
    let mut entries = vec![highlight];
    entries.extend(surface.losses(material, takes));
    entries.sort_by_key(|entry| std::cmp::Reverse(entry.outcome));
    let report = MaterialReport {
        material: material.name.clone(),
        carries_exact_parameters: true,
        entries,
        looks: Some(Box::new([material.clone(), surface.as_taken(material, takes)])),
        difference: None,
    };
    (surface, report)
}

/// The registered format of that name.
pub fn by_name(name: &str) -> Option<&'static Registered> {
    FORMATS.iter().find(|format| format.name == name)
}

/// The format of a file by its ending.
pub fn by_ending(path: &Path) -> Result<&'static Registered, ExchangeError> {
    let ending = ending(path);
    let found = FORMATS
        .iter()
        .find(|format| format.extensions.contains(&ending.as_str()));
    found.ok_or_else(|| {
        let endings = FORMATS.iter().flat_map(|format| format.extensions);
        let mut known: Vec<String> = endings.map(|ending| format!(".{ending}")).collect();
        known.dedup();
        ExchangeError::Ending {
            path: path.to_owned(),
            known: known.join(", "),
        }
    })
}

/// The endings of the files that are written for other programs.
pub fn endings_written() -> Vec<&'static str> {
    let written = FORMATS.iter().filter(|format| format.holds != Holds::Documents);
    let mut endings: Vec<&str> = written.flat_map(|format| format.extensions).copied().collect();
    endings.dedup();
    endings
}

/// Whether files of this ending hold materials of another program, and nothing else that is opened.
pub fn holds_materials(path: &Path) -> bool {
    by_ending(path).is_ok_and(Registered::is_material_alone)
}

/// What a file holds that is opened: one of ours, or the first material of another program's.
pub fn open(path: &Path, options: ReadOptions) -> Result<Opened, ExchangeError> {
    if !holds_materials(path) {
        return Ok(opened::open(path)?);
    }
    let subject = read(path, options)?;
    let Some(material) = subject.materials.first() else {
        return Err(ExchangeError::NoMaterial {
            path: path.to_owned(),
            reason: "it is empty".to_owned(),
        });
    };
    let mut warnings: Vec<String> = subject
        .losses
        .first()
        .into_iter()
        .flatten()
        .map(Entry::to_string)
        .collect();
    if subject.materials.len() > 1 {
        warnings.push(format!(
            "{} is taken; the others are {}: `glossmith convert --material` takes one of them out",
            material.name,
            joined(subject.materials[1..].iter().map(|other| &other.name), ", ")
        ));
    }
    let message = |warning: String| format!("{}: {warning}", path.display());
    Ok(Opened::Material(Box::new(Loaded {
        value: material.clone(),
        warnings: warnings.into_iter().map(message).collect(),
    })))
}

/// The material of a name: that of a shipped one, or of a file of any format.
pub fn find(name_or_path: &str, options: ReadOptions) -> Result<Loaded<MaterialSettings>, ExchangeError> {
    let path = &path_of_text(name_or_path);
    if holds_materials(path)
        && let Opened::Material(loaded) = open(path, options)?
    {
        return Ok(*loaded);
    }
    Ok(preset::find(name_or_path)?)
}

/// What a file holds.
pub fn read(path: &Path, options: ReadOptions) -> Result<Subject, ExchangeError> {
    match by_ending(path)?.read {
        Some(read) => read(path, options),
        None => Err(ExchangeError::NotRead { path: path.to_owned() }),
    }
}

/// A file that is made and not written yet, with what it loses.
#[derive(Clone, Debug, PartialEq)]
pub struct Prepared {
    written: Written,
    /// What becomes of the materials.
    pub report: Report,
}

impl Prepared {
    /// What the file holds, where that is text.
    pub fn text(&self) -> Option<&str> {
        std::str::from_utf8(&self.written.bytes).ok()
    }

    /// Writes the file, replacing it at once.
    pub fn save(&self) -> Result<(), FileError> {
        let path = &self.report.output;
        for (name, bytes) in &self.written.beside {
            save_atomically(&path.with_file_name(name), bytes)?;
        }
        save_atomically(path, &self.written.bytes)
    }
}

/// Makes the file of a subject and reports what becomes of it. `input` is only named in the report.
pub fn prepare(subject: &Subject, input: &str, path: &Path, format: &Registered) -> Result<Prepared, ExchangeError> {
    let mut written = (format.write)(subject, path)?;
    for (report, losses) in written.materials.iter_mut().zip(&subject.losses) {
        // What was lost before is not all there.
        report
            .entries
            .retain(|entry| losses.is_empty() || *entry != Entry::exact(report::EVERYTHING));
        report.entries.splice(0..0, losses.iter().cloned());
    }
    let report = Report {
        input: input.to_owned(),
        output: path.to_owned(),
        format: format.name,
        materials: written.materials.clone(),
    };
    Ok(Prepared { written, report })
}
