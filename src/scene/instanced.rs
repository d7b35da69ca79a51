//! Instances of meshes, ready to trace: each mesh once, with a hierarchy of its own, below a hierarchy over the instances.

use std::sync::OnceLock;

use fearless_simd::Level;
use glam::{DAffine3, DMat4, DQuat, DVec3};

use super::{
    coarse::leaning_areas,
    hierarchy::{Bottom, Hierarchy, Placement, Wide, triangle_of_box},
    intersect::{Hit, RayFrame},
    loading::{Cancelled, Loading},
    mesh::{Mesh, MeshInstance},
    part::{NO_OBJECT, Part, is_finite, is_traceable},
};
use crate::parallel;

/// Instances of repeated meshes. Their triangles are numbered instance by instance.
#[derive(Clone, Debug, Default)]
pub struct Instanced {
    meshes: Vec<Part>,
    /// The instances, in the order of the hierarchy's leaves.
    instances: Vec<Instance>,
    /// Hierarchy over the boxes of the instances.
    top: Hierarchy,
    triangle_count: usize,
    /// See [`Instanced::whole`].
    whole: OnceLock<Whole>,
}

/// A mesh at its place, in the geometry's units.
#[derive(Clone, Debug)]
pub struct Instance {
    mesh: usize,
    pub object: u32,
    /// The first of its triangles.
    first: u32,
    pub placement: Placement,
    /// Lowest and highest corner.
    bounds: [[f32; 3]; 2],
}

/// A model's triangles and those of its instances, one by one.
#[derive(Clone, Debug)]
pub struct Whole {
    pub part: Part,
    /// Number of each triangle of `part`: the model's own first, then the instances'.
    pub numbers: Vec<u32>,
}

impl Whole {
    /// Place of each triangle in the GPU's order, by its number.
    pub fn places(&self) -> Vec<u32> {
        let mut places = vec![0; self.numbers.len()];
        for (place, &triangle) in (0..).zip(&self.part.compressed().triangles) {
            places[self.numbers[triangle as usize] as usize] = place;
        }
        places
    }
}

/// The traceable triangles of a repeated mesh.
pub struct Traceable {
    /// Their vertices, each once.
    pub places: Vec<DVec3>,
    pub count: usize,
    /// Number of triangles with a corner that is not finite.
    pub not_finite: usize,
}

impl Traceable {
    pub fn of(mesh: &Mesh) -> Self {
        let mut is_used = vec![false; mesh.positions.len()];
        let (mut count, mut not_finite) = (0, 0);
        for (triangle, vertices) in mesh.triangles.iter().enumerate() {
            let corners = mesh.corners(triangle);
            not_finite += usize::from(!is_finite(&corners));
            if is_traceable(corners) {
                count += 1;
                for vertex in vertices {
                    is_used[*vertex as usize] = true;
                }
            }
        }
        let used = mesh.positions.iter().zip(is_used).filter(|(_, is_used)| *is_used);
        Self {
            places: used.map(|(place, _)| *place).collect(),
            count,
            not_finite,
        }
    }

    /// The traceable triangles of each mesh.
    pub fn of_meshes(meshes: &[Mesh]) -> Vec<Self> {
        parallel::map_each(meshes, Self::of)
    }
}

/// A repeated mesh in units of its bounding radius, about its centre.
struct Prepared {
    part: Part,
    mesh_from_units: DAffine3,
    /// Triangles that lost their area by rounding.
    closed: usize,
}

impl Prepared {
    fn new(mesh: &Mesh, traceable: &Traceable, loading: &Loading) -> Result<Self, Cancelled> {
        let places = || traceable.places.iter().copied();
        let [low, high] = [places().reduce(DVec3::min), places().reduce(DVec3::max)].map(Option::unwrap_or_default);
        let center = low.midpoint(high);
        let radius = places().map(|place| place.distance(center)).fold(0.0, f64::max);
        let radius = if radius > 0.0 { radius } else { 1.0 };
        let mut part = Part::default();
        let chosen = (0..mesh.triangles.len()).filter(|triangle| is_traceable(mesh.corners(*triangle)));
        let to_units = |place: DVec3| ((place - center) / radius).as_vec3().to_array();
        let closed = part.add(mesh, loading.while_wanted(chosen), |_| NO_OBJECT, to_units);
        part.build(loading)?;
        Ok(Self {
            part,
            mesh_from_units: DAffine3::from_scale_rotation_translation(DVec3::splat(radius), DQuat::IDENTITY, center),
            closed,
        })
    }

    /// An instance of the mesh, not yet numbered.
    fn at(&self, instance: &MeshInstance, units_from_world: DMat4) -> Instance {
        let units_from_mesh = DAffine3::from_mat4(units_from_world * instance.world_from_mesh);
        let placement = Placement::new(units_from_mesh * self.mesh_from_units);
        let mut bounds = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
        for &place in &self.part.positions {
            for (axis, coordinate) in placement.point(place).into_iter().enumerate() {
                bounds[0][axis] = bounds[0][axis].min(coordinate);
                bounds[1][axis] = bounds[1][axis].max(coordinate);
            }
        }
        Instance {
            mesh: instance.mesh,
            object: instance.object as u32,
            first: 0,
            placement,
            bounds,
        }
    }
}

impl Instanced {
    /// The instances of meshes without those of `hidden` objects. Also returns how many of all their triangles lost their
    /// area by rounding.
    pub fn new(
        (repeated, all): (&[Mesh], &[MeshInstance]),
        traceable: &[Traceable],
        hidden: &[usize],
        units_from_world: DMat4,
        loading: &Loading,
    ) -> Result<(Self, usize), Cancelled> {
        let meshes = repeated.iter().zip(traceable);
        let prepared: Vec<Prepared> = meshes
            .map(|(mesh, traceable)| Prepared::new(mesh, traceable, loading))
            .collect::<Result<_, _>>()?;
        let closed = all.iter().map(|instance| prepared[instance.mesh].closed).sum();
        let is_shown =
            |instance: &&MeshInstance| !hidden.contains(&instance.object) && !prepared[instance.mesh].part.is_empty();
        let shown: Vec<&MeshInstance> = all.iter().filter(is_shown).collect();
        let placed = parallel::map_each(&shown, |instance| {
            prepared[instance.mesh].at(instance, units_from_world)
        });
        let corners = |instance: u32| triangle_of_box(placed[instance as usize].bounds);
        let (top, order) = Hierarchy::new(placed.len(), corners, loading)?;
        let mut instances: Vec<Instance> = order.iter().map(|&place| placed[place as usize].clone()).collect();
        let mut triangle_count = 0;
        for instance in &mut instances {
            instance.first = triangle_count as u32;
            triangle_count += prepared[instance.mesh].part.triangles.len();
        }
        let instanced = Self {
            meshes: prepared.into_iter().map(|prepared| prepared.part).collect(),
            instances,
            top,
            triangle_count,
            whole: OnceLock::new(),
        };
        Ok((instanced, closed))
    }

    /// True without instances.
    pub fn is_empty(&self) -> bool {
        self.instances.is_empty()
    }

    /// Number of triangles of all instances.
    pub fn triangle_count(&self) -> usize {
        self.triangle_count
    }

    /// Memory in bytes, with the hierarchies built so far.
    pub fn bytes(&self) -> usize {
        self.meshes.iter().map(Part::bytes).sum::<usize>()
            + size_of_val(&self.instances[..])
            + self.top.bytes()
            + self
                .whole
                .get()
                .map_or(0, |whole| whole.part.bytes() + size_of_val(&whole.numbers[..]))
    }

    /// Builds the CPU's hierarchies. Returns their memory in bytes.
    pub fn prepare(&self) -> usize {
        self.meshes.iter().map(|part| part.wide().bytes()).sum::<usize>() + self.top().bytes()
    }

    /// Twice the area of all triangles, and of those that are coarse; see [`leaning_areas`].
    pub fn leaning_areas(&self) -> [f64; 2] {
        let of_meshes: Vec<[f64; 2]> = self.meshes.iter().map(leaning_areas).collect();
        let placed = self.instances.iter().map(|instance| {
            let scale = instance.placement.area_scale();
            of_meshes[instance.mesh].map(|area| area * scale)
        });
        placed.fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d])
    }

    fn top(&self) -> &Wide {
        self.top
            .wide(|instance| triangle_of_box(self.instances[instance as usize].bounds))
    }

    fn bottom(&self, instance: u32) -> Bottom<'_> {
        let instance = &self.instances[instance as usize];
        Bottom {
            wide: self.meshes[instance.mesh].wide(),
            placement: &instance.placement,
            first: instance.first,
        }
    }

    /// The closest hit with 0 < t < `t_max`, or any.
    #[inline(never)]
    pub fn hit<const ANY: bool>(&self, level: Level, frame: &RayFrame, t_max: f32) -> Option<Hit> {
        self.top()
            .hit_below::<ANY>(level, frame, t_max, |instance| self.bottom(instance))
    }

    /// The mesh of a triangle, its number there, and its instance.
    #[inline(never)]
    pub fn find(&self, triangle: usize) -> (&Part, usize, Option<&Instance>) {
        let after = self
            .instances
            .partition_point(|instance| instance.first as usize <= triangle);
        let instance = &self.instances[after - 1];
        (
            &self.meshes[instance.mesh],
            triangle - instance.first as usize,
            Some(instance),
        )
    }

    /// The slots of all triangles in order.
    pub fn slots(&self) -> impl Iterator<Item = u32> {
        self.instances
            .iter()
            .flat_map(|instance| self.meshes[instance.mesh].slots.iter().copied())
    }

    /// The model's own triangles and those of all instances, made on first use: as the GPU has them.
    pub fn whole(&self, model: &Part) -> &Whole {
        self.whole.get_or_init(|| {
            let mut part = model.without_hierarchy();
            for instance in &self.instances {
                self.append(instance, &mut part);
            }
            let numbers = part.build(&Loading::default()).expect("nobody cancels it");
            Whole { part, numbers }
        })
    }

    /// Number of triangles that [`Instanced::whole`] has yet to copy.
    pub fn triangles_to_copy(&self) -> usize {
        self.whole.get().map_or(self.triangle_count, |_| 0)
    }

    /// Appends the triangles of an instance.
    fn append(&self, instance: &Instance, to: &mut Part) {
        let (mesh, placement) = (&self.meshes[instance.mesh], &instance.placement);
        let base = to.positions.len() as u32;
        to.positions
            .extend(mesh.positions.iter().map(|&place| placement.point(place)));
        to.vertices.extend(mesh.vertices.iter().map(|vertex| {
            vertex.turned(
                placement.normal(vertex.normal),
                placement.tangent(vertex.tangent_and_side()),
            )
        }));
        to.triangles.extend(
            mesh.triangles
                .iter()
                .map(|triangle| placement.in_order(triangle.map(|vertex| vertex + base))),
        );
        to.slots.extend(&mesh.slots);
        to.objects.extend(mesh.objects.iter().map(|_| instance.object));
    }
}
