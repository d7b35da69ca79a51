//! Meshes: their primitives as triangles, in a pose.

use glam::{DMat3, DMat4, DVec3, Vec2, Vec3, Vec4};
use gltf::json;
use json::mesh::{Mode, MorphTarget, Primitive, Semantic};
use json::validation::Checked;
use serde_json::Value as Json;

use super::compressed::DracoPrimitive;
use super::container::Document;
use super::material::{Materials, UvUse};
use crate::model_error::ModelError;
use crate::scene::mesh::Mesh;
use crate::scene::report::{Fate, ImportReport};
use crate::scene::transform::normal_matrix;

/// Relative imbalance of a surface's area vectors from which it counts as open.
const OPEN: f64 = 0.01;

/// Deformation of a mesh at a node.
#[derive(Clone, Copy, Default)]
pub(super) struct Bending<'a> {
    /// Weights of the morph targets.
    pub weights: &'a [f32],
    /// Joint matrices of the skin.
    pub joints: Option<&'a [DMat4]>,
}

/// Triangles of a mesh, in its own space, or in scene space if skinned; with slots given by `materials`. Unreadable parts
/// are dropped and reported.
pub(super) fn read_mesh(
    document: &Document,
    index: usize,
    bending: Bending<'_>,
    materials: &mut Materials,
    report: &mut ImportReport,
) -> Mesh {
    let mut whole = Mesh::default();
    let Some(source) = document.root.meshes.get(index) else {
        report.note(Fate::Missing, "a mesh that is out of bounds", &format!("mesh {index}"));
        return whole;
    };
    let name = mesh_name(source, index);
    let loading = &document.files.import.loading;
    for (part, primitive) in source.primitives.iter().enumerate() {
        if loading.check().is_err() {
            break;
        }
        let raw = &document.raw["meshes"][index]["primitives"][part];
        match read_primitive(document, primitive, raw, &name, bending, materials, report) {
            Ok(mesh) if !mesh.triangles.is_empty() => whole.append(mesh),
            Ok(_) => report.note(Fate::Ignored, "a primitive without triangles", &name),
            Err(error) => {
                let reason = match &error {
                    ModelError::Invalid { reason, .. } => reason.clone(),
                    other => other.to_string(),
                };
                report.note(
                    Fate::Ignored,
                    format!("a primitive that cannot be read ({reason})"),
                    &name,
                );
            }
        }
    }
    if is_open(&whole, |slot| materials.is_one_sided(slot)) {
        let what = "open surfaces that the file shows from their front alone, seen from both sides";
        report.note(Fate::Approximated, what, &name);
    }
    whole
}

/// Whether the triangles of the chosen slots are certainly not a closed surface: a closed one's area vectors sum to zero.
fn is_open(mesh: &Mesh, is_chosen: impl Fn(u32) -> bool) -> bool {
    let (mut sum, mut total) = (DVec3::ZERO, 0.0);
    for triangle in (0..mesh.triangles.len()).filter(|triangle| is_chosen(mesh.slots[*triangle])) {
        let [a, b, c] = mesh.corners(triangle);
        let area = (b - a).cross(c - a);
        if area.is_finite() {
            sum += area;
            total += area.length();
        }
    }
    sum.length() > OPEN * total
}

/// Whether a mesh is said to have triangles with places, or is not there at all.
pub(super) fn has_triangles(document: &Document, mesh: usize) -> bool {
    let Some(mesh) = document.root.meshes.get(mesh) else {
        return true;
    };
    let has_places = |primitive: &Primitive| primitive.attributes.contains_key(&Checked::Valid(Semantic::Positions));
    let mut primitives = mesh.primitives.iter();
    primitives.any(|primitive| triangle_mode(primitive).is_some() && has_places(primitive))
}

/// Triangle mode of a primitive; `None` for points and lines.
fn triangle_mode(primitive: &Primitive) -> Option<Mode> {
    match primitive.mode {
        Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => Some(mode),
        _ => None,
    }
}

fn mesh_name(mesh: &json::Mesh, index: usize) -> String {
    match &mesh.name {
        Some(name) => format!("mesh \"{name}\""),
        None => format!("mesh {index}"),
    }
}

fn read_primitive(
    document: &Document,
    primitive: &Primitive,
    raw: &Json,
    name: &str,
    bending: Bending<'_>,
    materials: &mut Materials,
    report: &mut ImportReport,
) -> Result<Mesh, ModelError> {
    let Some(mode) = triangle_mode(primitive) else {
        report.note(Fate::Ignored, "points and lines", name);
        return Ok(Mesh::default());
    };
    let draco = DracoPrimitive::read(document, raw)
        .transpose()
        .map_err(|reason| document.invalid(format!("its Draco data: {reason}")))?;
    if draco.is_some() {
        report.note(Fate::Used, "primitives with Draco compression", name);
    }
    let material = materials.of_primitive(primitive, raw);
    let slot = materials.slot(material);
    let reader = Reader {
        document,
        primitive,
        draco,
        name,
    };
    let mesh = reader.read(mode, slot, &materials.uvs(slot), bending, report)?;
    if !mesh.colors.is_empty() {
        let has_alpha = mesh.colors.iter().any(|[_, _, _, alpha]| *alpha < 1.0);
        materials.has_vertex_colors(slot, has_alpha);
        report.note(Fate::Used, "vertex colours", name);
    }
    Ok(mesh)
}

struct Reader<'a> {
    document: &'a Document,
    primitive: &'a Primitive,
    draco: Option<DracoPrimitive>,
    /// For messages.
    name: &'a str,
}

impl Reader<'_> {
    fn read(
        &self,
        mode: Mode,
        slot: u32,
        uv_use: &UvUse,
        bending: Bending<'_>,
        report: &mut ImportReport,
    ) -> Result<Mesh, ModelError> {
        let mut positions: Vec<[f32; 3]> = self.vectors(&Semantic::Positions)?.unwrap_or_default();
        let count = positions.len();
        let mut normals: Option<Vec<[f32; 3]>> = self.optional(&Semantic::Normals, count, report);
        let mut tangents: Option<Vec<[f32; 4]>> = self.optional(&Semantic::Tangents, count, report);
        let [uvs, second_uvs] = uv_use.sets.map(|set| self.uvs(set, count, report));
        self.morph(bending.weights, &mut positions, &mut normals, &mut tangents, report);
        let triangles = self.triangles(mode, count, report)?;
        let mut mesh = Mesh {
            positions: positions
                .into_iter()
                .map(|p| DVec3::from_array(p.map(f64::from)))
                .collect(),
            normals: vec![Vec3::ZERO; count],
            uvs: uvs.unwrap_or_else(|| vec![Vec2::ZERO; count]),
            second_uvs: second_uvs.unwrap_or_default(),
            colors: self.colors(count, report),
            tangents: vec![Vec4::W; count],
            slots: vec![slot; triangles.len()],
            triangles,
        };
        let has_normals = normals.is_some();
        if let Some(normals) = normals {
            mesh.normals = normals.into_iter().map(Vec3::from_array).collect();
        }
        // The format ignores tangents without normals.
        let tangents = tangents.filter(|_| has_normals);
        let has_tangents = tangents.is_some();
        if let Some(tangents) = tangents {
            mesh.tangents = tangents.into_iter().map(Vec4::from_array).collect();
        }
        if let Some(joints) = bending.joints {
            self.skin(joints, &mut mesh, report);
        }
        if has_normals {
            let replaced = mesh.repair_normals();
            report.count(
                Fate::Approximated,
                "normals without a length, taken from triangles",
                self.name,
                replaced,
            );
        }
        if !has_tangents {
            let loading = &self.document.files.import.loading;
            mesh.make_tangents(uv_use.normal_texture_from_uv, uv_use.has_normal_texture, loading);
        }
        Ok(mesh)
    }

    fn accessor(&self, semantic: &Semantic) -> Option<usize> {
        let attributes = &self.primitive.attributes;
        attributes
            .get(&Checked::Valid(semantic.clone()))
            .map(|accessor| accessor.value())
    }

    fn vectors<const N: usize>(&self, semantic: &Semantic) -> Result<Option<Vec<[f32; N]>>, ModelError> {
        let name = semantic.to_string();
        if let Some(found) = self.draco.as_ref().and_then(|draco| draco.attribute(&name)) {
            return Ok(Some(found));
        }
        self.accessor(semantic)
            .map(|accessor| self.document.read_vectors(accessor, &name))
            .transpose()
    }

    /// An attribute that must have one value a vertex, else it is left out.
    fn optional<const N: usize>(
        &self,
        semantic: &Semantic,
        count: usize,
        report: &mut ImportReport,
    ) -> Option<Vec<[f32; N]>> {
        let read = self.vectors(semantic);
        self.one_a_vertex(read, semantic, count, report)
    }

    /// The values, if there is one per vertex.
    fn one_a_vertex<T>(
        &self,
        read: Result<Option<Vec<T>>, ModelError>,
        semantic: &Semantic,
        count: usize,
        report: &mut ImportReport,
    ) -> Option<Vec<T>> {
        let what = semantic.to_string();
        match read {
            Ok(Some(values)) if values.len() != count => {
                let what = format!("{what}: {} values for {count} vertices", values.len());
                report.note(Fate::Ignored, what, self.name);
                None
            }
            Ok(values) => values,
            Err(_) => {
                report.note(Fate::Missing, format!("{what} that cannot be read"), self.name);
                None
            }
        }
    }

    /// A set of texture coordinates, if used and present.
    fn uvs(&self, set: Option<u32>, count: usize, report: &mut ImportReport) -> Option<Vec<Vec2>> {
        let uvs: Option<Vec<[f32; 2]>> = self.optional(&Semantic::TexCoords(set?), count, report);
        let broken = uvs.iter().flatten().filter(|[u, v]| !(u.is_finite() && v.is_finite()));
        report.count(
            Fate::Ignored,
            "texture coordinates that are not finite",
            self.name,
            broken.count(),
        );
        uvs.map(|uvs| uvs.into_iter().map(finite_uv).collect())
    }

    /// Linear colours and opacities; empty if absent.
    fn colors(&self, count: usize, report: &mut ImportReport) -> Vec<[f32; 4]> {
        let semantic = Semantic::Colors(0);
        let read = match self.draco.as_ref().and_then(|draco| draco.attribute("COLOR_0")) {
            Some(found) => Ok(Some(found)),
            None => self
                .accessor(&semantic)
                .map(|accessor| self.document.read_colors(accessor, "COLOR_0"))
                .transpose(),
        };
        let colors = self.one_a_vertex(read, &semantic, count, report).unwrap_or_default();
        let usable = |x: f32| if x.is_finite() { x.max(0.0) } else { 1.0 };
        colors.into_iter().map(|color| color.map(usable)).collect()
    }

    /// Adds the morph targets.
    fn morph(
        &self,
        weights: &[f32],
        positions: &mut [[f32; 3]],
        normals: &mut Option<Vec<[f32; 3]>>,
        tangents: &mut Option<Vec<[f32; 4]>>,
        report: &mut ImportReport,
    ) {
        let targets: &[MorphTarget] = self.primitive.targets.as_deref().unwrap_or_default();
        for (target, &weight) in targets.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            let mut add = |accessor: Option<usize>, place: &mut dyn FnMut(usize, [f32; 3])| {
                let Some(accessor) = accessor else { return };
                match self.document.read_vectors::<3>(accessor, "a morph target") {
                    Ok(steps) => steps
                        .into_iter()
                        .enumerate()
                        .for_each(|(vertex, step)| place(vertex, step)),
                    Err(_) => report.note(Fate::Missing, "a morph target that cannot be read", self.name),
                }
            };
            let mix = |value: &mut [f32], step: [f32; 3]| {
                value
                    .iter_mut()
                    .zip(step)
                    .for_each(|(value, step)| *value += weight * step);
            };
            add(
                target.positions.map(|accessor| accessor.value()),
                &mut |vertex, step| {
                    positions.get_mut(vertex).into_iter().for_each(|value| mix(value, step));
                },
            );
            add(target.normals.map(|accessor| accessor.value()), &mut |vertex, step| {
                let value = normals.as_mut().and_then(|normals| normals.get_mut(vertex));
                value.into_iter().for_each(|value| mix(value, step));
            });
            add(target.tangents.map(|accessor| accessor.value()), &mut |vertex, step| {
                let value = tangents.as_mut().and_then(|tangents| tangents.get_mut(vertex));
                value.into_iter().for_each(|value| mix(&mut value[..3], step));
            });
        }
        if !targets.is_empty() {
            report.note(Fate::Used, "morph targets", self.name);
        }
    }

    /// Moves vertices with the joints that they are bound to.
    fn skin(&self, joints: &[DMat4], mesh: &mut Mesh, report: &mut ImportReport) {
        let count = mesh.positions.len();
        let mut sums = vec![DMat4::ZERO; count];
        let mut totals = vec![0.0_f64; count];
        for set in 0..2 {
            let semantic = Semantic::Joints(set);
            let read = match self
                .draco
                .as_ref()
                .and_then(|draco| draco.attribute(&semantic.to_string()))
            {
                Some(found) => Ok(Some(found.into_iter().map(|j: [f32; 4]| j.map(|x| x as u32)).collect())),
                None => self
                    .accessor(&semantic)
                    .map(|accessor| self.document.read_unsigned::<4>(accessor, "JOINTS"))
                    .transpose(),
            };
            let bound = self.one_a_vertex(read, &semantic, count, report);
            let weights = self.optional::<4>(&Semantic::Weights(set), count, report);
            let (Some(bound), Some(weights)) = (bound, weights) else {
                continue;
            };
            for (vertex, (bound, weights)) in bound.iter().zip(&weights).enumerate() {
                for (joint, weight) in bound.iter().zip(weights).filter(|(_, weight)| **weight > 0.0) {
                    if let Some(joint) = joints.get(*joint as usize) {
                        sums[vertex] += *joint * f64::from(*weight);
                        totals[vertex] += f64::from(*weight);
                    }
                }
            }
        }
        for vertex in 0..count {
            if totals[vertex] <= 0.0 {
                continue;
            }
            let moved = sums[vertex] * totals[vertex].recip();
            let linear = DMat3::from_mat4(moved);
            mesh.positions[vertex] = moved.transform_point3(mesh.positions[vertex]);
            mesh.normals[vertex] = (normal_matrix(linear) * mesh.normals[vertex].as_dvec3())
                .normalize_or_zero()
                .as_vec3();
            let tangent = mesh.tangents[vertex];
            let direction = (linear * tangent.truncate().as_dvec3()).normalize_or_zero().as_vec3();
            mesh.tangents[vertex] = direction.extend(tangent.w);
        }
        report.note(Fate::Used, "skinned meshes", self.name);
    }

    /// The triangles whose vertices are there.
    fn triangles(&self, mode: Mode, count: usize, report: &mut ImportReport) -> Result<Vec<[u32; 3]>, ModelError> {
        let mut triangles = match (&self.draco, self.primitive.indices) {
            // Draco always produces triangle lists.
            (Some(draco), _) => triangles(Mode::Triangles, &draco.indices()),
            (None, Some(accessor)) => triangles(mode, &self.document.read_indices(accessor.value())?),
            (None, None) => triangles(mode, &(0..count as u32).collect::<Vec<_>>()),
        };
        let all = triangles.len();
        let last = triangles.iter().flatten().copied().max();
        if last.is_some_and(|last| last as usize >= count) {
            triangles.retain(|triangle| triangle.iter().all(|&vertex| (vertex as usize) < count));
            let what = format!(
                "triangles whose vertices are not there (index {} of {count} vertices)",
                last.unwrap_or(0)
            );
            report.count(Fate::Ignored, what, self.name, all - triangles.len());
        }
        Ok(triangles)
    }
}

/// Texture coordinates that are not numbers would only spread.
fn finite_uv(uv: [f32; 2]) -> Vec2 {
    let uv = Vec2::from_array(uv);
    if uv.is_finite() { uv } else { Vec2::ZERO }
}

/// The triangles of a list, strip or fan; a rest too short for one is left out.
fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => {
            let odd = |(i, w): (usize, &[u32])| {
                if i % 2 == 0 {
                    [w[0], w[1], w[2]]
                } else {
                    [w[0], w[2], w[1]]
                }
            };
            indices.windows(3).enumerate().map(odd).collect()
        }
        Mode::TriangleFan => indices
            .split_first()
            .map(|(hub, rim)| rim.windows(2).map(|w| [w[0], w[1], *hub]).collect())
            .unwrap_or_default(),
        _ => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
    }
}
