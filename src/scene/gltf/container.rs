//! The outer parts of a glTF file: GLB chunks, JSON, extensions, and the buffers and pictures beside it.

use std::fs;
use std::path::{Path, PathBuf};

use gltf::json;

use crate::scene::model::ModelError;

/// Extensions that change nothing here or are understood. Required ones beyond these are errors.
pub(super) const UNDERSTOOD: [&str; 12] = [
    "KHR_texture_transform",
    "KHR_mesh_quantization",
    "KHR_materials_clearcoat",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_emissive_strength",
    "KHR_materials_specular",
    "KHR_materials_volume",
    "KHR_materials_variants",
    "KHR_materials_unlit",
    "KHR_lights_punctual",
    "FB_ngon_encoding",
];

const REMEDIES: [(&str, &str); 7] = [
    ("KHR_draco_mesh_compression", "export without Draco mesh compression"),
    (
        "EXT_meshopt_compression",
        "export without meshopt compression (gltfpack without -c)",
    ),
    (
        "KHR_meshopt_compression",
        "export without meshopt compression (gltfpack without -c)",
    ),
    ("KHR_texture_basisu", "export textures as PNG or JPEG instead of KTX2"),
    ("EXT_texture_webp", "export textures as PNG or JPEG instead of WebP"),
    ("EXT_texture_avif", "export textures as PNG or JPEG instead of AVIF"),
    ("MSFT_texture_dds", "export textures as PNG or JPEG instead of DDS"),
];

fn remedy(extension: &str) -> &'static str {
    let known = REMEDIES.iter().find(|(name, _)| *name == extension);
    known.map_or("export without this extension", |(_, remedy)| remedy)
}

/// A file whose JSON is valid, with its buffers.
pub(super) struct Document {
    path: PathBuf,
    /// The JSON; every index in it is in range.
    pub root: json::Root,
    /// The JSON once more, for what the crate does not know.
    pub raw: serde_json::Value,
    /// The contents of the buffers, each at least as long as declared.
    pub buffers: Vec<Vec<u8>>,
}

impl Document {
    /// Reads a file with its buffers; its pictures are read when asked for.
    pub fn read(path: &Path) -> Result<Self, ModelError> {
        let bytes = fs::read(path).map_err(|source| ModelError::Read {
            path: path.to_owned(),
            source,
        })?;
        let (text, blob) = split(path, &bytes)?;
        let mut document = Self {
            path: path.to_owned(),
            root: parse(path, text)?,
            raw: parse(path, text)?,
            buffers: Vec::new(),
        };
        document.check_version()?;
        document.check_extensions()?;
        document.validate()?;
        document.read_buffers(blob)?;
        Ok(document)
    }

    /// An error about the contents.
    pub fn invalid(&self, reason: impl Into<String>) -> ModelError {
        ModelError::Invalid {
            path: self.path.clone(),
            reason: reason.into(),
        }
    }

    /// An error about something that the file refers to.
    pub fn resource(&self, resource: &str, reason: impl ToString) -> ModelError {
        ModelError::Resource {
            path: self.path.clone(),
            resource: resource.to_owned(),
            reason: reason.to_string(),
        }
    }

    fn check_version(&self) -> Result<(), ModelError> {
        match self.root.asset.version.split('.').next() {
            Some("2") => Ok(()),
            _ => {
                let reason = format!("it is of glTF version {}", self.root.asset.version);
                Err(ModelError::NotGltf {
                    path: self.path.clone(),
                    reason,
                })
            }
        }
    }

    fn check_extensions(&mut self) -> Result<(), ModelError> {
        let unsupported = |name: &str| ModelError::Extension {
            path: self.path.clone(),
            name: name.to_owned(),
            remedy: remedy(name),
        };
        // Of several the one whose remedy is known says most.
        let mut required: Vec<&String> = self
            .root
            .extensions_required
            .iter()
            .filter(|name| !UNDERSTOOD.contains(&name.as_str()))
            .collect();
        required.sort_by_key(|name| !REMEDIES.iter().any(|(known, _)| known == name));
        if let Some(name) = required.first() {
            return Err(unsupported(name));
        }
        // Checked here; the crate knows fewer.
        self.root.extensions_required.clear();
        // A texture whose picture is there in a foreign format only.
        if let Some(texture) = self
            .root
            .textures
            .iter()
            .position(|texture| texture.source.value() == u32::MAX as usize)
        {
            let used = &self.root.extensions_used;
            let format = REMEDIES
                .iter()
                .find(|(name, _)| name.contains("_texture_") && used.iter().any(|u| u == name));
            return Err(format.map_or_else(
                || self.invalid(format!("texture {texture} has no picture")),
                |(name, _)| unsupported(name),
            ));
        }
        Ok(())
    }

    /// Lets the crate check indices and enumerations.
    fn validate(&mut self) -> Result<(), ModelError> {
        // The crate's own check of primitives looks up their positions without asking whether they are there.
        let accessors = self.root.accessors.len();
        let mut primitives = self.root.meshes.iter().flat_map(|mesh| &mesh.primitives);
        if primitives.any(|primitive| {
            primitive
                .attributes
                .values()
                .any(|accessor| accessor.value() >= accessors)
        }) {
            return Err(self.invalid(format!("a mesh refers to an accessor beyond the {accessors} there are")));
        }
        match gltf::Document::from_json(std::mem::take(&mut self.root)) {
            Ok(document) => {
                self.root = document.into_json();
                Ok(())
            }
            Err(gltf::Error::Validation(errors)) => {
                let first: Vec<String> = errors
                    .iter()
                    .take(3)
                    .map(|(path, error)| format!("{path}: {error}"))
                    .collect();
                let more = if errors.len() > 3 {
                    format!(" and {} more", errors.len() - 3)
                } else {
                    String::new()
                };
                Err(self.invalid(format!("{}{more}", first.join("; "))))
            }
            Err(error) => Err(self.invalid(error.to_string())),
        }
    }

    fn read_buffers(&mut self, mut blob: Option<&[u8]>) -> Result<(), ModelError> {
        for (index, buffer) in self.root.buffers.iter().enumerate() {
            let name = format!("buffer {index}");
            let data = match (&buffer.uri, blob.take()) {
                (Some(uri), _) => self.read_uri(&name, uri)?,
                (None, Some(blob)) => blob.to_vec(),
                (None, None) => return Err(self.invalid(format!("{name} has no data"))),
            };
            if (data.len() as u64) < buffer.byte_length.0 {
                let (actual, expected) = (data.len(), buffer.byte_length.0);
                return Err(self.invalid(format!("{name} has only {actual} of {expected} bytes")));
            }
            self.buffers.push(data);
        }
        Ok(())
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
        let file = percent_decoded(uri);
        let folder = self.path.parent().unwrap_or(Path::new(""));
        fs::read(folder.join(&file)).map_err(|error| self.resource(&file, error))
    }

    /// The bytes of a buffer view.
    pub fn view(&self, index: usize) -> Result<&[u8], ModelError> {
        let beyond = || self.invalid(format!("buffer view {index} reaches beyond its buffer"));
        let view = self.root.buffer_views.get(index).ok_or_else(beyond)?;
        let start = view.byte_offset.map_or(0, |offset| offset.0);
        let end = start.checked_add(view.byte_length.0).ok_or_else(beyond)?;
        self.buffers[view.buffer.value()]
            .get(start as usize..end as usize)
            .ok_or_else(beyond)
    }
}

/// The JSON and the binary chunk of a file's bytes.
fn split<'a>(path: &Path, bytes: &'a [u8]) -> Result<(&'a [u8], Option<&'a [u8]>), ModelError> {
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
    let invalid = |reason: String| ModelError::Invalid {
        path: path.to_owned(),
        reason,
    };
    match bytes.get(..length as usize) {
        _ if version != 2 => Err(not_gltf(format!("it is of GLB version {version}"))),
        None => Err(cut(u64::from(length))),
        Some(_) if length < 20 => Err(invalid(format!("a GLB length of {length} bytes"))),
        Some(whole) => split_chunks(whole).ok_or_else(|| invalid("its GLB chunks do not fit its length".to_owned())),
    }
}

/// The JSON chunk and, if there is one, the binary chunk after it.
fn split_chunks(glb: &[u8]) -> Option<(&[u8], Option<&[u8]>)> {
    let (kind, json, rest) = next_chunk(glb.get(12..)?)?;
    if kind != *b"JSON" {
        return None;
    }
    match next_chunk(rest) {
        Some((kind, data, _)) => Some((json, (kind == *b"BIN\0").then_some(data))),
        // Some writers leave a few bytes after the last chunk.
        None => (rest.len() < 8).then_some((json, None)),
    }
}

/// The kind and the data of the first chunk, and what follows it.
fn next_chunk(bytes: &[u8]) -> Option<([u8; 4], &[u8], &[u8])> {
    let (head, tail) = bytes.split_at_checked(8)?;
    let [a, b, c, d, kind @ ..] = <[u8; 8]>::try_from(head).ok()?;
    let (data, rest) = tail.split_at_checked(u32::from_le_bytes([a, b, c, d]) as usize)?;
    let padding = data.len().next_multiple_of(4) - data.len();
    Some((kind, data, rest.get(padding..).unwrap_or_default()))
}

fn parse<T: serde::de::DeserializeOwned>(path: &Path, text: &[u8]) -> Result<T, ModelError> {
    serde_json::from_slice(text).map_err(|error| {
        let reason = if error.is_eof() {
            "its JSON is cut short".to_owned()
        } else {
            format!("its JSON: {error}")
        };
        ModelError::Invalid {
            path: path.to_owned(),
            reason,
        }
    })
}

/// A relative URI as a file name: %20 is a space, and so on.
fn percent_decoded(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        let code = (*first == b'%').then(|| tail.get(..2)).flatten();
        let code = code.and_then(|digits| u8::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok());
        bytes.push(code.unwrap_or(*first));
        rest = if code.is_some() { &tail[2..] } else { tail };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
