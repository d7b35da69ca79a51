//! Meshes of the ufbx crate, which reads FBX and OBJ, as triangles.

use std::collections::HashMap;

use glam::{DVec3, Vec2, Vec3, Vec4};
use ufbx::{Face, VertexVec2, VertexVec4};

use crate::{
    optics::tone::linear_from_srgb,
    optics::vector::vec3,
    polygon::doubled_area,
    scene::{Loading, mesh::Mesh, report::Fate, report::ImportReport},
};

/// Index of what a corner doesn't have.
const NONE: u32 = u32::MAX;

/// What is read of a mesh besides its places and normals.
#[derive(Clone, Copy, Default)]
pub struct Look<'a> {
    pub slot: u32,
    /// The first set of texture coordinates, and the second if it is used.
    pub uvs: [Option<&'a VertexVec2>; 2],
    pub colors: Option<&'a VertexVec4>,
    /// Of the texture of normals, if there is one.
    pub normal_texture_from_uv: Option<[f32; 6]>,
}

/// Parts that can't be shown as they are.
#[derive(Default)]
pub struct Broken {
    /// Faces with a vertex that is not there.
    pub faces: usize,
    uvs: usize,
    normals: usize,
}

impl Broken {
    pub fn report(&self, name: &str, report: &mut ImportReport) {
        for (fate, what, count) in [
            (Fate::Ignored, "faces whose vertices are not there", self.faces),
            (Fate::Ignored, "texture coordinates that are not finite", self.uvs),
            (
                Fate::Approximated,
                "normals without a length, taken from triangles",
                self.normals,
            ),
        ] {
            report.count(fate, what, name, count);
        }
    }
}

/// A mesh of a file, in its pose.
pub struct Polygons<'a> {
    mesh: &'a ufbx::Mesh,
    /// Smoothing group of each face without normals; 0, or none, is flat.
    groups: &'a [u32],
    /// Normals by vertex and smoothing group.
    smooth: HashMap<(u32, u32), Vec3>,
}

impl<'a> Polygons<'a> {
    pub fn new(mesh: &'a ufbx::Mesh, groups: &'a [u32], loading: &Loading) -> Self {
        let mut polygons = Self {
            mesh,
            groups,
            smooth: HashMap::new(),
        };
        let mut sums: HashMap<(u32, u32), DVec3> = HashMap::new();
        for (place, face) in loading.while_wanted(mesh.faces.iter().enumerate()) {
            let group = polygons.group(place);
            let corners = corners(face);
            if group == 0 || corners.clone().all(|corner| polygons.normal_index(corner) != NONE) {
                continue;
            }
            let Some(places) = polygons.places(face) else { continue };
            let area = doubled_area(&places);
            for corner in corners {
                *sums.entry((polygons.place_index(corner), group)).or_default() += area;
            }
        }
        let unit = |(key, sum): ((u32, u32), DVec3)| (key, sum.normalize_or_zero().as_vec3());
        polygons.smooth = sums.into_iter().map(unit).collect();
        polygons
    }

    /// Triangles of some faces, which share a slot.
    pub fn read(&self, faces: &[u32], look: &Look<'_>, broken: &mut Broken, loading: &Loading) -> Mesh {
        let mut read = Mesh::default();
        let mut known: HashMap<[u32; 6], u32> = HashMap::new();
        let mut indices = Vec::new();
        for &place in loading.while_wanted(faces.iter()) {
            let Some(face) = self.mesh.faces.get(place as usize) else {
                continue;
            };
            let is_hole = self.mesh.face_hole.get(place as usize) == Some(&true);
            if face.num_indices < 3 || is_hole {
                continue;
            }
            if self.places(face).is_none() {
                broken.faces += 1;
                continue;
            }
            let group = self.group(place as usize);
            let most = 3 * (face.num_indices as usize - 2);
            indices.resize(most.max(indices.len()), 0);
            let count = self.mesh.triangulate_face(&mut indices, *face) as usize;
            for triangle in indices.as_chunks::<3>().0.iter().take(count) {
                let triangle = triangle.map(|corner| {
                    let key = self.key(corner, group, look);
                    *known
                        .entry(key)
                        .or_insert_with(|| self.push_vertex(key, look, &mut read, broken))
                });
                read.triangles.push(triangle);
                read.slots.push(look.slot);
            }
        }
        read.tangents = vec![Vec4::W; read.positions.len()];
        let texture_from_uv = look.normal_texture_from_uv.unwrap_or([1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        read.make_tangents(texture_from_uv, look.normal_texture_from_uv.is_some(), loading);
        read
    }

    fn group(&self, face: usize) -> u32 {
        self.groups.get(face).copied().unwrap_or(0)
    }

    fn posed(&self) -> &ufbx::VertexVec3 {
        let posed = &self.mesh.skinned_position;
        if posed.exists {
            posed
        } else {
            &self.mesh.vertex_position
        }
    }

    fn normals(&self) -> &ufbx::VertexVec3 {
        let posed = &self.mesh.skinned_normal;
        if posed.exists { posed } else { &self.mesh.vertex_normal }
    }

    fn place_index(&self, corner: u32) -> u32 {
        index(&self.posed().indices, corner)
    }

    fn normal_index(&self, corner: u32) -> u32 {
        index(&self.normals().indices, corner)
    }

    /// Places of a face's corners, if they are all there.
    fn places(&self, face: &Face) -> Option<Vec<DVec3>> {
        let values = &self.posed().values;
        let place = |corner| values.get(self.place_index(corner) as usize);
        let vector = |place: &ufbx::Vec3| DVec3::new(place.x, place.y, place.z);
        corners(face).map(|corner| place(corner).map(vector)).collect()
    }

    /// What tells a vertex from others.
    fn key(&self, corner: u32, group: u32, look: &Look<'_>) -> [u32; 6] {
        let normal = self.normal_index(corner);
        let uv = |set: Option<&VertexVec2>| set.map_or(NONE, |set| index(&set.indices, corner));
        let color = look.colors.map_or(NONE, |colors| index(&colors.indices, corner));
        let [first, second] = look.uvs.map(uv);
        let group = if normal == NONE { group } else { 0 };
        [self.place_index(corner), normal, group, first, second, color]
    }

    fn push_vertex(&self, key: [u32; 6], look: &Look<'_>, read: &mut Mesh, broken: &mut Broken) -> u32 {
        let [place, normal, group, first, second, color] = key;
        let at = |list: &[ufbx::Vec3], index: u32| list.get(index as usize).map(|v| DVec3::new(v.x, v.y, v.z));
        let position = at(&self.posed().values, place).unwrap_or_default();
        let normal = match at(&self.normals().values, normal) {
            Some(normal) => normal.try_normalize().map(DVec3::as_vec3).unwrap_or_else(|| {
                broken.normals += 1;
                Vec3::ZERO
            }),
            None => self.smooth.get(&(place, group)).copied().unwrap_or_default(),
        };
        let mut uv = |set: Option<&VertexVec2>, index: u32| {
            // v grows downwards here.
            let found = set.and_then(|set| set.values.get(index as usize));
            let uv = found.map_or(Vec2::ZERO, |uv| Vec2::new(uv.x as f32, 1.0 - uv.y as f32));
            let is_finite = uv.is_finite();
            broken.uvs += usize::from(!is_finite);
            if is_finite { uv } else { Vec2::ZERO }
        };
        read.uvs.push(uv(look.uvs[0], first));
        if look.uvs[1].is_some() {
            read.second_uvs.push(uv(look.uvs[1], second));
        }
        if let Some(colors) = look.colors {
            let found = colors.values.get(color as usize);
            read.colors.push(found.map_or([1.0; 4], linear_color));
        }
        read.positions.push(position);
        read.normals.push(normal);
        read.positions.len() as u32 - 1
    }
}

/// Linear colour of sRGB codes, which programs write into these files; what their alpha means differs.
fn linear_color(color: &ufbx::Vec4) -> [f32; 4] {
    let code = |x: f64| if x.is_finite() { x.max(0.0) as f32 } else { 1.0 };
    let [r, g, b] = linear_from_srgb(vec3(code(color.x), code(color.y), code(color.z))).to_f64();
    [r as f32, g as f32, b as f32, 1.0]
}

fn corners(face: &Face) -> std::ops::Range<u32> {
    face.index_begin..face.index_begin + face.num_indices
}

fn index(indices: &[u32], corner: u32) -> u32 {
    indices.get(corner as usize).copied().unwrap_or(NONE)
}
