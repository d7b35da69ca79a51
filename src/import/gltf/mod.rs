//! glTF 2.0 files (.gltf and .glb): a scene in a pose, with its materials, cameras and lights.
//!
//! Buffers are read by [`accessor`], which checks every range before it reads, since a damaged file must give an error and
//! never a panic. Unreadable parts are left out, and the report says so: only a file that leaves nothing to show is an error.

mod accessor;
mod anisotropy;
mod assembly;
mod compressed;
mod container;
mod json;
mod material;
mod nodes;
mod pose;
mod primitive;
mod specular_glossiness;

use std::path::Path;

use serde_json::Value as Json;

pub use self::{
    anisotropy::{Widths, gltf_from_widths, widths_from_gltf},
    material::{GLTF_PARAMETERS, kept_keys},
};

use self::{
    assembly::assemble,
    container::Document,
    json::{Curve, Root, Scene},
    material::Materials,
    pose::Pose,
};
use crate::{
    files::Files,
    model_error::ModelError,
    scene::{
        Model, ModelOptions,
        report::{Fate, ImportNote, ImportReport},
    },
};

/// Loads the contents of a .gltf or .glb file; `path` is named in messages.
pub fn load(path: &Path, files: Files, bytes: Vec<u8>, options: &ModelOptions) -> Result<Model, ModelError> {
    let mut report = ImportReport::default();
    let mut document = Document::read(path, files, bytes, &mut report)?;
    compressed::decompress_views(&mut document, &mut report);
    let pose = Pose::new(&document, options.time_s);
    let contents = nodes::contents(&document, &pose, options.scene, &mut report);
    let mut materials = Materials::new(&document, options);
    let assembled = assemble(&document, &pose, &contents.meshes, &mut materials, &mut report)?;
    if assembled.triangle_count() == 0 {
        return Err(nothing_to_show(&document, path, &report));
    }
    let (slots, textures) = materials.finish(&mut report);
    document.files.import.loading.check()?;
    let scenes = document.root.scenes.iter().enumerate();
    let scene = |(index, scene): (usize, &Scene)| scene.name.clone().unwrap_or_else(|| format!("scene {index}"));
    Ok(Model {
        slots,
        textures,
        report,
        cameras: contents.cameras,
        lights: contents.lights,
        variants: variants(&document.root),
        scenes: scenes.map(scene).collect(),
        duration_s: duration_s(&document),
        ..assembled
    })
}

/// Reason for an empty scene: a missing part, or damaged triangles.
fn nothing_to_show(document: &Document, path: &Path, report: &ImportReport) -> ModelError {
    if let Some(name) = document.unknown_required().next() {
        let what =
            format_args!("needs the glTF extension {name}, which is not supported; export without this extension");
        return ModelError::refused(path, what);
    }
    let blamed = report.of(Fate::Missing).chain(report.of(Fate::Ignored)).take(3);
    let blamed: Vec<String> = blamed.map(ImportNote::line).collect();
    let reason = blamed.join(", ");
    if blamed.is_empty() {
        ModelError::no_triangles(path)
    } else if document.lacks_data {
        let remedy = "put what is missing beside the model, or export as .glb";
        ModelError::refused(path, format_args!("nothing to show; {reason}; {remedy}"))
    } else {
        document.invalid(format_args!("no triangles in its scene; {reason}"))
    }
}

/// Names of the variants of its materials.
fn variants(root: &Root) -> Vec<String> {
    let variants = root.extensions["KHR_materials_variants"]["variants"].as_array();
    let name = |(index, variant): (usize, &Json)| {
        variant["name"]
            .as_str()
            .map_or_else(|| format!("variant {index}"), str::to_owned)
    };
    variants.into_iter().flatten().enumerate().map(name).collect()
}

/// Length of the first animation in seconds; 0 without one.
fn duration_s(document: &Document) -> f32 {
    let curves = document
        .root
        .animations
        .first()
        .map_or(&[][..], |animation| &animation.samplers);
    let last = |curve: &Curve| {
        let times = document.read_vectors::<1>(curve.input, "times").ok()?;
        times.last().map(|time| time[0]).filter(|time| time.is_finite())
    };
    curves.iter().filter_map(last).fold(0.0, f32::max)
}
