//! Meshes as triangles: polygons with values by face, point or corner, and subsets of faces with materials of their own.

use std::collections::HashMap;

use glam::{DVec3, Vec2, Vec3, Vec4};
use openusd::{sdf::Value, usd::Prim, usd::TimeCode};

use super::{kind, material::Slots, scene::value_at, shape::unit_mesh, text_of};
use crate::{
    polygon::{Polygons, doubled_area},
    scene::{Loading, mesh::Mesh, report::Fate, report::ImportReport, texture::TextureTarget},
};

/// Colours of what has no material.
pub const COLORS: &str = "primvars:displayColor";

/// A colour of a vertex, which is finite.
fn as_color([r, g, b]: [f32; 3]) -> [f32; 4] {
    [r, g, b, 1.0].map(|x| if x.is_finite() { x.max(0.0) } else { 1.0 })
}

/// Values, and which of them each corner has.
struct Primvar<T> {
    values: Vec<T>,
    indices: Option<Vec<i32>>,
    by: String,
}

/// Where a value is asked for: the places of the face, of its point and of its corner.
type Corner = [usize; 3];

impl<T: Copy> Primvar<T> {
    /// Of that name in a mesh of so many faces, points and corners.
    fn read(prim: &Prim, name: &str, time: TimeCode, counts: Corner) -> Option<Self>
    where
        Vec<T>: TryFrom<Value>,
    {
        let attribute = prim.attribute(name);
        let values: Vec<T> = value_at(&attribute, time)?.get()?;
        let indices = ints(prim, &format!("{name}:indices"), time);
        let count = indices.as_ref().map_or(values.len(), Vec::len);
        let named = attribute
            .get_metadata::<openusd::tf::Token>("interpolation")
            .ok()
            .flatten();
        // Where it is not said, by their number.
        let by_count = match count {
            count if count == counts[1] => "vertex",
            count if count == counts[2] => "faceVarying",
            count if count == counts[0] => "uniform",
            _ => "constant",
        };
        let by = named.map_or_else(|| by_count.to_owned(), |named| named.to_string());
        (!values.is_empty()).then_some(Self { values, indices, by })
    }

    fn place(&self, [face, point, corner]: Corner) -> usize {
        let place = match &*self.by {
            "constant" => 0,
            "uniform" => face,
            "faceVarying" => corner,
            _ => point,
        };
        match &self.indices {
            Some(indices) => indices.get(place).map_or(usize::MAX, |index| *index as usize),
            None => place,
        }
    }
}

fn ints(prim: &Prim, name: &str, time: TimeCode) -> Option<Vec<i32>> {
    match value_at(&prim.attribute(name), time)? {
        Value::IntVec(numbers) => Some(numbers),
        _ => None,
    }
}

/// The path of the material that a prim is bound to, or the nearest of those above it.
pub fn bound(prim: &Prim) -> Option<String> {
    let of_prim = |prim: Prim| {
        let mut names = ["material:binding:full", "material:binding"].into_iter();
        names.find_map(|name| prim.relationship(name).targets().ok()?.into_iter().next())
    };
    let mut above = prim.path().ancestors();
    above
        .find_map(|path| of_prim(prim.stage().prim(path)))
        .map(|path| path.to_string())
}

/// A shape's mesh in its material, or in its own colour.
pub fn read_shape(prim: &Prim, shape: &str, time: TimeCode, slots: &mut Slots<'_>, report: &mut ImportReport) -> Mesh {
    let material = bound(prim);
    let (slot, _) = slots.slot(material.as_deref(), prim.stage(), report);
    let mut mesh = unit_mesh(shape, slot);
    let painted = slots.get(slot);
    let colors = Primvar::<[f32; 3]>::read(prim, COLORS, time, [0; 3]);
    let colors = colors.filter(|_| material.is_none() || painted.has_vertex_colors);
    if let Some(color) = colors.and_then(|colors| colors.values.first().copied()) {
        painted.color_by_vertices();
        mesh.colors = vec![as_color(color); mesh.positions.len()];
    }
    mesh
}

/// The triangles of a mesh in its space.
pub fn read_mesh(
    prim: &Prim,
    time: TimeCode,
    slots: &mut Slots<'_>,
    report: &mut ImportReport,
    loading: &Loading,
) -> Mesh {
    let name = prim.path().name().unwrap_or_default();
    let points = value_at(&prim.attribute("points"), time).and_then(|value| value.get::<Vec<[f32; 3]>>());
    let counts = ints(prim, "faceVertexCounts", time);
    let (Some(points), Some(counts)) = (points, counts) else {
        report.note(Fate::Ignored, "a mesh without points or faces", name);
        return Mesh::default();
    };
    let corners = ints(prim, "faceVertexIndices", time).unwrap_or_default();
    let points: Vec<DVec3> = points
        .into_iter()
        .map(|p| DVec3::from_array(p.map(f64::from)))
        .collect();
    let is_cage = text_of(&prim.attribute("subdivisionScheme")).is_none_or(|scheme| scheme != "none");
    if is_cage {
        report.note(Fate::Approximated, "a subdivision surface, as its cage", name);
    }
    let all = [counts.len(), points.len(), corners.len()];
    let is_left = text_of(&prim.attribute("orientation")).as_deref() == Some("leftHanded");
    let normals = Primvar::<[f32; 3]>::read(prim, "primvars:normals", time, all)
        .or_else(|| Primvar::read(prim, "normals", time, all))
        .or_else(|| is_cage.then(|| smooth(&points, &counts, &corners, is_left)));
    let colors = Primvar::<[f32; 3]>::read(prim, COLORS, time, all);
    let mut source = Source {
        is_left,
        points,
        corners,
        normals,
        colors,
        uvs: [None, None],
        polygons: Polygons::new(),
        lost: 0,
    };
    let mut whole = Mesh::default();
    for (material, faces) in parts(prim, &counts, time) {
        let (slot, uv_sets) = slots.slot(material.as_deref(), prim.stage(), report);
        let [first, second] = uv_sets;
        source.uvs = [first.or_else(|| Some("st".to_owned())), second].map(|set| {
            let found = Primvar::read(prim, &format!("primvars:{}", set?), time, all);
            found.or_else(|| any_uvs(prim, time, all))
        });
        let painted = slots.get(slot);
        let place = painted.texture(TextureTarget::Normal);
        let has_colors = source.colors.is_some() && (material.is_none() || painted.has_vertex_colors);
        if has_colors {
            painted.color_by_vertices();
            report.note(Fate::Used, "vertex colours", name);
        }
        let mut part = source.part(&faces, slot, has_colors, loading);
        let texture_from_uv = place.map_or([1.0, 0.0, 0.0, 0.0, 1.0, 0.0], |place| place.texture_from_mesh_uv);
        part.repair_normals();
        part.make_tangents(texture_from_uv, place.is_some(), loading);
        whole.append(part);
    }
    source.polygons.report(report);
    report.count(Fate::Ignored, "faces whose vertices are not there", name, source.lost);
    whole
}

/// The first texture coordinates of any name.
fn any_uvs(prim: &Prim, time: TimeCode, all: Corner) -> Option<Primvar<[f32; 2]>> {
    let attributes = prim.attributes().ok()?;
    let mut uvs = attributes.iter().filter(|attribute| {
        let kind = attribute.type_name().ok().flatten();
        kind.is_some_and(|kind| kind == "texCoord2f[]" || kind == "float2[]")
    });
    Primvar::read(prim, uvs.next()?.path().split_property()?.1, time, all)
}

/// Where faces begin among the corners, the number of each and its corners: those that are not holes, by their material.
type Part = (Option<String>, Vec<(usize, std::ops::Range<usize>)>);

fn parts(prim: &Prim, counts: &[i32], time: TimeCode) -> Vec<Part> {
    let mut of_face = vec![0; counts.len()];
    let mut materials = vec![bound(prim)];
    for subset in prim.children().unwrap_or_default() {
        let family = text_of(&subset.attribute("familyName"));
        if kind(&subset) != "GeomSubset" || family.as_deref() != Some("materialBind") {
            continue;
        }
        for face in ints(&subset, "indices", time).unwrap_or_default() {
            if let Some(place) = of_face.get_mut(face as usize) {
                *place = materials.len();
            }
        }
        materials.push(bound(&subset));
    }
    for hole in ints(prim, "holeIndices", time).unwrap_or_default() {
        if let Some(place) = of_face.get_mut(hole as usize) {
            *place = usize::MAX;
        }
    }
    let mut parts: Vec<Part> = materials.into_iter().map(|material| (material, Vec::new())).collect();
    let mut start = 0_usize;
    for (face, (count, place)) in counts.iter().zip(of_face).enumerate() {
        let end = start.saturating_add((*count).max(0) as usize);
        if let Some((_, faces)) = parts.get_mut(place) {
            faces.push((face, start..end));
        }
        start = end;
    }
    parts.retain(|(_, faces)| !faces.is_empty());
    parts
}

/// Normals by point, of the faces around it.
fn smooth(points: &[DVec3], counts: &[i32], corners: &[i32], is_left: bool) -> Primvar<[f32; 3]> {
    let mut sums = vec![DVec3::ZERO; points.len()];
    let mut rest = corners;
    for count in counts {
        let (face, others) = rest.split_at(rest.len().min((*count).max(0) as usize));
        rest = others;
        let places: Option<Vec<DVec3>> = face.iter().map(|point| points.get(*point as usize).copied()).collect();
        let Some(places) = places else { continue };
        let area = doubled_area(&places);
        face.iter().for_each(|point| sums[*point as usize] += area);
    }
    let side = if is_left { -1.0 } else { 1.0 };
    Primvar {
        values: sums
            .into_iter()
            .map(|sum| (side * sum).normalize_or_zero().as_vec3().to_array())
            .collect(),
        indices: None,
        by: "vertex".to_owned(),
    }
}

struct Source {
    is_left: bool,
    points: Vec<DVec3>,
    corners: Vec<i32>,
    normals: Option<Primvar<[f32; 3]>>,
    colors: Option<Primvar<[f32; 3]>>,
    uvs: [Option<Primvar<[f32; 2]>>; 2],
    polygons: Polygons,
    lost: usize,
}

impl Source {
    /// Triangles of some faces, which share a slot.
    fn part(
        &mut self,
        faces: &[(usize, std::ops::Range<usize>)],
        slot: u32,
        has_colors: bool,
        loading: &Loading,
    ) -> Mesh {
        let mut read = Mesh::default();
        let mut known: HashMap<[usize; 5], u32> = HashMap::new();
        for (face, range) in loading.while_wanted(faces.iter()) {
            let own = self.corners.get(range.clone()).unwrap_or_default();
            let places = own.iter().map(|point| self.points.get(*point as usize).copied());
            let places: Option<Vec<DVec3>> = places.collect();
            let Some(places) = places.filter(|places| places.len() > 2) else {
                self.lost += 1;
                continue;
            };
            for triangle in self.polygons.cut(&places).to_vec() {
                let mut triangle = triangle.map(|corner| {
                    let at = [*face, own[corner as usize] as usize, range.start + corner as usize];
                    let [first, second] = &self.uvs;
                    let uv = |set: &Option<Primvar<_>>| set.as_ref().map_or(0, |set| set.place(at));
                    let vector = |set: &Option<Primvar<_>>| set.as_ref().map_or(0, |set| set.place(at));
                    let normal = vector(&self.normals);
                    let color = if has_colors { vector(&self.colors) } else { 0 };
                    let key = [at[1], normal, uv(first), uv(second), color];
                    *known
                        .entry(key)
                        .or_insert_with(|| self.push(key, has_colors, &mut read))
                });
                if self.is_left {
                    triangle.reverse();
                }
                read.triangles.push(triangle);
                read.slots.push(slot);
            }
        }
        read.tangents = vec![Vec4::W; read.positions.len()];
        read
    }

    fn push(&self, [point, normal, first, second, color]: [usize; 5], has_colors: bool, read: &mut Mesh) -> u32 {
        let triple = |set: &Option<Primvar<[f32; 3]>>, place: usize| Some(*set.as_ref()?.values.get(place)?);
        let uv = |set: &Option<Primvar<[f32; 2]>>, place: usize| {
            let found = set.as_ref().and_then(|set| set.values.get(place));
            // v grows downwards here.
            let uv = found.map_or(Vec2::ZERO, |[u, v]| Vec2::new(*u, 1.0 - v));
            if uv.is_finite() { uv } else { Vec2::ZERO }
        };
        read.positions.push(self.points[point]);
        read.normals
            .push(triple(&self.normals, normal).map_or(Vec3::ZERO, Vec3::from_array));
        read.uvs.push(uv(&self.uvs[0], first));
        if self.uvs[1].is_some() {
            read.second_uvs.push(uv(&self.uvs[1], second));
        }
        if has_colors {
            read.colors
                .push(as_color(triple(&self.colors, color).unwrap_or([1.0; 3])));
        }
        read.positions.len() as u32 - 1
    }
}
