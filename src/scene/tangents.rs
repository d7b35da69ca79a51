//! Tangents by MikkTSpace, which normal textures are baked for.

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Vec2, Vec3, Vec4};

use super::mesh::{Mesh, any_tangent, plane_normal};

/// A mesh whose tangents are asked for corner by corner.
struct Corners<'a> {
    mesh: &'a Mesh,
    /// Texture coordinates as the normal texture is looked up.
    uvs: Vec<Vec2>,
    /// Tangent of each corner; `None` if the texture coordinates or the triangle are degenerate.
    tangents: Vec<[Option<Vec4>; 3]>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.triangles[face][corner] as usize
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.vertex(face, corner)].as_vec3().to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        let normal = self.mesh.normals[self.vertex(face, corner)];
        if normal == Vec3::ZERO {
            return plane_normal(self.mesh.corners(face)).as_vec3().to_array();
        }
        normal.to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.uvs[self.vertex(face, corner)].to_array()
    }

    fn set_tangent(&mut self, tangent: Option<TangentSpace>, face: usize, corner: usize) {
        self.tangents[face][corner] = tangent.map(|space| {
            let [x, y, z, sign] = space.tangent_encoded();
            // MikkTSpace has v upwards, glTF downwards.
            Vec4::new(x, y, z, -sign)
        });
    }
}

impl Mesh {
    /// Tangents by MikkTSpace along growing u of a texture that the texture coordinates look into by these coefficients
    /// (`TextureRef::texture_from_mesh_uv`). A vertex whose corners have different tangents is split; one without usable
    /// texture coordinates gets any tangent.
    pub fn mikktspace_tangents(&mut self, texture_from_uv: [f32; 6]) {
        let [uu, uv, u1, vu, vv, v1] = texture_from_uv;
        let mut corners = Corners {
            uvs: self
                .uvs
                .iter()
                .map(|at| Vec2::new(uu * at.x + uv * at.y + u1, vu * at.x + vv * at.y + v1))
                .collect(),
            tangents: vec![[None; 3]; self.triangles.len()],
            mesh: self,
        };
        // It cannot fail for any mesh.
        let _ = generate_tangents(&mut corners);
        self.take_corner_tangents(&corners.tangents);
    }

    /// Sets vertex tangents from corners, splitting vertices whose corners differ.
    fn take_corner_tangents(&mut self, tangents: &[[Option<Vec4>; 3]]) {
        const NONE: u32 = u32::MAX;
        let mut is_set = vec![false; self.positions.len()];
        // The next vertex that was split off the same one.
        let mut next = vec![NONE; self.positions.len()];
        for (face, corner_tangents) in tangents.iter().enumerate() {
            for (corner, tangent) in corner_tangents.iter().enumerate() {
                // A degenerate corner keeps its vertex's tangent.
                let Some(tangent) = tangent.filter(|t| t.is_finite() && t.truncate() != Vec3::ZERO) else {
                    continue;
                };
                let mut vertex = self.triangles[face][corner];
                while is_set[vertex as usize] && self.tangents[vertex as usize] != tangent {
                    let index = vertex as usize;
                    if next[index] == NONE {
                        next[index] = self.copy_vertex(index);
                        is_set.push(false);
                        next.push(NONE);
                    }
                    vertex = next[index];
                }
                is_set[vertex as usize] = true;
                self.tangents[vertex as usize] = tangent;
                self.triangles[face][corner] = vertex;
            }
        }
        for ((tangent, normal), is_set) in self.tangents.iter_mut().zip(&self.normals).zip(is_set) {
            if !is_set {
                *tangent = any_tangent(*normal).extend(1.0);
            }
        }
    }
}
