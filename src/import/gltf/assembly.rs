//! The meshes of a scene's nodes joined into a model.

use std::collections::HashSet;

use glam::DMat4;

use super::{
    container::Document,
    material::Materials,
    nodes::{MeshNode, node_name},
    pose::Pose,
    primitive::{Bending, read_mesh},
};
use crate::{assembly::Assembly, model_error::ModelError, scene::Model, scene::report::ImportReport};

/// Joins all meshes of a scene, with their objects.
pub fn assemble(
    document: &Document,
    pose: &Pose,
    nodes: &[MeshNode],
    materials: &mut Materials,
    report: &mut ImportReport,
) -> Result<Model, ModelError> {
    let root = &document.root;
    let is_bent = |node: usize| {
        let has_weight = pose.weights(document, node).iter().any(|weight| *weight != 0.0);
        root.nodes[node].skin.is_some() || has_weight
    };
    // Nodes share a mesh that none of them bends.
    let key = |node: &MeshNode| (node.mesh, is_bent(node.node).then_some(node.node));
    let loading = &document.files.import.loading;
    let mut assembly = Assembly::new(&document.path, loading, nodes.iter().map(key));
    let mut told = HashSet::new();
    for node in nodes {
        let joints = root.nodes[node.node].skin.and_then(|skin| pose.joints(document, skin));
        // Joints have already placed a skinned mesh.
        let world_from_mesh = match joints {
            Some(_) => DMat4::IDENTITY,
            None => node.world_from_node,
        };
        let read = || {
            let bending = Bending {
                weights: pose.weights(document, node.node),
                joints: joints.as_deref(),
            };
            let mut once = ImportReport::default();
            let mesh = read_mesh(document, node.mesh, bending, materials, &mut once);
            if told.insert(node.mesh) {
                report.append(once);
            }
            mesh
        };
        let name = node_name(root, node.node);
        assembly.place(key(node), (node.node, &name), world_from_mesh, read)?;
    }
    Ok(assembly.finish(report))
}
