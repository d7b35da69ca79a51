//! A model's triangles over its own mesh and the instances of its repeated meshes.

use std::borrow::Cow;

use super::{mesh::Mesh, model::Model, transform::transformed};

impl Model {
    /// Number of triangles, those of all instances included.
    pub fn triangle_count(&self) -> usize {
        let repeated = self
            .instances
            .iter()
            .map(|instance| self.repeated[instance.mesh].triangles.len());
        self.mesh.triangles.len() + repeated.sum::<usize>()
    }

    /// The mesh followed by all instances, each moved to its place: takes the memory that instances save.
    pub fn whole_mesh(&self) -> Cow<'_, Mesh> {
        if self.instances.is_empty() {
            return Cow::Borrowed(&self.mesh);
        }
        let mut whole = self.mesh.clone();
        for instance in &self.instances {
            whole.append(transformed(
                self.repeated[instance.mesh].clone(),
                instance.world_from_mesh,
            ));
        }
        Cow::Owned(whole)
    }

    /// The meshes that are in memory.
    pub fn meshes(&self) -> impl Iterator<Item = &Mesh> {
        [&self.mesh].into_iter().chain(&self.repeated)
    }

    /// The number of the object that a triangle of the mesh belongs to.
    pub fn object_of(&self, triangle: usize) -> Option<usize> {
        let object = self.objects.partition_point(|object| object.triangles.end <= triangle);
        self.objects
            .get(object)
            .is_some_and(|found| found.triangles.contains(&triangle))
            .then_some(object)
    }

    /// The slots whose materials an object shows, each once.
    pub fn slots_of(&self, object: usize) -> Vec<usize> {
        let triangles = self.objects.get(object).map(|object| object.triangles.clone());
        let own = self.mesh.slots.get(triangles.unwrap_or_default()).unwrap_or_default();
        let mut meshes: Vec<usize> = self
            .instances
            .iter()
            .filter(|instance| instance.object == object)
            .map(|instance| instance.mesh)
            .collect();
        meshes.sort_unstable();
        meshes.dedup();
        let repeated = meshes.into_iter().flat_map(|mesh| &self.repeated[mesh].slots);
        let mut slots: Vec<usize> = own.iter().chain(repeated).map(|slot| *slot as usize).collect();
        slots.sort_unstable();
        slots.dedup();
        slots
    }
}
