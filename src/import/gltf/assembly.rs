//! The meshes of a scene's nodes joined into a model.

use glam::DMat4;

use super::container::Document;
use super::material::Materials;
use super::nodes::{MeshNode, node_name};
use super::pose::Pose;
use super::primitive::{Bending, read_mesh};
use crate::assembly::{Assembly, MAX_REPEATED_VERTICES, MAX_VERTICES, UsedMesh};
use crate::model_error::ModelError;
use crate::scene::Model;
use crate::scene::report::{Fate, ImportReport};

/// Joins all meshes of a scene, with their objects.
pub(super) fn assemble(
    document: &Document,
    pose: &Pose,
    nodes: &[MeshNode],
    materials: &mut Materials,
    report: &mut ImportReport,
) -> Result<Model, ModelError> {
    let mut sources = vec![Source::default(); document.root.meshes.len()];
    for node in nodes {
        if let Some(source) = sources.get_mut(node.mesh) {
            source.uses_left += 1;
        }
    }
    let mut assembly = Assembly::default();
    let mut left_out = 0;
    for (place, node) in nodes.iter().enumerate() {
        let loading = &document.files.import.loading;
        loading.step(format!("mesh {} of {}", place + 1, nodes.len()))?;
        let name = node_name(&document.root, node.node);
        let Some(source) = sources.get_mut(node.mesh) else {
            report.note(Fate::Missing, "a mesh that is out of bounds", &name);
            continue;
        };
        let is_first = !std::mem::replace(&mut source.is_used, true);
        let skin = document.root.nodes[node.node].skin;
        let weights = pose.weights(document, node.node);
        let joints = skin.and_then(|skin| pose.joints(document, skin));
        let is_bent = skin.is_some() || weights.iter().any(|weight| *weight != 0.0);
        let kept = if is_bent { None } else { source.mesh.take() };
        let mesh = kept.unwrap_or_else(|| {
            let bending = Bending {
                weights,
                joints: joints.as_deref(),
            };
            let mut once = ImportReport::default();
            let mesh = read_mesh(document, node.mesh, bending, materials, &mut once);
            if is_first {
                report.append(once);
            }
            UsedMesh::Own(mesh)
        });
        assembly.vertices += assembly.mesh(&mesh).positions.len();
        if assembly.vertices > MAX_VERTICES {
            return Err(document.invalid(format!("its scene has more than {MAX_VERTICES} vertices")));
        }
        source.uses_left -= 1;
        if !is_first && assembly.vertices > MAX_REPEATED_VERTICES {
            assembly.vertices -= assembly.mesh(&mesh).positions.len();
            left_out += 1;
            source.mesh = (!is_bent).then_some(mesh).or(source.mesh.take());
            continue;
        }
        assembly.object(node.node, name);
        // Joints have already placed a skinned mesh.
        let world_from_mesh = match joints {
            Some(_) => DMat4::IDENTITY,
            None => node.world_from_node,
        };
        let uses_left = if is_bent { 0 } else { source.uses_left };
        source.mesh = assembly.add(mesh, world_from_mesh, uses_left).or(source.mesh.take());
    }
    report.count(Fate::Used, "meshes", "", nodes.len() - left_out);
    report.count(Fate::Ignored, "repeated meshes, too many for the memory", "", left_out);
    Ok(assembly.model)
}

/// A mesh of the file.
#[derive(Clone, Default)]
struct Source {
    /// Nodes still to come.
    uses_left: usize,
    /// Whether a node had it.
    is_used: bool,
    /// What was read, for the next node.
    mesh: Option<UsedMesh>,
}
