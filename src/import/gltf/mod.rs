//! glTF 2.0 files (.gltf and .glb): a scene in a pose, with its materials, cameras and lights.
//!
//! The gltf crate parses the JSON; buffers are read by [`accessor`], which checks every range before it reads, since a
//! damaged file must give an error and never a panic. Unreadable parts are left out, and the report says so: only
//! a file that leaves nothing to show is an error.

mod accessor;
mod anisotropy;
mod assembly;
mod compressed;
mod container;
mod draco;
mod image;
mod json;
mod material;
mod material_extensions;
mod nodes;
mod pose;
mod primitive;
mod sheen;
mod specular_glossiness;

use std::path::Path;

pub use self::anisotropy::{Widths, gltf_from_widths, widths_from_gltf};
pub use self::material::GLTF_PARAMETERS;
pub use self::material_extensions::kept_keys;

use self::assembly::assemble;
use self::container::Document;
use self::material::Materials;
use self::nodes::MeshNode;
use self::pose::Pose;
use crate::files::Files;
use crate::model_error::ModelError;
use crate::scene::report::{Entry, Fate, ImportReport};
use crate::scene::{Model, ModelOptions};

/// Loads the contents of a .gltf or .glb file; `path` is named in messages.
pub(super) fn load(path: &Path, files: Files, bytes: Vec<u8>, options: &ModelOptions) -> Result<Model, ModelError> {
    let mut report = ImportReport::default();
    let mut document = Document::read(path, files, bytes, &mut report)?;
    compressed::decompress_views(&mut document, &mut report);
    let pose = Pose::new(&document, options.time_s);
    let contents = nodes::contents(&document, &pose, options.scene, &mut report);
    let mut materials = Materials::new(&document, options);
    let assembled = assemble(&document, &pose, &contents.meshes, &mut materials, &mut report)?;
    if assembled.triangle_count() == 0 {
        return Err(nothing_to_show(&document, path, &contents.meshes, &report));
    }
    let (slots, textures) = materials.finish(&mut report);
    document.files.import.loading.check()?;
    Ok(Model {
        slots,
        textures,
        report,
        cameras: contents.cameras,
        lights: contents.lights,
        variants: materials_variants(&document),
        scenes: scene_names(&document),
        duration_s: duration_s(&document),
        ..assembled
    })
}

/// Reason for an empty scene: a missing part, or damaged triangles.
fn nothing_to_show(document: &Document, path: &Path, nodes: &[MeshNode], report: &ImportReport) -> ModelError {
    if let Some(name) = document.unknown_required.first() {
        return ModelError::Extension {
            path: path.to_owned(),
            name: name.clone(),
            remedy: "export without this extension",
        };
    }
    let has_triangles = nodes.iter().any(|node| primitive::has_triangles(document, node.mesh));
    let ignored = report.of(Fate::Ignored).filter(|_| has_triangles);
    let blamed = report.of(Fate::Missing).chain(ignored).take(3);
    let blamed: Vec<String> = blamed.map(Entry::line).collect();
    if blamed.is_empty() {
        return ModelError::NoTriangles { path: path.to_owned() };
    }
    let reason = blamed.join(", ");
    if document.lacks_data {
        return ModelError::Incomplete {
            path: path.to_owned(),
            reason,
        };
    }
    document.invalid(format!("no triangles in its scene; {reason}"))
}

fn materials_variants(document: &Document) -> Vec<String> {
    let variants = &document.raw["extensions"]["KHR_materials_variants"]["variants"];
    let variants = variants.as_array().map_or(&[][..], Vec::as_slice);
    let name = |(index, variant): (usize, &serde_json::Value)| {
        variant["name"]
            .as_str()
            .map_or_else(|| format!("variant {index}"), str::to_owned)
    };
    variants.iter().enumerate().map(name).collect()
}

fn scene_names(document: &Document) -> Vec<String> {
    let scenes = document.root.scenes.iter().enumerate();
    scenes
        .map(|(index, scene)| scene.name.clone().unwrap_or_else(|| format!("scene {index}")))
        .collect()
}

/// Length of the first animation in seconds; 0 without one.
fn duration_s(document: &Document) -> f32 {
    let samplers = document
        .root
        .animations
        .first()
        .map_or(&[][..], |animation| &animation.samplers);
    let last = |sampler: &gltf::json::animation::Sampler| {
        let times = document.read_vectors::<1>(sampler.input.value(), "times").ok()?;
        times.last().map(|time| time[0]).filter(|time| time.is_finite())
    };
    samplers.iter().filter_map(last).fold(0.0, f32::max)
}
