//! Meshes: their primitives as triangles.

use glam::{DVec3, Vec2, Vec3, Vec4};
use gltf::json;
use json::mesh::{Mode, Primitive, Semantic};
use json::validation::Checked;

use super::container::Document;
use super::material::{Materials, UvUse};
use crate::scene::mesh::Mesh;
use crate::scene::model::ModelError;

/// The triangles of a mesh in its own space, with slots given by `materials`.
pub(super) fn read_mesh(
    document: &Document,
    index: usize,
    materials: &mut Materials,
    warnings: &mut Vec<String>,
) -> Result<Mesh, ModelError> {
    let mut whole = Mesh::default();
    let source = &document.root.meshes[index];
    for (part, primitive) in source.primitives.iter().enumerate() {
        let place = match &source.name {
            Some(name) => format!("mesh \"{name}\""),
            None => format!("mesh {index}"),
        };
        if primitive.targets.as_ref().is_some_and(|targets| !targets.is_empty()) {
            warnings.push(format!("{place}: morph targets are left out"));
        }
        if attribute(primitive, &Semantic::Colors(0)).is_some() {
            warnings.push(format!("{place}: vertex colours are left out"));
        }
        let Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) = primitive.mode else {
            warnings.push(format!("{place}: points and lines are left out"));
            continue;
        };
        let slot = materials.slot(primitive.material.map(|material| material.value()));
        let uvs = materials.uvs(slot);
        let mesh = Reader {
            document,
            primitive,
            place: format!("{place}, primitive {part}"),
        };
        whole.append(mesh.read(mode, slot, &uvs)?);
    }
    Ok(whole)
}

fn attribute(primitive: &Primitive, semantic: &Semantic) -> Option<usize> {
    primitive
        .attributes
        .get(&Checked::Valid(semantic.clone()))
        .map(|accessor| accessor.value())
}

struct Reader<'a> {
    document: &'a Document,
    primitive: &'a Primitive,
    /// For messages.
    place: String,
}

impl Reader<'_> {
    fn read(&self, mode: Mode, slot: u32, uv_use: &UvUse) -> Result<Mesh, ModelError> {
        let positions: Vec<[f32; 3]> = self.vectors(&Semantic::Positions, "POSITION")?.unwrap_or_default();
        let count = positions.len();
        let normals: Option<Vec<[f32; 3]>> = self.optional(&Semantic::Normals, "NORMAL", count)?;
        let tangents: Option<Vec<[f32; 4]>> = self.optional(&Semantic::Tangents, "TANGENT", count)?;
        let [uvs, second_uvs] = uv_use.sets.map(|set| self.uvs(set, count));
        let triangles = triangles(mode, &self.indices(count)?);
        let mut mesh = Mesh {
            positions: positions
                .into_iter()
                .map(|p| DVec3::from_array(p.map(f64::from)))
                .collect(),
            normals: vec![Vec3::ZERO; count],
            uvs: uvs?.unwrap_or_else(|| vec![Vec2::ZERO; count]),
            second_uvs: second_uvs?.unwrap_or_default(),
            tangents: vec![Vec4::W; count],
            slots: vec![slot; triangles.len()],
            triangles,
        };
        match normals {
            Some(normals) => {
                mesh.normals = normals.into_iter().map(Vec3::from_array).collect();
                mesh.repair_normals();
            }
            None => mesh.flatten(),
        }
        // The format has tangents ignored where there are no normals.
        match tangents.filter(|tangents| tangents.len() == mesh.normals.len()) {
            Some(tangents) if attribute(self.primitive, &Semantic::Normals).is_some() => {
                mesh.tangents = tangents.into_iter().map(Vec4::from_array).collect();
            }
            _ => mesh.generate_tangents(uv_use.normal_texture_from_uv),
        }
        Ok(mesh)
    }

    fn vectors<const N: usize>(&self, semantic: &Semantic, what: &str) -> Result<Option<Vec<[f32; N]>>, ModelError> {
        let what = format!("{what} of {}", self.place);
        attribute(self.primitive, semantic)
            .map(|accessor| self.document.read_vectors(accessor, &what))
            .transpose()
    }

    /// An attribute that must have one value a vertex.
    fn optional<const N: usize>(
        &self,
        semantic: &Semantic,
        what: &str,
        count: usize,
    ) -> Result<Option<Vec<[f32; N]>>, ModelError> {
        let values = self.vectors(semantic, what)?;
        match values.as_ref().map(Vec::len) {
            Some(actual) if actual != count => {
                Err(self.invalid(format!("{actual} {what} values for {count} vertices")))
            }
            _ => Ok(values),
        }
    }

    /// A set of texture coordinates, where one is wanted and there.
    fn uvs(&self, set: Option<u32>, count: usize) -> Result<Option<Vec<Vec2>>, ModelError> {
        let Some(set) = set else { return Ok(None) };
        let uvs: Option<Vec<[f32; 2]>> = self.optional(&Semantic::TexCoords(set), "TEXCOORD", count)?;
        Ok(uvs.map(|uvs| uvs.into_iter().map(finite_uv).collect()))
    }

    /// The order of vertices, every one in range.
    fn indices(&self, count: usize) -> Result<Vec<u32>, ModelError> {
        let Some(accessor) = self.primitive.indices else {
            return Ok((0..count as u32).collect());
        };
        let indices = self.document.read_indices(accessor.value())?;
        match indices.iter().find(|&&index| index as usize >= count) {
            Some(index) => Err(self.invalid(format!("index {index} where there are {count} vertices"))),
            None => Ok(indices),
        }
    }

    fn invalid(&self, reason: String) -> ModelError {
        self.document.invalid(format!("{}: {reason}", self.place))
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
