//! glTF 2.0 files (.gltf and .glb): a scene in a pose, with its materials, cameras and lights.
//!
//! The gltf crate parses the JSON; buffers are read by [`accessor`], which checks every range before it reads, since a
//! damaged file must give an error and never a panic. Whatever cannot be read is left out, and the report says so: only
//! a file that leaves nothing to show is an error.

mod accessor;
mod anisotropy;
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
mod specular_glossiness;
mod transform;

use std::path::Path;

use glam::DMat4;

pub use self::anisotropy::{Widths, gltf_from_widths, widths_from_gltf};
pub use self::material::GLTF_PARAMETERS;
pub use self::material_extensions::kept_keys;

use self::container::Document;
use self::material::Materials;
use self::nodes::MeshNode;
use self::pose::Pose;
use self::primitive::Bending;
use crate::files::Files;
use crate::model_error::ModelError;
use crate::scene::mesh::Mesh;
use crate::scene::report::{Fate, ImportReport};
use crate::scene::{Model, ModelObject, ModelOptions};

/// More vertices than this are refused, so that indices of 32 bits suffice with the ground and split vertices added.
const MAX_VERTICES: usize = 1 << 31;
/// More vertices than this are not made by repeating meshes: a small file could ask for any amount of memory.
const MAX_REPEATED_VERTICES: usize = 1 << 25;

/// Loads the contents of a .gltf or .glb file; `path` is named in messages.
pub(super) fn load(path: &Path, files: Files, bytes: Vec<u8>, options: &ModelOptions) -> Result<Model, ModelError> {
    let mut report = ImportReport::default();
    let mut document = Document::read(path, files, bytes, &mut report)?;
    compressed::decompress_views(&mut document, &mut report);
    let pose = Pose::new(&document, options.time_s);
    let contents = nodes::contents(&document, &pose, options.scene, &mut report);
    let mut materials = Materials::new(&document, options);
    let (mesh, objects) = assemble(&document, &pose, &contents.meshes, &mut materials, &mut report)?;
    if mesh.triangles.is_empty() {
        return Err(nothing_to_show(&document, path, &contents.meshes, &report));
    }
    let (slots, textures) = materials.finish(&mut report);
    document.files.import.loading.check()?;
    Ok(Model {
        mesh,
        slots,
        textures,
        objects,
        report,
        cameras: contents.cameras,
        lights: contents.lights,
        variants: materials_variants(&document),
        scenes: scene_names(&document),
        duration_s: duration_s(&document),
        ..Model::default()
    })
}

/// Joins all meshes of a scene.
fn assemble(
    document: &Document,
    pose: &Pose,
    nodes: &[MeshNode],
    materials: &mut Materials,
    report: &mut ImportReport,
) -> Result<(Mesh, Vec<ModelObject>), ModelError> {
    let mut kept: Vec<Option<Mesh>> = vec![None; document.root.meshes.len()];
    let mut is_first_use = vec![true; document.root.meshes.len()];
    let mut uses_left = vec![0_usize; document.root.meshes.len()];
    for node in nodes {
        if let Some(uses) = uses_left.get_mut(node.mesh) {
            *uses += 1;
        }
    }
    let mut whole = Mesh::default();
    let mut objects: Vec<ModelObject> = Vec::new();
    let mut last_node = None;
    let mut left_out = 0;
    for (place, node) in nodes.iter().enumerate() {
        document
            .files
            .import
            .loading
            .step(format!("mesh {} of {}", place + 1, nodes.len()))?;
        let name = nodes::node_name(&document.root, node.node);
        let Some(uses_left) = uses_left.get_mut(node.mesh) else {
            report.note(Fate::Missing, "a mesh that is out of bounds", &name);
            continue;
        };
        *uses_left -= 1;
        let is_first = std::mem::replace(&mut is_first_use[node.mesh], false);
        let skin = document.root.nodes[node.node].skin.map(|skin| skin.value());
        let weights = pose.weights(document, node.node);
        let is_bent = skin.is_some() || weights.iter().any(|weight| *weight != 0.0);
        let joints = skin.and_then(|skin| pose.joints(document, skin));
        let bending = Bending {
            weights,
            joints: joints.as_deref(),
        };
        let local = match kept[node.mesh].take() {
            Some(mesh) if !is_bent => mesh,
            _ => {
                let mut once = ImportReport::default();
                let mesh = primitive::read_mesh(document, node.mesh, bending, materials, &mut once);
                if is_first {
                    report.append(once);
                }
                mesh
            }
        };
        let vertices = whole.positions.len() + local.positions.len();
        if vertices > MAX_VERTICES {
            return Err(document.invalid(format!("its scene has more than {MAX_VERTICES} vertices")));
        }
        if !is_first && vertices > MAX_REPEATED_VERTICES {
            left_out += 1;
            continue;
        }
        // Joints have already placed a skinned mesh.
        let world_from_mesh = if joints.is_some() {
            DMat4::IDENTITY
        } else {
            node.world_from_node
        };
        if !is_bent && *uses_left > 0 {
            kept[node.mesh] = Some(local.clone());
        }
        let first = whole.triangles.len();
        whole.append(transform::transformed(local, world_from_mesh));
        let triangles = first..whole.triangles.len();
        match objects.last_mut() {
            // Instances of a node come one after the other: they are one object.
            Some(last) if last_node == Some(node.node) => last.triangles.end = triangles.end,
            _ => objects.push(ModelObject { name, triangles }),
        }
        last_node = Some(node.node);
    }
    report.count(Fate::Used, "meshes", "", nodes.len() - left_out);
    report.count(Fate::Ignored, "repeated meshes, too many for the memory", "", left_out);
    Ok((whole, objects))
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
    let blamed = [Fate::Missing, Fate::Ignored]
        .into_iter()
        .flat_map(|fate| report.of(fate));
    let has_triangles = nodes.iter().any(|node| primitive::has_triangles(document, node.mesh));
    let blamed: Vec<String> = blamed
        .filter(|entry| has_triangles || entry.fate == Fate::Missing)
        .filter(|entry| !entry.what.starts_with("points and lines"))
        .take(3)
        .map(|entry| entry.line())
        .collect();
    if blamed.is_empty() {
        return ModelError::NoTriangles { path: path.to_owned() };
    }
    let reason = blamed.join(", ");
    if report.of(Fate::Missing).any(|entry| entry.what.starts_with("a buffer")) {
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
