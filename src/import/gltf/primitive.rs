//! Meshes: their primitives as triangles, in a pose.

use glam::{DMat3, DMat4, DVec3, Vec2, Vec3, Vec4};

use super::{compressed::DracoPrimitive, container::Document, json::Primitive, material::Materials, material::UvUse};
use crate::scene::{mesh::Mesh, report::Fate, report::ImportReport, transform::normal_matrix};

/// Relative imbalance of a surface's area vectors from which it counts as open.
const OPEN: f64 = 0.01;
/// Modes of primitives of triangles.
const TRIANGLES: u32 = 4;
const STRIP: u32 = 5;
const FAN: u32 = 6;

/// Deformation of a mesh at a node.
#[derive(Clone, Copy, Default)]
pub struct Bending<'a> {
    /// Weights of the morph targets.
    pub weights: &'a [f32],
    /// Joint matrices of the skin.
    pub joints: Option<&'a [DMat4]>,
}

/// Triangles of a mesh, in its own space, or in scene space if skinned; with slots given by `materials`. Unreadable parts
/// are dropped and reported.
pub fn read_mesh(
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
    let name = match &source.name {
        Some(name) => format!("mesh \"{name}\""),
        None => format!("mesh {index}"),
    };
    let loading = &document.files.import.loading;
    for primitive in source.primitives.iter().take_while(|_| loading.check().is_ok()) {
        match read_primitive(document, primitive, &name, bending, materials, report) {
            Ok(mesh) if !mesh.triangles.is_empty() => whole.append(mesh),
            Ok(_) => report.note(Fate::Ignored, "a primitive without triangles", &name),
            Err(reason) => {
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

fn read_primitive(
    document: &Document,
    primitive: &Primitive,
    name: &str,
    bending: Bending<'_>,
    materials: &mut Materials,
    report: &mut ImportReport,
) -> Result<Mesh, String> {
    let mode = primitive.mode.unwrap_or(TRIANGLES);
    if !(TRIANGLES..=FAN).contains(&mode) {
        report.note(Fate::Ignored, "points and lines", name);
        return Ok(Mesh::default());
    }
    let draco = DracoPrimitive::read(document, primitive)
        .transpose()
        .map_err(|reason| format!("its Draco data: {reason}"))?;
    if draco.is_some() {
        report.note(Fate::Used, "primitives with Draco compression", name);
    }
    let slot = materials.slot(materials.of_primitive(primitive));
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
        mode: u32,
        slot: u32,
        uv_use: &UvUse,
        bending: Bending<'_>,
        report: &mut ImportReport,
    ) -> Result<Mesh, String> {
        let mut positions: Vec<[f32; 3]> = self.vectors("POSITION")?.unwrap_or_default();
        let count = positions.len();
        let mut normals: Option<Vec<[f32; 3]>> = self.optional("NORMAL", count, report);
        // The format ignores tangents without normals.
        let tangents: Option<Vec<[f32; 4]>> = self.optional("TANGENT", count, report);
        let mut tangents = tangents.filter(|_| normals.is_some());
        let [uvs, second_uvs] = uv_use.sets.map(|set| self.uvs(set, count, report));
        self.morph(
            bending.weights,
            (&mut positions, normals.as_deref_mut(), tangents.as_deref_mut()),
            report,
        );
        let triangles = self.triangles(mode, count)?;
        let (has_normals, has_tangents) = (normals.is_some(), tangents.is_some());
        let of_all = |normals: Vec<[f32; 3]>| normals.into_iter().map(Vec3::from_array).collect();
        let mut mesh = Mesh {
            positions: positions
                .into_iter()
                .map(|p| DVec3::from_array(p.map(f64::from)))
                .collect(),
            normals: normals.map_or_else(|| vec![Vec3::ZERO; count], of_all),
            uvs: uvs.unwrap_or_else(|| vec![Vec2::ZERO; count]),
            second_uvs: second_uvs.unwrap_or_default(),
            colors: self.colors(count, report),
            tangents: match tangents {
                Some(tangents) => tangents.into_iter().map(Vec4::from_array).collect(),
                None => vec![Vec4::W; count],
            },
            slots: vec![slot; triangles.len()],
            triangles,
        };
        if let Some(joints) = bending.joints {
            self.skin(joints, &mut mesh, report);
        }
        if has_normals {
            let what = "normals without a length, taken from triangles";
            report.count(Fate::Approximated, what, self.name, mesh.repair_normals());
        }
        if !has_tangents {
            let loading = &self.document.files.import.loading;
            mesh.make_tangents(uv_use.normal_texture_from_uv, uv_use.has_normal_texture, loading);
        }
        Ok(mesh)
    }

    fn vectors<const N: usize>(&self, semantic: &str) -> Result<Option<Vec<[f32; N]>>, String> {
        if let Some(found) = self.draco.as_ref().and_then(|draco| draco.attribute(semantic)) {
            return Ok(Some(found));
        }
        let accessor = self.primitive.attributes.get(semantic);
        accessor
            .map(|accessor| self.document.read_vectors(*accessor, semantic))
            .transpose()
    }

    /// An attribute that must have one value a vertex, else it is left out.
    fn optional<const N: usize>(&self, what: &str, count: usize, report: &mut ImportReport) -> Option<Vec<[f32; N]>> {
        match self.vectors(what) {
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

    /// A set of texture coordinates, if used and present. Those that are not numbers would only spread.
    fn uvs(&self, set: Option<u32>, count: usize, report: &mut ImportReport) -> Option<Vec<Vec2>> {
        let uvs: Vec<[f32; 2]> = self.optional(&format!("TEXCOORD_{}", set?), count, report)?;
        let mut uvs: Vec<Vec2> = uvs.into_iter().map(Vec2::from_array).collect();
        let what = "texture coordinates that are not finite";
        for uv in uvs.iter_mut().filter(|uv| !uv.is_finite()) {
            *uv = Vec2::ZERO;
            report.note(Fate::Ignored, what, self.name);
        }
        Some(uvs)
    }

    /// Linear colours and opacities; empty if absent.
    fn colors(&self, count: usize, report: &mut ImportReport) -> Vec<[f32; 4]> {
        let colors = self.optional::<4>("COLOR_0", count, report).unwrap_or_default();
        let usable = |x: f32| if x.is_finite() { x.max(0.0) } else { 1.0 };
        colors.into_iter().map(|color| color.map(usable)).collect()
    }

    /// Adds the morph targets to positions, normals and tangents.
    #[expect(clippy::type_complexity, reason = "three slices")]
    fn morph(
        &self,
        weights: &[f32],
        (positions, normals, tangents): (&mut [[f32; 3]], Option<&mut [[f32; 3]]>, Option<&mut [[f32; 4]]>),
        report: &mut ImportReport,
    ) {
        fn add<const N: usize>(values: &mut [[f32; N]], steps: &[[f32; 3]], weight: f32) {
            for (value, step) in values.iter_mut().zip(steps) {
                value
                    .iter_mut()
                    .zip(step)
                    .for_each(|(value, step)| *value += weight * step);
            }
        }
        let (normals, tangents) = (normals.unwrap_or_default(), tangents.unwrap_or_default());
        let targets = &self.primitive.targets;
        for (target, &weight) in targets.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            let mut steps = |semantic: &str| {
                let accessor = target.get(semantic);
                let read = accessor.map(|accessor| self.document.read_vectors::<3>(*accessor, "a morph target"));
                read.transpose().unwrap_or_else(|_| {
                    report.note(Fate::Missing, "a morph target that cannot be read", self.name);
                    None
                })
            };
            add(positions, &steps("POSITION").unwrap_or_default(), weight);
            add(normals, &steps("NORMAL").unwrap_or_default(), weight);
            add(tangents, &steps("TANGENT").unwrap_or_default(), weight);
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
            let bound = self.optional::<4>(&format!("JOINTS_{set}"), count, report);
            let weights = self.optional::<4>(&format!("WEIGHTS_{set}"), count, report);
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

    fn triangles(&self, mode: u32, count: usize) -> Result<Vec<[u32; 3]>, String> {
        let triangles = match (&self.draco, self.primitive.indices) {
            // Draco always produces triangle lists.
            (Some(draco), _) => triangles(TRIANGLES, &draco.indices()),
            (None, Some(accessor)) => triangles(mode, &self.document.read_indices(accessor)?),
            (None, None) => triangles(mode, &(0..count as u32).collect::<Vec<_>>()),
        };
        match triangles.iter().flatten().max() {
            Some(last) if *last as usize >= count => Err(format!("index {last} of {count} vertices")),
            _ => Ok(triangles),
        }
    }
}

/// The triangles of a list, strip or fan; a rest too short for one is left out.
fn triangles(mode: u32, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        STRIP => {
            let odd = |(i, w): (usize, &[u32])| {
                if i % 2 == 0 {
                    [w[0], w[1], w[2]]
                } else {
                    [w[0], w[2], w[1]]
                }
            };
            indices.windows(3).enumerate().map(odd).collect()
        }
        FAN => indices
            .split_first()
            .map(|(hub, rim)| rim.windows(2).map(|w| [w[0], w[1], *hub]).collect())
            .unwrap_or_default(),
        _ => indices.as_chunks::<3>().0.to_vec(),
    }
}
