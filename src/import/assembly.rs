//! The meshes of a scene's nodes joined into a model, those of many nodes as instances; cameras and lights at nodes.

use std::{collections::HashMap, hash::Hash, path::Path};

use glam::{DMat3, DMat4, DVec3};

use crate::{
    model_error::ModelError,
    scene::{
        LightKind, Loading, Model, ModelCamera, ModelLens, ModelLight, ModelObject,
        mesh::{Mesh, MeshInstance},
        report::{Fate, ImportReport},
        transform::transformed,
    },
};

/// More vertices than this are refused, so that indices of 32 bits suffice with the ground and split vertices added.
const MAX_VERTICES: usize = 1 << 31;
/// More vertices than this are not made by repeating meshes: a small file could ask for any amount of memory.
const MAX_REPEATED_VERTICES: usize = 1 << 25;
/// From this many triangles of all its nodes on, a mesh is kept once, with instances. Fewer are traced faster one by one.
const INSTANCED_TRIANGLES: usize = 1 << 18;
/// Smallest volume that a transform makes of a cube as long as its longest image, so that it can be inverted.
const VOLUME_MIN: f64 = 1e-6;

/// A mesh that has been read.
#[derive(Clone)]
enum UsedMesh {
    /// Not yet among the repeated meshes.
    Own(Mesh),
    /// Index among the repeated meshes.
    Repeated(usize),
}

/// The model so far, of nodes that share a mesh where they have the same key.
pub struct Assembly<'a, K> {
    path: &'a Path,
    loading: &'a Loading,
    /// Nodes still to come with each mesh, and what was read of it for them.
    sources: HashMap<K, (usize, Option<UsedMesh>)>,
    model: Model,
    nodes: usize,
    placed: usize,
    left_out: usize,
    /// Vertices of all nodes.
    vertices: usize,
    /// The node of the last object.
    last_node: Option<usize>,
}

impl<'a, K: Hash + Eq> Assembly<'a, K> {
    /// An empty one for nodes with these keys.
    pub fn new(path: &'a Path, loading: &'a Loading, keys: impl Iterator<Item = K>) -> Self {
        let mut sources: HashMap<K, (usize, Option<UsedMesh>)> = HashMap::new();
        let mut nodes = 0;
        for key in keys {
            sources.entry(key).or_default().0 += 1;
            nodes += 1;
        }
        Self {
            path,
            loading,
            sources,
            model: Model::default(),
            nodes,
            placed: 0,
            left_out: 0,
            vertices: 0,
            last_node: None,
        }
    }

    /// Adds the mesh of a node, which is read where no node before had it. Instances of a node come one after the other: they are
    /// one object.
    pub fn place(
        &mut self,
        key: K,
        (node, name): (usize, &str),
        world_from_mesh: DMat4,
        read: impl FnOnce() -> Mesh,
    ) -> Result<(), ModelError> {
        self.placed += 1;
        self.loading.step(format!("mesh {} of {}", self.placed, self.nodes))?;
        let (uses_left, kept) = self.sources.remove(&key).unwrap_or_default();
        let uses_left = uses_left.saturating_sub(1);
        let is_first = kept.is_none();
        let used = kept.unwrap_or_else(|| UsedMesh::Own(read()));
        let vertices = self.vertices + self.mesh(&used).positions.len();
        if vertices > MAX_VERTICES {
            let what = format_args!("its scene has more than {MAX_VERTICES} vertices");
            return Err(ModelError::invalid(self.path, what));
        }
        if !is_first && vertices > MAX_REPEATED_VERTICES {
            self.left_out += 1;
            self.sources.insert(key, (uses_left, Some(used)));
            return Ok(());
        }
        self.vertices = vertices;
        if self.last_node.replace(node) != Some(node) {
            let end = self.model.mesh.triangles.len();
            let (name, triangles) = (name.to_owned(), end..end);
            self.model.objects.push(ModelObject { name, triangles });
        }
        let kept = self.add(used, world_from_mesh, uses_left);
        self.sources.insert(key, (uses_left, kept));
        Ok(())
    }

    /// The model of all that was added.
    pub fn finish(self, report: &mut ImportReport) -> Model {
        report.count(Fate::Used, "meshes", "", self.nodes - self.left_out);
        report.count(
            Fate::Ignored,
            "repeated meshes, too many for the memory",
            "",
            self.left_out,
        );
        self.model
    }

    fn mesh<'m>(&'m self, used: &'m UsedMesh) -> &'m Mesh {
        match used {
            UsedMesh::Own(mesh) => mesh,
            UsedMesh::Repeated(index) => &self.model.repeated[*index],
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

/// A camera that looks along −Z of its node, with +Y up.
pub fn camera_at(name: &str, world_from_node: DMat4, lens: ModelLens) -> Option<ModelCamera> {
    let forward = world_from_node.transform_vector3(DVec3::NEG_Z).try_normalize()?;
    let up = world_from_node
        .transform_vector3(DVec3::Y)
        .reject_from_normalized(forward);
    Some(ModelCamera {
        name: name.to_owned(),
        position: world_from_node.w_axis.truncate().to_array(),
        forward: forward.to_array(),
        up: up.try_normalize()?.to_array(),
        lens,
    })
}

/// A light that shines along a direction of its node.
pub fn light_at(
    (name, kind): (&str, LightKind),
    world_from_node: DMat4,
    direction: DVec3,
    (color, intensity): ([f32; 3], f32),
) -> Option<ModelLight> {
    Some(ModelLight {
        name: name.to_owned(),
        kind,
        position: world_from_node.w_axis.truncate().to_array(),
        forward: world_from_node.transform_vector3(direction).try_normalize()?.to_array(),
        color,
        intensity,
    })
}
