//! The meshes of a scene's nodes joined into a model, those of many nodes as instances.

use glam::{DMat3, DMat4, DVec3};

use crate::scene::mesh::{Mesh, MeshInstance};
use crate::scene::transform::transformed;
use crate::scene::{Model, ModelObject};

/// More vertices than this are refused, so that indices of 32 bits suffice with the ground and split vertices added.
pub(crate) const MAX_VERTICES: usize = 1 << 31;
/// More vertices than this are not made by repeating meshes: a small file could ask for any amount of memory.
pub(crate) const MAX_REPEATED_VERTICES: usize = 1 << 25;
/// From this many triangles of all its nodes on, a mesh is kept once, with instances. Fewer are traced faster one by one.
const INSTANCED_TRIANGLES: usize = 1 << 18;
/// Smallest volume that a transform makes of a cube as long as its longest image, so that it can be inverted.
const VOLUME_MIN: f64 = 1e-6;

/// A mesh that has been read.
#[derive(Clone)]
pub(crate) enum UsedMesh {
    /// Not yet among the repeated meshes.
    Own(Mesh),
    /// Index among the repeated meshes.
    Repeated(usize),
}

/// The model so far.
#[derive(Default)]
pub(crate) struct Assembly {
    pub model: Model,
    /// Vertices of all nodes.
    pub vertices: usize,
    /// The node of the last object.
    last_node: Option<usize>,
}

impl Assembly {
    pub fn mesh<'a>(&'a self, used: &'a UsedMesh) -> &'a Mesh {
        match used {
            UsedMesh::Own(mesh) => mesh,
            UsedMesh::Repeated(index) => &self.model.repeated[*index],
        }
    }

    /// Begins the object of a node. Instances of a node come one after the other: they are one object.
    pub fn object(&mut self, node: usize, name: String) {
        if self.last_node.replace(node) != Some(node) {
            let end = self.model.mesh.triangles.len();
            let triangles = end..end;
            self.model.objects.push(ModelObject { name, triangles });
        }
    }

    /// Adds a mesh to the last object. Returns it for the nodes to come.
    pub fn add(&mut self, used: UsedMesh, world_from_mesh: DMat4, uses_left: usize) -> Option<UsedMesh> {
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
