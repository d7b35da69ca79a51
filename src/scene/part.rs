//! Triangles with their hierarchies: the model's, or those of its surroundings.

use bytemuck::{Pod, Zeroable};
use fearless_simd::Level;
use glam::DVec3;

use super::{
    hierarchy::{Compressed, Hierarchy, Wide},
    intersect::{Hit, RayFrame},
    loading::{Cancelled, Loading},
    memory::{in_large_pages, room_in_large_pages},
    mesh::{Mesh, any_tangent},
};

/// Stored value of alpha 1.
const ALPHA_MAX: f32 = 32767.0;

/// A vertex's shading attributes, without its position: three times 16 bytes, with the same layout in WGSL.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Vertex {
    /// Unit shading normal, or 0 for that of the triangle's plane.
    pub normal: [f32; 3],
    /// Linear red and green in [0, 1] that multiply the material's, as 16-bit fractions.
    pub red_green: u32,
    /// Unit tangent, see [`Mesh::tangents`].
    pub tangent: [f32; 3],
    /// Blue; alpha in 15 bits; and in the last bit which side of the tangent the bitangent is on: 0 or 1, for −1 and 1.
    pub blue_side: u32,
    /// Texture coordinates, v downwards, and the second set of them.
    pub uvs: [f32; 4],
}

impl Vertex {
    /// Vertex `index` of a mesh.
    fn of(mesh: &Mesh, index: usize) -> Self {
        let (normal, tangent) = (mesh.normals[index], mesh.tangents[index]);
        let tangent = if tangent.is_finite() {
            tangent
        } else {
            any_tangent(normal).extend(1.0)
        };
        let [red, green, blue, alpha] = mesh.colors.get(index).copied().unwrap_or([1.0; 4]);
        let side = u32::from(tangent.w >= 0.0) << 31;
        let alpha = (alpha.clamp(0.0, 1.0) * ALPHA_MAX).round() as u32;
        let fractions = |low: f32, high: f32| {
            let [low, high] = [low, high].map(|value| (value.clamp(0.0, 1.0) * 65535.0).round() as u32);
            low | high << 16
        };
        let (uv, second_uv) = (mesh.uvs[index], mesh.second_uvs.get(index).copied().unwrap_or_default());
        Self {
            normal: normal.to_array(),
            red_green: fractions(red, green),
            tangent: tangent.truncate().to_array(),
            blue_side: fractions(blue, 0.0) | alpha << 16 | side,
            uvs: [uv.x, uv.y, second_uv.x, second_uv.y],
        }
    }

    /// The vertex with another normal, tangent, and sign of the bitangent.
    pub fn turned(&self, normal: [f32; 3], [x, y, z, side]: [f32; 4]) -> Self {
        const SIDE: u32 = 1 << 31;
        Self {
            normal,
            tangent: [x, y, z],
            blue_side: self.blue_side & !SIDE | if side < 0.0 { 0 } else { SIDE },
            ..*self
        }
    }

    /// The linear colour that multiplies the material's.
    pub fn rgb(&self) -> [f32; 3] {
        let fraction = |bits: u32| f32::from(bits as u16) / 65535.0;
        [
            fraction(self.red_green),
            fraction(self.red_green >> 16),
            fraction(self.blue_side),
        ]
    }

    /// The share of the material's opacity that is left here, in [0, 1].
    pub fn alpha(&self) -> f32 {
        (self.blue_side >> 16 & 0x7fff) as f32 / ALPHA_MAX
    }

    /// The tangent, and the sign of the bitangent: 1 or −1.
    #[inline(always)]
    pub fn tangent_and_side(&self) -> [f32; 4] {
        let [x, y, z] = self.tangent;
        [x, y, z, if self.blue_side >> 31 == 0 { -1.0 } else { 1.0 }]
    }
}

/// Object index of triangles that belong to no object of the model.
pub const NO_OBJECT: u32 = u32::MAX;

/// Triangles in one f32 coordinate system, in the order in which their hierarchy's leaves refer to them.
#[derive(Clone, Debug, Default)]
pub struct Part {
    pub positions: Vec<[f32; 3]>,
    /// Other vertex attributes, as many as `positions`.
    pub vertices: Vec<Vertex>,
    /// Vertex indices of each triangle, anticlockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The material slot of each triangle.
    pub slots: Vec<u32>,
    /// The model's object that each triangle belongs to; [`NO_OBJECT`](super::NO_OBJECT) for what is none of the model's.
    pub objects: Vec<u32>,
    hierarchy: Hierarchy,
}

impl Part {
    /// Builds the hierarchy over the triangles that have been added, and puts them into its order, which it returns.
    pub fn build(&mut self, loading: &Loading) -> Result<Vec<u32>, Cancelled> {
        let corners = |triangle| self.corners(triangle as usize);
        let (hierarchy, order) = Hierarchy::new(self.triangles.len(), corners, loading)?;
        self.hierarchy = hierarchy;
        self.sort(&order);
        Ok(order)
    }

    /// The same triangles, to add more.
    pub fn without_hierarchy(&self) -> Self {
        Self {
            positions: self.positions.clone(),
            vertices: self.vertices.clone(),
            triangles: self.triangles.clone(),
            slots: self.slots.clone(),
            objects: self.objects.clone(),
            hierarchy: Hierarchy::default(),
        }
    }

    /// True without triangles.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// The GPU's hierarchy, built on first use.
    pub fn compressed(&self) -> &Compressed {
        self.hierarchy.compressed(|triangle| self.corners(triangle as usize))
    }

    /// The CPU's hierarchy, built on first use.
    pub fn wide(&self) -> &Wide {
        self.hierarchy.wide(|triangle| self.corners(triangle as usize))
    }

    /// Memory in bytes, with the hierarchies built so far.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.positions[..])
            + size_of_val(&self.vertices[..])
            + size_of_val(&self.triangles[..])
            + size_of_val(&self.slots[..])
            + size_of_val(&self.objects[..])
            + self.hierarchy.bytes()
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [[f32; 3]; 3] {
        self.corners_of(&self.triangles[triangle])
    }

    /// Shading attributes of a triangle's vertices.
    pub fn vertices_of(&self, triangle: usize) -> [&Vertex; 3] {
        self.triangles[triangle].map(|vertex| &self.vertices[vertex as usize])
    }

    fn corners_of(&self, triangle: &[u32; 3]) -> [[f32; 3]; 3] {
        triangle.map(|vertex| self.positions[vertex as usize])
    }

    /// The closest hit with 0 < t < `t_max`.
    pub fn hit<const ANY: bool>(&self, level: Level, frame: &RayFrame, t_max: f32) -> Option<Hit> {
        match self.is_empty() {
            true => None,
            false => self.wide().hit::<ANY>(level, frame, t_max),
        }
    }

    /// Adds the chosen triangles of a mesh. Returns the number of those that lost their area by rounding.
    pub fn add(
        &mut self,
        mesh: &Mesh,
        chosen: impl Iterator<Item = usize>,
        object_of: impl Fn(usize) -> u32,
        to_units: impl Fn(DVec3) -> [f32; 3],
    ) -> usize {
        let base = self.positions.len() as u32;
        self.positions.reserve_exact(mesh.positions.len());
        self.vertices.reserve_exact(mesh.positions.len());
        for (vertex, &position) in mesh.positions.iter().enumerate() {
            self.positions.push(to_units(position));
            self.vertices.push(Vertex::of(mesh, vertex));
        }
        let mut dropped = 0;
        for index in chosen {
            let triangle = mesh.triangles[index].map(|vertex| vertex + base);
            // Rounding to f32 may have closed a sliver; corners and their products are exact in f64.
            if has_area(exact(self.corners_of(&triangle))) {
                self.triangles.push(triangle);
                self.slots.push(mesh.slots[index]);
                self.objects.push(object_of(index));
            } else {
                dropped += 1;
            }
        }
        dropped
    }

    /// Sorts triangles by `order` and vertices by first use, for locality. Drops unused vertices.
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

/// Corners in double precision, in which their products are exact.
pub fn exact(corners: [[f32; 3]; 3]) -> [DVec3; 3] {
    corners.map(|corner| DVec3::from_array(corner.map(f64::from)))
}

/// Whether a triangle's corners are finite.
pub fn is_finite(corners: &[DVec3; 3]) -> bool {
    corners.iter().all(|corner| corner.is_finite())
}

/// Whether a triangle can be traced: its corners are finite, and it has an area.
pub fn is_traceable(corners: [DVec3; 3]) -> bool {
    is_finite(&corners) && has_area(corners)
}

fn has_area([a, b, c]: [DVec3; 3]) -> bool {
    (b - a).cross(c - a) != DVec3::ZERO
}
