//! Triangle meshes in model space, before they are made ready to trace.

use std::collections::HashMap;

use glam::{DMat4, DVec2, DVec3, Vec2, Vec3, Vec4};

use super::loading::Loading;

/// Triangles with attributes at their vertices. Anticlockwise order seen from outside; right-handed, +Y up.
///
/// All attribute vectors have the length of `positions` (`second_uvs` and `colors` may be empty), `slots` has the length
/// of `triangles`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Places in model units. Double precision, so that a small part far from the origin keeps its shape.
    pub positions: Vec<DVec3>,
    /// Unit shading normals; 0 for flat shading, which needs no vertices of its own.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, v downwards in the image as in glTF; zero if the source has none.
    pub uvs: Vec<Vec2>,
    /// Second set of texture coordinates; empty if unused.
    pub second_uvs: Vec<Vec2>,
    /// Linear RGB and opacity that multiply the material's; empty if unused.
    pub colors: Vec<[f32; 4]>,
    /// Unit tangents along growing u (xyz) and the sign (w, ±1) of the bitangent w · (normal × tangent), which points
    /// upwards in the image (along falling v), as in glTF.
    pub tangents: Vec<Vec4>,
    /// The three vertices of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// The material slot of each triangle.
    pub slots: Vec<u32>,
}

/// A mesh at one of several places.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshInstance {
    /// Index into [`Model::repeated`](super::Model::repeated).
    pub mesh: usize,
    /// Transform into model space; it can be inverted.
    pub world_from_mesh: DMat4,
    /// Index of the object that it belongs to.
    pub object: usize,
}

impl Mesh {
    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.positions[..])
            + size_of_val(&self.normals[..])
            + size_of_val(&self.uvs[..])
            + size_of_val(&self.second_uvs[..])
            + size_of_val(&self.colors[..])
            + size_of_val(&self.tangents[..])
            + size_of_val(&self.triangles[..])
            + size_of_val(&self.slots[..])
    }

    /// Adds one vertex and gives its index.
    pub fn push_vertex(&mut self, position: DVec3, normal: Vec3, uv: Vec2, tangent: Vec4) -> u32 {
        let index = self.positions.len() as u32;
        self.positions.push(position);
        self.normals.push(normal);
        self.uvs.push(uv);
        if !self.second_uvs.is_empty() {
            self.second_uvs.push(Vec2::ZERO);
        }
        if !self.colors.is_empty() {
            self.colors.push(WHITE);
        }
        self.tangents.push(tangent);
        index
    }

    /// Adds a vertex like another one and gives its index.
    pub fn copy_vertex(&mut self, from: usize) -> u32 {
        let index = self.push_vertex(
            self.positions[from],
            self.normals[from],
            self.uvs[from],
            self.tangents[from],
        );
        if let Some(&uv) = self.second_uvs.get(from) {
            self.second_uvs[index as usize] = uv;
        }
        if let Some(&color) = self.colors.get(from) {
            self.colors[index as usize] = color;
        }
        index
    }

    /// Adds a triangle unless two of its corners are at the same place.
    pub fn push_triangle(&mut self, triangle: [u32; 3], slot: u32) {
        let [a, b, c] = triangle.map(|vertex| self.positions[vertex as usize]);
        if a != b && b != c && c != a {
            self.triangles.push(triangle);
            self.slots.push(slot);
        }
    }

    /// Adds all vertices and triangles of `other`, with their slots as they are.
    pub fn append(&mut self, other: Mesh) {
        if self.positions.is_empty() && self.triangles.is_empty() {
            // Most files have one mesh: nothing needs to be copied.
            *self = other;
            return;
        }
        let base = self.positions.len() as u32;
        let counts = [self.positions.len(), other.positions.len()];
        append_optional(&mut self.second_uvs, &other.second_uvs, counts, Vec2::ZERO);
        append_optional(&mut self.colors, &other.colors, counts, WHITE);
        self.positions.extend(other.positions);
        self.normals.extend(other.normals);
        self.uvs.extend(other.uvs);
        self.tangents.extend(other.tangents);
        self.triangles.extend(
            other
                .triangles
                .into_iter()
                .map(|triangle| triangle.map(|vertex| vertex + base)),
        );
        self.slots.extend(other.slots);
    }

    /// The three corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|vertex| self.positions[vertex as usize])
    }

    /// Signed volume of a closed mesh, in cubic units; positive if it faces outwards.
    pub fn signed_volume(&self) -> f64 {
        let origin = self.positions.first().copied().unwrap_or_default();
        let parallelepipeds = (0..self.triangles.len()).map(|triangle| {
            let [a, b, c] = self.corners(triangle).map(|corner| corner - origin);
            a.dot(b.cross(c))
        });
        parallelepipeds.sum::<f64>() / 6.0
    }

    /// Gives corners that are shaded by their triangle's plane vertices of their own with its normal: for formats whose
    /// vertices all have normals.
    pub fn split_flat(&mut self) {
        for triangle in 0..self.triangles.len() {
            let normal = plane_normal(self.corners(triangle)).as_vec3();
            for corner in 0..3 {
                let vertex = self.triangles[triangle][corner] as usize;
                if self.normals[vertex] == Vec3::ZERO {
                    let own = self.copy_vertex(vertex);
                    self.normals[own as usize] = normal;
                    self.triangles[triangle][corner] = own;
                }
            }
        }
    }

    /// Sets each vertex normal to the area-weighted mean of its triangles, for scanned surfaces without creases. Incomplete
    /// if cancelled.
    pub fn smooth_normals(&mut self, loading: &Loading) {
        let mut sums = vec![DVec3::ZERO; self.positions.len()];
        for triangle in loading.while_wanted(0..self.triangles.len()) {
            let [a, b, c] = self.corners(triangle);
            let doubled_area = (b - a).cross(c - a);
            for vertex in self.triangles[triangle] {
                sums[vertex as usize] += doubled_area;
            }
        }
        self.normals = sums.into_iter().map(|sum| sum.normalize_or_zero().as_vec3()).collect();
    }

    /// Normalises normals; non-finite and zero ones become 0, which stands for the triangle's plane. Returns their number.
    pub fn repair_normals(&mut self) -> usize {
        let mut broken = 0;
        for normal in &mut self.normals {
            let unit = normal.as_dvec3().try_normalize();
            broken += usize::from(unit.is_none());
            *normal = unit.unwrap_or_default().as_vec3();
        }
        broken
    }

    /// Tangents along growing u of a texture, as [`Mesh::mikktspace_tangents`] where `is_exact` (a normal texture is made
    /// for these), else as [`Mesh::generate_tangents`], which is faster.
    pub fn make_tangents(&mut self, texture_from_uv: [f32; 6], is_exact: bool, loading: &Loading) {
        if is_exact {
            self.mikktspace_tangents(texture_from_uv);
        } else {
            self.generate_tangents(texture_from_uv, loading);
        }
    }

    /// Tangents along growing u of a texture that the texture coordinates look into by these coefficients
    /// (`TextureRef::texture_from_mesh_uv`), averaged over the triangles at a vertex by their angles there. A vertex
    /// whose triangles disagree about the handedness of the texture is split; one without usable texture coordinates
    /// gets any tangent. Left half done where it is not wanted any more.
    pub fn generate_tangents(&mut self, texture_from_uv: [f32; 6], loading: &Loading) {
        let mut sums = vec![DVec3::ZERO; self.positions.len()];
        let mut signs = vec![0.0f32; self.positions.len()];
        let mut mirrored: HashMap<u32, u32> = HashMap::new();
        for triangle in loading.while_wanted(0..self.triangles.len()) {
            let Some((along_u, sign)) = self.texture_frame(triangle, texture_from_uv) else {
                continue;
            };
            let corners = self.corners(triangle);
            for corner in 0..3 {
                let mut vertex = self.triangles[triangle][corner];
                if signs[vertex as usize] == -sign {
                    vertex = *mirrored.entry(vertex).or_insert_with(|| {
                        sums.push(DVec3::ZERO);
                        signs.push(sign);
                        self.copy_vertex(vertex as usize)
                    });
                    self.triangles[triangle][corner] = vertex;
                }
                signs[vertex as usize] = sign;
                let normal = self.normals[vertex as usize].as_dvec3();
                let in_plane = along_u - normal * normal.dot(along_u);
                let [here, next, last] = [0, 1, 2].map(|step| corners[(corner + step) % 3]);
                let angle_rad = (next - here).angle_between(last - here);
                if angle_rad.is_finite() {
                    sums[vertex as usize] += in_plane.normalize_or_zero() * angle_rad;
                }
            }
        }
        for (vertex, sum) in sums.into_iter().enumerate() {
            let normal = self.normals[vertex];
            self.tangents[vertex] = match sum.try_normalize() {
                Some(tangent) => tangent.as_vec3().extend(signs[vertex]),
                None => any_tangent(normal).extend(1.0),
            };
        }
    }

    /// Direction of growing u on a triangle and the sign of its bitangent; `None` if the texture coordinates or the triangle
    /// are degenerate.
    fn texture_frame(&self, triangle: usize, texture_from_uv: [f32; 6]) -> Option<(DVec3, f32)> {
        let [a, b, c] = self.corners(triangle);
        let [uv_a, uv_b, uv_c] = self.triangles[triangle].map(|vertex| self.uvs[vertex as usize].as_dvec2());
        let [uu, uv, _, vu, vv, _] = texture_from_uv.map(f64::from);
        let in_texture = |step: DVec2| DVec2::new(uu * step.x + uv * step.y, vu * step.x + vv * step.y);
        let (to_b, to_c) = (b - a, c - a);
        let (uv_to_b, uv_to_c) = (in_texture(uv_b - uv_a), in_texture(uv_c - uv_a));
        let determinant = uv_to_b.perp_dot(uv_to_c);
        let along_u = (to_b * uv_to_c.y - to_c * uv_to_b.y) * determinant.signum();
        // v grows downwards: a texture that is not mirrored has a negative determinant seen from outside.
        let sign = if determinant < 0.0 { 1.0 } else { -1.0 };
        (determinant != 0.0 && determinant.is_finite()).then_some((along_u.try_normalize()?, sign))
    }
}

/// The colour of a vertex without one.
const WHITE: [f32; 4] = [1.0; 4];

/// Appends optional values; `counts` are the vertices of both sides.
fn append_optional<T: Copy>(values: &mut Vec<T>, others: &[T], counts: [usize; 2], default: T) {
    if values.is_empty() && others.is_empty() {
        return;
    }
    values.resize(counts[0], default);
    values.extend(others);
    values.resize(counts[0] + counts[1], default);
}

/// Unit normal of the plane through three points in anticlockwise order; +Y if they are collinear.
pub fn plane_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).try_normalize().unwrap_or(DVec3::Y)
}

/// Any unit vector that is perpendicular to a unit normal.
pub fn any_tangent(normal: Vec3) -> Vec3 {
    normal
        .try_normalize()
        .map_or(Vec3::X, |normal| normal.any_orthonormal_vector())
}
