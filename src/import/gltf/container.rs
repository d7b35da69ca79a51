//! Container of a glTF file: GLB chunks, JSON, extensions, and the buffers and images beside it.

use std::{borrow::Cow, collections::HashMap, fmt::Display, iter::successors, ops::Range, path::Path, path::PathBuf};

use percent_encoding::percent_decode_str;
use serde::Deserialize;

use super::json::{AnyVersion, Root, Texture};
use super::material::GLTF_PARAMETERS;
use crate::{
    files::{Files, text_or_latin_1, u32_at},
    model_error::ModelError,
    scene::report::{Fate, ImportReport},
};

/// The extensions of buffer views and buffers.
pub const MESHOPT_EXTENSIONS: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];
/// Extensions that are supported or irrelevant, beside those of materials.
const UNDERSTOOD: [&str; 17] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "FB_ngon_encoding",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_variants",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "EXT_texture_avif",
    "MSFT_texture_dds",
    "MSFT_lod",
];

/// Extensions with a texture's image: one that stands before the format's own, and others, preferred first.
const WEBP: &str = "EXT_texture_webp";
const TEXTURE_SOURCES: [&str; 3] = ["KHR_texture_basisu", "EXT_texture_avif", "MSFT_texture_dds"];

/// A file whose JSON can be read, with its buffers.
pub struct Document {
    pub path: PathBuf,
    /// The files beside it, and who waits.
    pub files: Files,
    pub root: Root,
    /// Contents of the buffers; empty if missing.
    pub buffers: Vec<Vec<u8>>,
    /// Buffer views that were compressed, as they are without.
    pub decompressed: HashMap<usize, Vec<u8>>,
    /// Whether bytes of a buffer are missing.
    pub lacks_data: bool,
}

impl Document {
    /// Reads a file with its buffers; images are read on demand.
    pub fn read(path: &Path, files: Files, mut bytes: Vec<u8>, report: &mut ImportReport) -> Result<Self, ModelError> {
        let (text, blob) = split(path, &bytes)?;
        // The JSON of other versions is another.
        let version = parse::<AnyVersion>(path, text)?.asset.version;
        if version.split('.').next() != Some("2") {
            let reason = match version.as_str() {
                "" => "it names no version of glTF".to_owned(),
                version => format!("it is of glTF version {version}"),
            };
            return Err(not_gltf(path, reason));
        }
        let mut document = Self {
            path: path.to_owned(),
            files,
            root: parse(path, text)?,
            buffers: Vec::new(),
            decompressed: HashMap::new(),
            lacks_data: false,
        };
        // The rest of a large file's bytes would be there twice.
        let blob = blob.map(|place| {
            bytes.truncate(place.end);
            bytes.drain(..place.start);
            bytes
        });
        document.report_extensions(report);
        document.read_buffers(blob, report);
        Ok(document)
    }

    /// An error about the contents.
    pub fn invalid(&self, reason: impl Display) -> ModelError {
        ModelError::invalid(&self.path, reason)
    }

    /// Extensions that the file requires, and that are not known.
    pub fn unknown_required(&self) -> impl Iterator<Item = &String> {
        self.root.extensions_required.iter().filter(is_unknown)
    }

    /// Reports unknown extensions: their effects are not shown.
    fn report_extensions(&self, report: &mut ImportReport) {
        for name in self.unknown_required() {
            let what = format!("the extension {name}, which the file requires");
            report.note(Fate::Ignored, what, "");
        }
        let optional = |name: &&String| is_unknown(name) && !self.root.extensions_required.contains(name);
        for name in self.root.extensions_used.iter().filter(optional) {
            report.note(Fate::Ignored, format!("the optional extension {name}"), "");
        }
    }

    fn read_buffers(&mut self, mut blob: Option<Vec<u8>>, report: &mut ImportReport) {
        for (index, buffer) in self.root.buffers.iter().enumerate() {
            let name = format!("buffer {index}");
            let is_fallback = MESHOPT_EXTENSIONS
                .iter()
                .any(|extension| buffer.extensions[extension]["fallback"] == true);
            let data = match (&buffer.uri, blob.take()) {
                (Some(uri), _) => self.read_uri(uri).map_err(|error| format!("a buffer: {error}")),
                (None, Some(blob)) => Ok(blob),
                _ if is_fallback => Ok(Vec::new()),
                _ => Err("a buffer that has no data".to_owned()),
            };
            let mut note = |what: String| {
                report.note(Fate::Missing, what, &name);
                self.lacks_data = true;
            };
            let data = data.unwrap_or_else(|what| {
                note(what);
                Vec::new()
            });
            let (actual, expected) = (data.len(), buffer.byte_length);
            if !data.is_empty() && (actual as u64) < expected {
                note(format!("a buffer's end: {actual} of {expected} bytes are there"));
            }
            self.buffers.push(data);
        }
    }

    /// The bytes of a data URI or of a file beside the model.
    pub fn read_uri(&self, uri: &str) -> Result<Vec<u8>, String> {
        if let Some(data) = uri.strip_prefix("data:") {
            let (kind, data) = data.split_once(',').ok_or("a data URI without a comma")?;
            let bytes = Cow::from(percent_decode_str(data));
            return match kind.to_ascii_lowercase().ends_with(";base64") {
                true => base64::decode(bytes).map_err(|error| error.to_string()),
                false => Ok(bytes.into_owned()),
            };
        }
        if uri.contains("://") {
            return Err(format!(
                "{uri}: web addresses are not loaded; put it beside the model or export as .glb"
            ));
        }
        let file = Cow::from(percent_decode_str(uri));
        let file = text_or_latin_1(&file);
        self.files.read(&file).map_err(|error| format!("{file}: {error}"))
    }

    /// The image of a texture, which may stand in an extension: WebP before the format's own image, the others after it,
    /// since not all of them can be read.
    pub fn image_of(&self, texture: &Texture) -> Option<usize> {
        let of_extension = |name: &&str| Some(texture.extensions[name]["source"].as_u64()? as usize);
        let first = of_extension(&WEBP);
        let others = TEXTURE_SOURCES.iter().filter_map(of_extension);
        let mut all = first.into_iter().chain(texture.source).chain(others);
        all.find(|image| *image < self.root.images.len())
    }

    /// The bytes of a buffer view.
    pub fn view(&self, index: usize) -> Result<Cow<'_, [u8]>, String> {
        if let Some(bytes) = self.decompressed.get(&index) {
            return Ok(Cow::Borrowed(bytes));
        }
        let view = self.root.buffer_views.get(index);
        let bytes = view.and_then(|view| self.slice(view.buffer, view.byte_offset, view.byte_length));
        let bytes = bytes.ok_or_else(|| format!("buffer view {index} reaches beyond its buffer"))?;
        Ok(Cow::Borrowed(bytes))
    }

    /// A range of a buffer, if present.
    pub fn slice(&self, buffer: usize, start: usize, length: usize) -> Option<&[u8]> {
        self.buffers.get(buffer)?.get(start..start.checked_add(length)?)
    }
}

fn is_unknown(extension: &&String) -> bool {
    let mut places = GLTF_PARAMETERS.iter().map(|row| row.place);
    let is_of_materials = places.any(|place| place.split('/').nth(2) == Some(extension));
    !is_of_materials && !UNDERSTOOD.contains(&extension.as_str())
}

fn not_gltf(path: &Path, reason: impl Display) -> ModelError {
    let what = format_args!("not a glTF 2.0 file ({reason}); export the model as .glb or .gltf");
    ModelError::refused(path, what)
}

/// The JSON in a file's bytes, and the place of its binary chunk.
fn split<'a>(path: &Path, bytes: &'a [u8]) -> Result<(&'a [u8], Option<Range<usize>>), ModelError> {
    if !bytes.starts_with(b"glTF") {
        let text = bare(bytes);
        return match text.iter().find(|byte| !byte.is_ascii_whitespace()) {
            Some(b'{') => Ok((text, None)),
            None => Err(not_gltf(path, "the file is empty")),
            Some(_) if std::str::from_utf8(bytes).is_ok() => Err(not_gltf(path, "it is some other text")),
            Some(_) => Err(not_gltf(path, "it begins with neither \"glTF\" nor JSON")),
        };
    }
    let number = |at| u32_at(bytes, at);
    let (version, length) = (number(4).unwrap_or(2), number(8).unwrap_or(12) as usize);
    if version != 2 {
        return Err(not_gltf(path, format!("it is of GLB version {version}")));
    }
    let glb = bytes.get(..length.max(12)).ok_or_else(|| {
        let actual = bytes.len();
        let what = format_args!("cut short: {actual} bytes of {length}; copy or download the file again");
        ModelError::refused(path, what)
    })?;
    let chunk = |start: usize| {
        let place = start + 8..start + 8 + number(start)? as usize;
        (place.end <= length).then_some((glb.get(start + 4..start + 8)?, place))
    };
    let mut chunks = successors(chunk(12), |(_, place)| chunk(place.end));
    let json = chunks.next().filter(|(kind, _)| *kind == b"JSON");
    let (_, json) = json.ok_or_else(|| ModelError::invalid(path, "its GLB chunks do not fit its length"))?;
    let binary = chunks.find(|(kind, _)| *kind == b"BIN\0");
    Ok((bare(&glb[json]), binary.map(|(_, place)| place)))
}

/// JSON without a byte order mark, and without the NULs that some programs fill a chunk with.
fn bare(text: &[u8]) -> &[u8] {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let end = text.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
    &text[..end]
}

fn parse<'de, T: Deserialize<'de>>(path: &Path, text: &'de [u8]) -> Result<T, ModelError> {
    serde_json::from_slice(text).map_err(|error| match error.is_eof() {
        true => ModelError::invalid(path, "its JSON is cut short"),
        false => ModelError::invalid(path, format!("its JSON: {error}")),
    })
}
