//! Triangles made ready to trace: one f32 coordinate system whatever the model's own scale and place, stored in the
//! order in which the hierarchy's leaves refer to them.

use bytemuck::{Pod, Zeroable};
use fearless_simd::Level;
use glam::{DVec3, Vec3A};
use rayon::prelude::*;

use super::convex::is_convex;
use super::ground::Ground;
use super::hierarchy::{Compressed, Found, Hierarchy, PACKET, Packet, Wide};
use super::intersect::{Hit, RayFrame};
use super::light::AreaShape;
use super::loading::{Cancelled, Loading};
use super::memory::{fetch, in_large_pages, room_in_large_pages};
use super::mesh::{Mesh, any_tangent};
use super::model::{Model, Slot};
use crate::instructions;

/// How far the ground is below the lowest point, in bounding radii: enough that flat bottoms do not flicker with it.
const GROUND_GAP: f64 = 1e-4;

/// What stands for no object of the model.
pub const NO_OBJECT: u32 = u32::MAX;

/// What shading needs of a vertex besides its position. 52 bytes, scalars only: the same layout in WGSL.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Vertex {
    /// Unit shading normal, or 0 for that of the triangle's plane.
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
    /// The model's object that each triangle belongs to; [`NO_OBJECT`] for ground and area lights.
    pub objects: Vec<u32>,
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
    /// Makes a model ready to trace; a ground touches its lowest point, in the slot after the model's (see
    /// [`Geometry::ground_slot`]).
    pub fn build(model: &Model, ground: impl Into<Ground>) -> Self {
        Self::build_lit(model, ground, &[], &[])
    }

    /// The same with area lights, each in a slot of its own after the model's and the ground's, and without the objects
    /// whose numbers are hidden: place and scale stay those of the whole model.
    pub fn build_lit(model: &Model, ground: impl Into<Ground>, area_lights: &[AreaShape], hidden: &[usize]) -> Self {
        Self::build_watched(model, ground, area_lights, hidden, &Loading::default()).expect("nobody cancels it")
    }

    /// The same for those who wait.
    ///
    /// # Errors
    /// Where it was cancelled.
    pub fn build_watched(
        model: &Model,
        ground: impl Into<Ground>,
        area_lights: &[AreaShape],
        hidden: &[usize],
        loading: &Loading,
    ) -> Result<Self, Cancelled> {
        loading.step("measuring the model")?;
        let mesh = &model.mesh;
        let Framing {
            usable,
            dropped_not_finite,
            bounds_world,
            center_world,
            world_units_per_unit,
        } = Framing::of(mesh);
        let is_usable = |triangle: &usize| is_usable(mesh.corners(*triangle));
        let mut geometry = Self {
            positions: Vec::new(),
            vertices: Vec::new(),
            triangles: Vec::new(),
            slots: Vec::new(),
            objects: Vec::new(),
            hierarchy: Hierarchy::default(),
            is_convex: false,
            center_world,
            world_units_per_unit,
            bounds_world,
            dropped_not_finite,
            dropped_no_area: mesh.triangles.len() - dropped_not_finite - usable,
        };
        let to_units = |place: DVec3| ((place - center_world) / world_units_per_unit).as_vec3().to_array();
        let is_shown = |triangle: &usize| {
            let object = model.object_of(*triangle);
            !hidden.iter().any(|hidden| Some(*hidden) == object)
        };
        let object_of = |triangle| model.object_of(triangle).map_or(NO_OBJECT, |object| object as u32);
        let chosen = (0..mesh.triangles.len()).filter(is_usable);
        if hidden.is_empty() {
            geometry.add(mesh, chosen, object_of, to_units);
        } else {
            geometry.add(mesh, chosen.filter(is_shown), object_of, to_units);
        }
        let ground_slot = model.slots.len() as u32;
        let ground = ground.into().mesh(geometry.ground_height(), ground_slot);
        if let Some(ground) = &ground {
            let to_units = |place: DVec3| place.as_vec3().to_array();
            geometry.add(ground, 0..ground.triangles.len(), |_| NO_OBJECT, to_units);
        }
        for (light, slot) in area_lights.iter().zip(ground_slot + u32::from(ground.is_some())..) {
            let light = light.mesh(slot);
            let to_units = |place: DVec3| place.as_vec3().to_array();
            geometry.add(&light, 0..light.triangles.len(), |_| NO_OBJECT, to_units);
        }
        geometry.build_hierarchy(loading)?;
        geometry.is_convex = is_convex(&geometry.positions, &geometry.triangles);
        Ok(geometry)
    }

    /// Builds the hierarchy and puts triangles into its order.
    fn build_hierarchy(&mut self, loading: &Loading) -> Result<(), Cancelled> {
        let corners = |triangle| self.corners(triangle as usize);
        let (hierarchy, order) = Hierarchy::new(self.triangles.len(), corners, loading)?;
        self.hierarchy = hierarchy;
        self.sort(&order);
        Ok(())
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
            + size_of_val(&self.objects[..])
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

    /// What each ray of a packet meets, as [`Geometry::intersect`] says, the instructions forced by `level`.
    pub fn intersect_packet(&self, level: Level, packet: &Packet) -> [Option<Hit>; PACKET] {
        let Some(Found { t, marks }) = self.wide().nearest_of(level, packet) else {
            let alone =
                |lane| self.intersect_by(level, packet.origin(lane), packet.direction(lane), packet.t_max[lane]);
            return std::array::from_fn(alone);
        };
        std::array::from_fn(|lane| {
            let triangle = marks[lane].checked_sub(1)?;
            let frame = RayFrame::new(packet.origin(lane).into(), packet.direction(lane).into());
            let [u, v] = frame.weights(self.corners(triangle as usize).map(Vec3A::from_array));
            let t = t[lane];
            Some(Hit { t, triangle, u, v })
        })
    }

    /// Whether any triangle is met on each ray of a packet, as [`Geometry::occluded`] says.
    pub fn occluded_packet(&self, level: Level, packet: &Packet) -> [bool; PACKET] {
        let Some(Found { marks, .. }) = self.wide().any_of(level, packet) else {
            let alone = |lane| self.occluded_by(level, packet.origin(lane), packet.direction(lane), packet.t_max[lane]);
            return std::array::from_fn(alone);
        };
        marks.map(|mark| mark != 0)
    }

    /// Has the processor fetch what shading a triangle looks up.
    #[inline(always)]
    pub fn fetch(&self, triangle: u32) {
        fetch(&self.slots, triangle as usize);
        for vertex in self.triangles[triangle as usize] {
            fetch(&self.vertices, vertex as usize);
        }
    }

    /// The height of a ground, in the geometry's units.
    pub fn ground_height(&self) -> f64 {
        (self.bounds_world[0].y - self.center_world.y) / self.world_units_per_unit - GROUND_GAP
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

    /// Centre and radius, in the geometry's units, of a sphere around chosen triangles; `None` where there are none.
    pub fn sphere_around(&self, is_chosen: impl Fn(usize) -> bool) -> Option<([f32; 3], f64)> {
        let chosen = || (0..self.triangles.len()).filter(|&triangle| is_chosen(triangle));
        let places = || {
            chosen()
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
    fn add(
        &mut self,
        mesh: &Mesh,
        chosen: impl Iterator<Item = usize>,
        object_of: impl Fn(usize) -> u32,
        to_units: impl Fn(DVec3) -> [f32; 3],
    ) {
        let base = self.positions.len() as u32;
        self.positions.reserve_exact(mesh.positions.len());
        self.vertices.reserve_exact(mesh.positions.len());
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
                self.objects.push(object_of(index));
            } else {
                self.dropped_no_area += 1;
            }
        }
    }

    /// Puts triangles into an order and vertices into that of their first use, which keeps what rays read together close
    /// together; drops vertices that no triangle uses.
    fn sort(&mut self, order: &[u32]) {
        self.slots = order.iter().map(|&triangle| self.slots[triangle as usize]).collect();
        self.objects = order.iter().map(|&triangle| self.objects[triangle as usize]).collect();
        const UNUSED: u32 = u32::MAX;
        let mut new_of_old = vec![UNUSED; self.positions.len()];
        let mut positions = room_in_large_pages(self.positions.len());
        let mut vertices = room_in_large_pages(self.positions.len());
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
        let mut triangles = room_in_large_pages(order.len());
        triangles.extend(sorted);
        self.triangles = in_large_pages(triangles);
        self.positions = in_large_pages(positions);
        self.vertices = in_large_pages(vertices);
    }
}

/// How many triangles of a mesh can be traced, and the sphere around them.
pub(super) struct Framing {
    /// Triangles with finite corners and an area.
    pub usable: usize,
    pub dropped_not_finite: usize,
    bounds_world: [DVec3; 2],
    pub center_world: DVec3,
    /// See [`Geometry::world_units_per_unit`].
    pub world_units_per_unit: f64,
}

impl Framing {
    pub fn of(mesh: &Mesh) -> Self {
        let corners = || {
            let triangles = (0..mesh.triangles.len()).into_par_iter();
            triangles.map(|triangle| mesh.corners(triangle))
        };
        let usable = || corners().filter(|corners| is_usable(*corners));
        let low = usable().flatten_iter().reduce(|| DVec3::INFINITY, DVec3::min);
        let high = usable().flatten_iter().reduce(|| DVec3::NEG_INFINITY, DVec3::max);
        let has_any = low.x <= high.x;
        let bounds_world = if has_any { [low, high] } else { [DVec3::ZERO; 2] };
        let center_world = bounds_world[0].midpoint(bounds_world[1]);
        let distances = usable().flatten_iter().map(|corner| corner.distance(center_world));
        let radius = distances.reduce(|| 0.0, f64::max);
        let has_radius = radius > 0.0 && radius.is_finite();
        Self {
            usable: usable().count(),
            dropped_not_finite: corners().filter(|corners| !is_finite(corners)).count(),
            bounds_world,
            center_world,
            world_units_per_unit: if has_radius { radius } else { 1.0 },
        }
    }
}

impl Model {
    /// From the middle of its bounding box to the farthest vertex of a triangle, in the world; 1 where there is none.
    pub fn bounding_radius(&self) -> f64 {
        Framing::of(&self.mesh).world_units_per_unit
    }
}

fn is_finite(corners: &[DVec3; 3]) -> bool {
    corners.iter().all(|corner| corner.is_finite())
}

/// Whether a triangle can be traced.
fn is_usable(corners: [DVec3; 3]) -> bool {
    is_finite(&corners) && has_area(corners)
}

/// Whether a triangle covers anything.
fn has_area([a, b, c]: [DVec3; 3]) -> bool {
    (b - a).cross(c - a) != DVec3::ZERO
}
