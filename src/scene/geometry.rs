//! Triangles made ready to trace: one f32 coordinate system whatever the model's own scale and place, stored in the
//! order in which the hierarchy's leaves refer to them.

use bytemuck::{Pod, Zeroable};
use fearless_simd::Level;
use glam::{DVec3, Vec3A};

use super::convex::is_convex;
use super::hierarchy::{Compressed, Hierarchy, Wide};
use super::intersect::{Hit, RayFrame};
use super::light::AreaShape;
use super::mesh::{Mesh, any_tangent};
use super::model::{Model, Slot};
use super::shapes;
use crate::instructions;

/// The ground's half side in bounding radii.
const GROUND_HALF_SIDE: f64 = 20.0;
/// How far the ground is below the lowest point, in bounding radii: enough that flat bottoms do not flicker with it.
const GROUND_GAP: f64 = 1e-4;

/// What shading needs of a vertex besides its position. 52 bytes, scalars only: the same layout in WGSL.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Vertex {
    /// Unit shading normal.
    pub normal: [f32; 3],
    /// Texture coordinates, v downwards.
    pub uv: [f32; 2],
    /// The second set of texture coordinates.
    pub second_uv: [f32; 2],
    /// Unit tangent and the sign of the bitangent, see [`Mesh::tangents`].
    pub tangent: [f32; 4],
    /// Linear red, green and blue in [0, 1] that multiply the material's, and 1, as 16-bit fractions, two in a word.
    pub color: [u32; 2],
}

impl Vertex {
    /// A vertex's colour, packed.
    fn packed_color(color: [f32; 4]) -> [u32; 2] {
        let bits = |value: f32| (value.clamp(0.0, 1.0) * 65535.0).round() as u32;
        let [r, g, b, _] = color.map(bits);
        [r | g << 16, b | bits(1.0) << 16]
    }

    /// The linear colour that multiplies the material's.
    pub fn rgb(&self) -> [f32; 3] {
        let fraction = |bits: u32| f32::from(bits as u16) / 65535.0;
        [
            fraction(self.color[0]),
            fraction(self.color[0] >> 16),
            fraction(self.color[1]),
        ]
    }
}

/// Geometry ready to trace, in units in which the model's bounding sphere about the origin has radius 1: a place p here
/// is `center_world + world_units_per_unit · p` in the world (right-handed, +Y up). Models that differ in scale or
/// place only give the same numbers here, up to the last bit.
#[derive(Clone, Debug)]
pub struct Geometry {
    /// Places of the vertices.
    pub positions: Vec<[f32; 3]>,
    /// The other attributes of the vertices, as many as `positions`.
    pub vertices: Vec<Vertex>,
    /// The vertices of each triangle, counter-clockwise from outside, in the order in which the hierarchy finds them.
    pub triangles: Vec<[u32; 3]>,
    /// The material slot of each triangle; the ground's is the number of the model's slots, those of area lights follow.
    pub slots: Vec<u32>,
    /// How rays find them.
    hierarchy: Hierarchy,
    /// No ray that leaves a face on its outside meets anything: the scene is one convex body.
    pub is_convex: bool,
    /// The middle of the model's bounding box in the world.
    pub center_world: DVec3,
    /// The model's bounding radius in the world: from that middle to the farthest vertex of a triangle; 1 where there
    /// is no triangle.
    pub world_units_per_unit: f64,
    /// Lowest and highest coordinates of the model (without ground and area lights) in the world.
    pub bounds_world: [DVec3; 2],
    /// Triangles left out because a corner is not finite.
    pub dropped_not_finite: usize,
    /// Triangles left out because they have no area.
    pub dropped_no_area: usize,
}

impl Geometry {
    /// Makes a model ready to trace; `ground` adds a horizontal square of half side 20 bounding radii at its lowest
    /// point, in the slot after the model's (see [`Geometry::ground_slot`]).
    pub fn build(model: &Model, ground: bool) -> Self {
        Self::build_lit(model, ground, &[])
    }

    /// The same with area lights, each in a slot of its own after the model's and the ground's.
    pub fn build_lit(model: &Model, ground: bool, area_lights: &[AreaShape]) -> Self {
        let mesh = &model.mesh;
        let Framing {
            usable,
            dropped_not_finite,
            bounds_world,
            center_world,
            world_units_per_unit,
        } = Framing::of(mesh);
        let mut geometry = Self {
            positions: Vec::new(),
            vertices: Vec::new(),
            triangles: Vec::new(),
            slots: Vec::new(),
            hierarchy: Hierarchy::default(),
            is_convex: false,
            center_world,
            world_units_per_unit,
            bounds_world,
            dropped_not_finite,
            dropped_no_area: mesh.triangles.len() - dropped_not_finite - usable.len(),
        };
        let to_units = |place: DVec3| ((place - center_world) / world_units_per_unit).as_vec3().to_array();
        geometry.add(mesh, usable.into_iter(), to_units);
        if ground {
            let lowest = (bounds_world[0].y - center_world.y) / world_units_per_unit - GROUND_GAP;
            let slot = model.slots.len() as u32;
            let ground = shapes::square(DVec3::Y * lowest, GROUND_HALF_SIDE, GROUND_HALF_SIDE as f32, slot);
            geometry.add(&ground, 0..ground.triangles.len(), |place| place.as_vec3().to_array());
        }
        for (light, slot) in area_lights.iter().zip(model.slots.len() as u32 + u32::from(ground)..) {
            let light = light.mesh(slot);
            geometry.add(&light, 0..light.triangles.len(), |place| place.as_vec3().to_array());
        }
        geometry.build_hierarchy();
        geometry.is_convex = is_convex(&geometry.positions, &geometry.triangles);
        geometry
    }

    /// Builds the hierarchy and puts triangles into its order.
    fn build_hierarchy(&mut self) {
        let corners = self.triangles.iter().map(|triangle| self.corners_of(triangle));
        let (hierarchy, order) = Hierarchy::new(corners);
        self.hierarchy = hierarchy;
        self.sort(&order);
    }

    /// The hierarchy as the GPU reads it, built when it is first asked for.
    pub fn compressed(&self) -> &Compressed {
        self.hierarchy.compressed(|triangle| self.corners(triangle as usize))
    }

    /// Bytes in memory, with the hierarchies that have been built.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.positions[..])
            + size_of_val(&self.vertices[..])
            + size_of_val(&self.triangles[..])
            + size_of_val(&self.slots[..])
            + self.hierarchy.bytes()
    }

    /// Builds the processor's hierarchy if it is not there yet, which the first ray would do otherwise; its bytes.
    pub fn prepare(&self) -> usize {
        self.wide().bytes()
    }

    #[inline(always)]
    fn wide(&self) -> &Wide {
        self.hierarchy.wide(|triangle| self.corners(triangle as usize))
    }

    /// The nearest triangle along a ray, in the geometry's units, with 0 < t < `t_max`. The direction may have any
    /// length but 0.
    #[inline]
    pub fn intersect(&self, origin: [f32; 3], direction: [f32; 3], t_max: f32) -> Option<Hit> {
        self.intersect_by(instructions::level(), origin, direction, t_max)
    }

    /// The same computed with these instructions.
    #[inline]
    pub fn intersect_by(&self, level: Level, origin: [f32; 3], direction: [f32; 3], t_max: f32) -> Option<Hit> {
        let frame = RayFrame::new(origin.into(), direction.into());
        let (t, triangle) = self.wide().nearest(level, &frame, t_max)?;
        let [u, v] = frame.weights(self.corners(triangle as usize).map(Vec3A::from_array));
        Some(Hit { t, triangle, u, v })
    }

    /// Whether any triangle is met with 0 < t < `t_max`.
    #[inline]
    pub fn occluded(&self, origin: [f32; 3], direction: [f32; 3], t_max: f32) -> bool {
        self.occluded_by(instructions::level(), origin, direction, t_max)
    }

    /// The same computed with these instructions.
    #[inline]
    pub fn occluded_by(&self, level: Level, origin: [f32; 3], direction: [f32; 3], t_max: f32) -> bool {
        let frame = RayFrame::new(origin.into(), direction.into());
        self.wide().any(level, &frame, t_max).is_some()
    }

    /// The material of the ground, for the slot after the model's.
    pub fn ground_slot() -> Slot {
        Slot::neutral("ground")
    }

    /// What of the model was left out, one line each.
    pub fn warnings(&self) -> Vec<String> {
        let counts = [
            (self.dropped_not_finite, "a corner that is not finite"),
            (self.dropped_no_area, "no area"),
        ];
        let counts = counts.iter().filter(|(count, _)| *count > 0);
        counts
            .map(|(count, reason)| format!("{count} triangles left out: {reason}"))
            .collect()
    }

    /// The corners of a triangle.
    #[inline(always)]
    pub fn corners(&self, triangle: usize) -> [[f32; 3]; 3] {
        self.corners_of(&self.triangles[triangle])
    }

    #[inline(always)]
    fn corners_of(&self, triangle: &[u32; 3]) -> [[f32; 3]; 3] {
        triangle.map(|vertex| self.positions[vertex as usize])
    }

    /// Centre and radius, in the geometry's units, of a sphere around the triangles of a slot; `None` where there are
    /// none.
    pub fn sphere_around(&self, slot: u32) -> Option<([f32; 3], f64)> {
        let of_slot = || (0..self.triangles.len()).filter(|&triangle| self.slots[triangle] == slot);
        let places = || {
            of_slot()
                .flat_map(|triangle| self.corners(triangle))
                .map(|corner| DVec3::from_array(corner.map(f64::from)))
        };
        let (low, high) = (places().reduce(DVec3::min)?, places().reduce(DVec3::max)?);
        let center = low.midpoint(high);
        let radius = places().map(|place| place.distance(center)).fold(0.0, f64::max);
        Some((center.as_vec3().to_array(), radius.max(1e-6)))
    }

    /// A place in the world of one in the geometry's units.
    pub fn world_from_units(&self, place: [f32; 3]) -> DVec3 {
        self.center_world + self.world_units_per_unit * DVec3::from_array(place.map(f64::from))
    }

    /// A place in the geometry's units of one in the world.
    pub fn units_from_world(&self, place: DVec3) -> DVec3 {
        (place - self.center_world) / self.world_units_per_unit
    }

    /// Adds the chosen triangles of a mesh that have an area.
    fn add(&mut self, mesh: &Mesh, chosen: impl Iterator<Item = usize>, to_units: impl Fn(DVec3) -> [f32; 3]) {
        let base = self.positions.len() as u32;
        for (vertex, &position) in mesh.positions.iter().enumerate() {
            self.positions.push(to_units(position));
            let (normal, tangent) = (mesh.normals[vertex], mesh.tangents[vertex]);
            let tangent = if tangent.is_finite() {
                tangent
            } else {
                any_tangent(normal).extend(1.0)
            };
            self.vertices.push(Vertex {
                normal: normal.to_array(),
                uv: mesh.uvs[vertex].to_array(),
                second_uv: mesh.second_uvs.get(vertex).copied().unwrap_or_default().to_array(),
                tangent: tangent.to_array(),
                color: Vertex::packed_color(mesh.colors.get(vertex).copied().unwrap_or([1.0; 4])),
            });
        }
        for index in chosen {
            let triangle = mesh.triangles[index].map(|vertex| vertex + base);
            // Rounding to f32 may have closed a sliver; corners and their products are exact in f64.
            if has_area(
                self.corners_of(&triangle)
                    .map(|corner| DVec3::from_array(corner.map(f64::from))),
            ) {
                self.triangles.push(triangle);
                self.slots.push(mesh.slots[index]);
            } else {
                self.dropped_no_area += 1;
            }
        }
    }

    /// Puts triangles into an order and vertices into that of their first use, which keeps what rays read together close
    /// together; drops vertices that no triangle uses.
    fn sort(&mut self, order: &[u32]) {
        self.slots = order.iter().map(|&triangle| self.slots[triangle as usize]).collect();
        const UNUSED: u32 = u32::MAX;
        let mut new_of_old = vec![UNUSED; self.positions.len()];
        let (mut positions, mut vertices) = (Vec::new(), Vec::new());
        let sorted = order.iter().map(|&triangle| {
            self.triangles[triangle as usize].map(|vertex| {
                let new = &mut new_of_old[vertex as usize];
                if *new == UNUSED {
                    *new = positions.len() as u32;
                    positions.push(self.positions[vertex as usize]);
                    vertices.push(self.vertices[vertex as usize]);
                }
                *new
            })
        });
        self.triangles = sorted.collect();
        self.positions = positions;
        self.vertices = vertices;
    }
}

/// The triangles of a mesh that can be traced, and the sphere around them.
pub(super) struct Framing {
    /// Those with finite corners and an area.
    pub usable: Vec<usize>,
    pub dropped_not_finite: usize,
    bounds_world: [DVec3; 2],
    pub center_world: DVec3,
    /// See [`Geometry::world_units_per_unit`].
    pub world_units_per_unit: f64,
}

impl Framing {
    pub fn of(mesh: &Mesh) -> Self {
        let is_finite = |&triangle: &usize| mesh.corners(triangle).iter().all(|corner| corner.is_finite());
        let finite: Vec<usize> = (0..mesh.triangles.len()).filter(is_finite).collect();
        let dropped_not_finite = mesh.triangles.len() - finite.len();
        let has_area = |triangle: &usize| has_area(mesh.corners(*triangle));
        let usable: Vec<usize> = finite.into_iter().filter(has_area).collect();
        let bounds_world = bounds(mesh, &usable);
        let center_world = bounds_world[0].midpoint(bounds_world[1]);
        Self {
            dropped_not_finite,
            bounds_world,
            center_world,
            world_units_per_unit: bounding_radius(mesh, &usable, center_world),
            usable,
        }
    }
}

/// Lowest and highest coordinates of the chosen triangles; zero where there are none.
fn bounds(mesh: &Mesh, chosen: &[usize]) -> [DVec3; 2] {
    let corners = || chosen.iter().flat_map(|&triangle| mesh.corners(triangle));
    match (corners().reduce(DVec3::min), corners().reduce(DVec3::max)) {
        (Some(low), Some(high)) => [low, high],
        _ => [DVec3::ZERO; 2],
    }
}

/// From `center` to the farthest corner; 1 where that is nothing.
fn bounding_radius(mesh: &Mesh, chosen: &[usize], center: DVec3) -> f64 {
    let distances = chosen
        .iter()
        .flat_map(|&triangle| mesh.corners(triangle))
        .map(|corner| corner.distance(center));
    match distances.fold(0.0, f64::max) {
        radius if radius > 0.0 && radius.is_finite() => radius,
        _ => 1.0,
    }
}

/// Whether a triangle covers anything.
fn has_area([a, b, c]: [DVec3; 3]) -> bool {
    (b - a).cross(c - a) != DVec3::ZERO
}
