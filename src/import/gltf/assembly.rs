//! The meshes of a scene's nodes joined into a model.

use glam::{DMat3, DMat4, DVec3};

use super::container::Document;
use super::material::Materials;
use super::nodes::{MeshNode, node_name};
use super::pose::Pose;
use super::primitive::{Bending, read_mesh};
use crate::model_error::ModelError;
use crate::scene::mesh::{Mesh, MeshInstance};
use crate::scene::report::{Fate, ImportReport};
use crate::scene::transform::transformed;
use crate::scene::{Model, ModelObject};

/// More vertices than this are refused, so that indices of 32 bits suffice with the ground and split vertices added.
const MAX_VERTICES: usize = 1 << 31;
/// More vertices than this are not made by repeating meshes: a small file could ask for any amount of memory.
const MAX_REPEATED_VERTICES: usize = 1 << 25;
/// From this many triangles of all its nodes on, a mesh is kept once, with instances. Fewer are traced faster one by one.
const INSTANCED_TRIANGLES: usize = 1 << 18;
/// Smallest volume that a transform makes of a cube as long as its longest image, so that it can be inverted.
const VOLUME_MIN: f64 = 1e-6;

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

/// A mesh that has been read.
#[derive(Clone)]
enum UsedMesh {
    /// Not yet among the repeated meshes.
    Own(Mesh),
    /// Index among the repeated meshes.
    Repeated(usize),
}

/// The model so far.
#[derive(Default)]
struct Assembly {
    model: Model,
    /// Vertices of all nodes.
    vertices: usize,
    /// The node of the last object.
    last_node: Option<usize>,
}

impl Assembly {
    fn mesh<'a>(&'a self, used: &'a UsedMesh) -> &'a Mesh {
        match used {
            UsedMesh::Own(mesh) => mesh,
            UsedMesh::Repeated(index) => &self.model.repeated[*index],
        }
    }

    /// Begins the object of a node. Instances of a node come one after the other: they are one object.
    fn object(&mut self, node: usize, name: String) {
        if self.last_node.replace(node) != Some(node) {
            let end = self.model.mesh.triangles.len();
            let triangles = end..end;
            self.model.objects.push(ModelObject { name, triangles });
        }
    }

    /// Adds a mesh to the last object. Returns it for the nodes to come.
    fn add(&mut self, used: UsedMesh, world_from_mesh: DMat4, uses_left: usize) -> Option<UsedMesh> {
        let used = match used {
            UsedMesh::Own(mesh) if uses_left > 0 && (uses_left + 1) * mesh.triangles.len() >= INSTANCED_TRIANGLES => {
                self.model.repeated.push(mesh);
                UsedMesh::Repeated(self.model.repeated.len() - 1)
            }
            used => used,
        };
        if let UsedMesh::Repeated(mesh) = used
            && can_be_inverted(world_from_mesh)
        {
            self.model.instances.push(MeshInstance {
                mesh,
                world_from_mesh,
                object: self.model.objects.len() - 1,
            });
            return Some(used);
        }
        let (mesh, kept) = match used {
            UsedMesh::Own(mesh) if uses_left == 0 => (mesh, None),
            used => (self.mesh(&used).clone(), Some(used)),
        };
        self.model.mesh.append(transformed(mesh, world_from_mesh));
        if let Some(object) = self.model.objects.last_mut() {
            object.triangles.end = self.model.mesh.triangles.len();
        }
        kept
    }
}

/// Whether a transform is finite and far from flat, so that rays can be moved back by it.
fn can_be_inverted(transform: DMat4) -> bool {
    let linear = DMat3::from_mat4(transform);
    let longest = linear.to_cols_array_2d().map(|axis| DVec3::from(axis).length());
    let longest = longest.into_iter().fold(0.0, f64::max);
    transform.is_finite() && linear.determinant().abs() > VOLUME_MIN * longest.powi(3)
}
