//! Container of a glTF file: GLB chunks, JSON, extensions, and the buffers and images beside it.

use std::borrow::Cow;
use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use gltf::json;
use json::validation::Validate as _;
use percent_encoding::percent_decode_str;
use serde::Deserialize as _;
use serde_json::Value as Json;

use super::json::Plain;
use crate::files::{Files, text_or_latin_1};
use crate::model_error::ModelError;
use crate::scene::report::{Fate, ImportReport};

/// The extensions of buffer views and buffers.
pub(super) const MESHOPT_EXTENSIONS: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];
/// Extensions that are supported or irrelevant.
const UNDERSTOOD: [&str; 33] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "FB_ngon_encoding",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_coat",
    "KHR_materials_diffuse_roughness",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_fuzz",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
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

/// Extensions with a texture's image, preferred first.
const TEXTURE_SOURCES: [&str; 4] = [
    "EXT_texture_webp",
    "KHR_texture_basisu",
    "EXT_texture_avif",
    "MSFT_texture_dds",
];

/// A file whose JSON can be read, with its buffers.
pub(super) struct Document {
    path: PathBuf,
    /// The files beside it, and who waits.
    pub files: Files,
    /// The JSON. Its indices may be out of range.
    pub root: json::Root,
    /// Raw JSON, for data unknown to the crate; without `extras`.
    pub raw: Json,
    /// Contents of the buffers; empty if missing.
    pub buffers: Vec<Vec<u8>>,
    /// Buffer views that were compressed, as they are without.
    pub decompressed: HashMap<usize, Vec<u8>>,
    /// Required extensions that are not known.
    pub unknown_required: Vec<String>,
    /// Whether bytes of a buffer are missing.
    pub lacks_data: bool,
}

impl Document {
    /// Reads a file with its buffers; images are read on demand.
    pub fn read(path: &Path, files: Files, mut bytes: Vec<u8>, report: &mut ImportReport) -> Result<Self, ModelError> {
        let (text, blob) = split(path, &bytes)?;
        let mut raw = parse(path, text)?;
        check_version(path, &raw)?;
        complete(&mut raw);
        let mut document = Self {
            path: path.to_owned(),
            files,
            root: root(&mut raw).map_err(|error| ModelError::Invalid {
                path: path.to_owned(),
                reason: format!("its JSON: {error}"),
            })?,
            raw,
            buffers: Vec::new(),
            decompressed: HashMap::new(),
            unknown_required: Vec::new(),
            lacks_data: false,
        };
        // The rest of a large file's bytes would be there twice.
        let blob = blob.map(|place| {
            bytes.truncate(place.end);
            bytes.drain(..place.start);
            bytes
        });
        document.check_extensions(report);
        document.choose_pictures();
        document.check_rules(report);
        document.read_buffers(blob, report);
        Ok(document)
    }

    /// An error about the contents.
    pub fn invalid(&self, reason: impl ToString) -> ModelError {
        ModelError::invalid(&self.path, reason)
    }

    /// An error about something that the file refers to.
    pub fn resource(&self, resource: &str, reason: impl ToString) -> ModelError {
        ModelError::Resource {
            path: self.path.clone(),
            resource: resource.to_owned(),
            reason: reason.to_string(),
        }
    }

    /// An extension of a material, mesh or other part of the file, given by the way to it.
    pub fn extension(&self, part: &Json, name: &str) -> Option<Json> {
        part.get("extensions")?.get(name).cloned()
    }

    /// Reports unknown extensions: their effects are not shown.
    fn check_extensions(&mut self, report: &mut ImportReport) {
        let is_known = |name: &String| UNDERSTOOD.contains(&name.as_str());
        let required = std::mem::take(&mut self.root.extensions_required);
        for name in required.iter().filter(|name| !is_known(name)) {
            report.note(
                Fate::Ignored,
                format!("the extension {name}, which the file requires"),
                "",
            );
            self.unknown_required.push(name.clone());
        }
        let used = self.root.extensions_used.iter();
        for name in used.filter(|name| !is_known(name) && !required.contains(name)) {
            report.note(Fate::Ignored, format!("the optional extension {name}"), "");
        }
    }

    /// Sets the image of textures whose image is in an extension.
    fn choose_pictures(&mut self) {
        let images = self.root.images.len();
        for (index, texture) in self.root.textures.iter_mut().enumerate() {
            if texture.source.value() < images {
                continue;
            }
            let extensions = &self.raw["textures"][index]["extensions"];
            let source = TEXTURE_SOURCES
                .iter()
                .find_map(|name| extensions.get(name)?.get("source")?.as_u64());
            if let Some(source) = source {
                texture.source = json::Index::new(source as u32);
            }
        }
    }

    /// Validates the file with the crate. Few rules matter here: every index is checked at its use.
    fn check_rules(&mut self, report: &mut ImportReport) {
        // The crate's check of primitives does not verify that their positions exist.
        let accessors = self.root.accessors.len();
        let mut primitives = self.root.meshes.iter().flat_map(|mesh| &mesh.primitives);
        if primitives.any(|primitive| {
            primitive
                .attributes
                .values()
                .any(|accessor| accessor.value() >= accessors)
        }) {
            let what = format!("a reference of a mesh to an accessor beyond the {accessors} there are");
            report.note(Fate::Ignored, what, "");
            return;
        }
        let mut on_error = |path: &dyn Fn() -> json::Path, error: json::validation::Error| {
            let path = path().to_string();
            // A texture's image may be in an extension.
            let is_sourceless = path.ends_with("].source") && error == json::validation::Error::Missing;
            if !is_sourceless && !is_harmless(&path) {
                report.note(Fate::Ignored, format!("a breach of the format's rules, {error}"), &path);
            }
        };
        self.root.validate(&self.root, json::Path::new, &mut on_error);
    }

    fn read_buffers(&mut self, mut blob: Option<Vec<u8>>, report: &mut ImportReport) {
        let mut lacks_data = false;
        for (index, buffer) in self.root.buffers.iter().enumerate() {
            let name = format!("buffer {index}");
            let mut note = |what: String| {
                report.note(Fate::Missing, what, &name);
                lacks_data = true;
            };
            let is_fallback = MESHOPT_EXTENSIONS
                .iter()
                .any(|extension| self.raw["buffers"][index]["extensions"][extension]["fallback"] == true);
            let data = match (&buffer.uri, blob.take()) {
                (Some(uri), _) => self.read_uri(&name, uri).unwrap_or_else(|error| {
                    note(format!("a buffer: {error}"));
                    Vec::new()
                }),
                (None, Some(blob)) => blob,
                _ => {
                    if !is_fallback {
                        note("a buffer that has no data".to_owned());
                    }
                    Vec::new()
                }
            };
            let (actual, expected) = (data.len(), buffer.byte_length.0);
            if !data.is_empty() && (actual as u64) < expected {
                note(format!("a buffer's end: {actual} of {expected} bytes are there"));
            }
            self.buffers.push(data);
        }
        self.lacks_data = lacks_data;
    }

    /// The bytes of a data URI or of a file beside the model.
    pub fn read_uri(&self, name: &str, uri: &str) -> Result<Vec<u8>, ModelError> {
        if uri.starts_with("data:") {
            let data = gltf::buffer::Data::from_source(gltf::buffer::Source::Uri(uri), None);
            return data.map(|data| data.0).map_err(|error| self.resource(name, error));
        }
        if uri.contains("://") {
            return Err(self.resource(uri, "web addresses are not loaded"));
        }
        let file = Cow::from(percent_decode_str(uri));
        let file = text_or_latin_1(&file);
        self.files.read(&file).map_err(|error| self.resource(&file, error))
    }

    /// The bytes of a buffer view.
    pub fn view(&self, index: usize) -> Result<Cow<'_, [u8]>, ModelError> {
        if let Some(bytes) = self.decompressed.get(&index) {
            return Ok(Cow::Borrowed(bytes));
        }
        let beyond = || self.invalid(format!("buffer view {index} reaches beyond its buffer"));
        let view = self.root.buffer_views.get(index).ok_or_else(beyond)?;
        let start = view.byte_offset.map_or(0, |offset| offset.0);
        self.slice(view.buffer.value(), start, view.byte_length.0)
            .map(Cow::Borrowed)
            .ok_or_else(beyond)
    }

    /// A range of a buffer, if present.
    pub fn slice(&self, buffer: usize, start: u64, length: u64) -> Option<&[u8]> {
        let end = usize::try_from(start.checked_add(length)?).ok()?;
        self.buffers.get(buffer)?.get(usize::try_from(start).ok()?..end)
    }
}

/// The JSON for the crate, which requires integers without a decimal point.
fn root(raw: &mut Json) -> serde_json::Result<json::Root> {
    json::Root::deserialize(&*raw).or_else(|_| {
        without_points(raw);
        json::Root::deserialize(&*raw)
    })
}

/// Adds data that the crate requires and the format leaves optional. Without any nodes, meshes get one each.
fn complete(raw: &mut Json) {
    for scene in parts(raw, "scenes").filter_map(Json::as_object_mut) {
        scene.entry("nodes").or_insert_with(|| serde_json::json!([]));
    }
    for camera in parts(raw, "cameras").filter_map(Json::as_object_mut) {
        let kind = if camera.contains_key("orthographic") {
            "orthographic"
        } else {
            "perspective"
        };
        camera.entry("type").or_insert_with(|| serde_json::json!(kind));
    }
    let variants = raw.pointer_mut("/extensions/KHR_materials_variants/variants");
    let variants = variants.and_then(Json::as_array_mut).into_iter().flatten();
    for (index, variant) in variants.enumerate() {
        if let Some(variant) = variant.as_object_mut() {
            variant
                .entry("name")
                .or_insert_with(|| format!("variant {index}").into());
        }
    }
    for animation in parts(raw, "animations") {
        if let Some(animation) = animation.as_object_mut() {
            for list in ["channels", "samplers"] {
                animation.entry(list).or_insert_with(|| serde_json::json!([]));
            }
        }
        if let Some(channels) = animation.get_mut("channels").and_then(Json::as_array_mut) {
            // Target of an extension, or none.
            channels.retain(|channel| !channel["target"].is_object() || channel["target"].get("node").is_some());
        }
    }
    let meshes = raw["meshes"].as_array().map_or(0, Vec::len);
    if raw["nodes"].as_array().is_none_or(Vec::is_empty) && meshes > 0 && raw.is_object() {
        raw["nodes"] = (0..meshes).map(|mesh| serde_json::json!({ "mesh": mesh })).collect();
        raw["scenes"] = serde_json::json!([{ "nodes": (0..meshes).collect::<Vec<_>>() }]);
        raw["scene"] = serde_json::json!(0);
    }
}

/// Elements of a list in an object; empty without the list.
fn parts<'a>(of: &'a mut Json, name: &str) -> impl Iterator<Item = &'a mut Json> {
    of.get_mut(name).and_then(Json::as_array_mut).into_iter().flatten()
}

/// Writes whole numbers that have a point without it.
fn without_points(value: &mut Json) {
    match value {
        Json::Array(values) => values.iter_mut().for_each(without_points),
        Json::Object(values) => values.values_mut().for_each(without_points),
        Json::Number(number) if number.is_f64() => {
            let whole = number.as_f64().filter(|x| x.fract() == 0.0 && x.abs() < 2f64.powi(53));
            // A negative zero would lose its sign.
            if let Some(whole) = whole.filter(|x| *x != 0.0 || x.is_sign_positive()) {
                *number = (whole as i64).into();
            }
        }
        _ => {}
    }
}

/// Whether a violation at this JSON path does not affect the image.
fn is_harmless(place: &str) -> bool {
    let ends = [
        ".bufferView",
        ".min",
        ".max",
        ".target",
        ".byteStride",
        ".byteLength",
        ".generator",
    ];
    ends.iter().any(|end| place.ends_with(end)) || place.starts_with("animations") || place.contains("extensions")
}

/// Refuses files of other versions, whose JSON is another.
fn check_version(path: &Path, raw: &Json) -> Result<(), ModelError> {
    let version = raw["asset"]["version"].as_str().unwrap_or_default();
    if version.split('.').next() != Some("2") {
        let reason = match version {
            "" => "it names no version of glTF".to_owned(),
            version => format!("it is of glTF version {version}"),
        };
        return Err(ModelError::NotGltf {
            path: path.to_owned(),
            reason,
        });
    }
    Ok(())
}

/// The JSON in a file's bytes, and its binary chunk.
fn split<'a>(path: &Path, bytes: &'a [u8]) -> Result<(&'a [u8], Option<Range<usize>>), ModelError> {
    let not_gltf = |reason: String| ModelError::NotGltf {
        path: path.to_owned(),
        reason,
    };
    if !bytes.starts_with(b"glTF") {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        return match text.iter().find(|byte| !byte.is_ascii_whitespace()) {
            Some(b'{') => Ok((text, None)),
            None => Err(not_gltf("the file is empty".to_owned())),
            Some(_) if std::str::from_utf8(bytes).is_ok() => Err(not_gltf("it is some other text".to_owned())),
            Some(_) => Err(not_gltf("it begins with neither \"glTF\" nor JSON".to_owned())),
        };
    }
    let number = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let cut = |expected: u64| ModelError::Truncated {
        path: path.to_owned(),
        expected,
        actual: bytes.len() as u64,
    };
    let (Some(version), Some(length)) = (number(4), number(8)) else {
        return Err(cut(20));
    };
    let invalid = |reason: String| ModelError::invalid(path, reason);
    match bytes.get(..length as usize) {
        _ if version != 2 => Err(not_gltf(format!("it is of GLB version {version}"))),
        None => Err(cut(u64::from(length))),
        Some(_) if length < 20 => Err(invalid(format!("a GLB length of {length} bytes"))),
        Some(whole) => split_chunks(whole).ok_or_else(|| invalid("its GLB chunks do not fit its length".to_owned())),
    }
}

/// The JSON chunk and, if there is one, the place of the binary chunk after it.
fn split_chunks(glb: &[u8]) -> Option<(&[u8], Option<Range<usize>>)> {
    let (kind, json, rest) = next_chunk(glb.get(12..)?)?;
    if kind != *b"JSON" {
        return None;
    }
    let padding = json.len().next_multiple_of(4) - json.len();
    let binary = |skipped: usize| match next_chunk(rest.get(skipped..)?)? {
        (kind, data, _) if kind == *b"BIN\0" => {
            let start = glb.len() - rest.len() + skipped + 8;
            Some(start..start + data.len())
        }
        _ => None,
    };
    // Some writers do not begin chunks at multiples of four bytes.
    if let Some(place) = binary(padding).or_else(|| binary(0)) {
        return Some((json, Some(place)));
    }
    let padded = rest.get(padding..).unwrap_or_default();
    // Some leave a few bytes after the last chunk.
    (padded.len() < 8 || next_chunk(padded).is_some()).then_some((json, None))
}

/// Kind and data of the first chunk, and the remaining bytes.
fn next_chunk(bytes: &[u8]) -> Option<([u8; 4], &[u8], &[u8])> {
    let (head, tail) = bytes.split_at_checked(8)?;
    let [a, b, c, d, kind @ ..] = <[u8; 8]>::try_from(head).ok()?;
    let (data, rest) = tail.split_at_checked(u32::from_le_bytes([a, b, c, d]) as usize)?;
    Some((kind, data, rest))
}

/// The JSON of a text.
fn parse(path: &Path, text: &[u8]) -> Result<Json, ModelError> {
    let read = serde_json::from_slice(text);
    read.map(|Plain(json)| json).map_err(|error| {
        let reason = if error.is_eof() {
            "its JSON is cut short".to_owned()
        } else {
            format!("its JSON: {error}")
        };
        ModelError::invalid(path, reason)
    })
}
