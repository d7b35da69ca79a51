//! glTF 2.0 files (.gltf and .glb): the meshes of the default scene in their rest pose, with their materials.
//!
//! The gltf crate parses and validates the JSON; buffers are read by [`accessor`], which checks every range before it
//! reads, since a damaged file must give an error and never a panic.

mod accessor;
mod container;
mod material;
mod primitive;

use std::path::Path;

use glam::{DMat3, DMat4, DQuat, DVec3};
use gltf::json;

use self::container::Document;
use self::material::Materials;
use super::geometry::Framing;
use super::mesh::Mesh;
use super::model::{Model, ModelError};

/// More vertices than this are refused, so that indices of 32 bits suffice with the ground and split vertices added.
const MAX_VERTICES: usize = 1 << 31;

/// Loads a .gltf or .glb file.
pub(super) fn load(path: &Path) -> Result<Model, ModelError> {
    let document = Document::read(path)?;
    let mut materials = Materials::new(&document);
    let mut warnings = general_warnings(&document.root);
    let mut meshes: Vec<Option<Mesh>> = vec![None; document.root.meshes.len()];
    let mut whole = Mesh::default();
    for (mesh_index, world_from_node) in mesh_nodes(&document)? {
        let local = match meshes[mesh_index].take() {
            Some(mesh) => mesh,
            None => primitive::read_mesh(&document, mesh_index, &mut materials, &mut warnings)?,
        };
        if whole.positions.len() + local.positions.len() > MAX_VERTICES {
            return Err(document.invalid(format!("its scene has more than {MAX_VERTICES} vertices")));
        }
        whole.append(transformed(local.clone(), world_from_node));
        meshes[mesh_index] = Some(local);
    }
    if whole.triangles.is_empty() {
        return Err(ModelError::NoTriangles { path: path.to_owned() });
    }
    warnings.append(&mut materials.warnings);
    let (mut slots, textures) = materials.finish()?;
    let world_units_per_unit = Framing::of(&whole).world_units_per_unit as f32;
    for slot in &mut slots {
        slot.attenuation_distance /= world_units_per_unit;
    }
    warnings.dedup();
    let name = path
        .file_stem()
        .map_or_else(|| "model".into(), |stem| stem.to_string_lossy().into_owned());
    Ok(Model {
        name,
        mesh: whole,
        slots,
        textures,
        warnings,
    })
}

/// What the file has that is left out as a whole.
fn general_warnings(root: &json::Root) -> Vec<String> {
    let mut warnings = Vec::new();
    if !root.animations.is_empty() {
        warnings.push("animations are left out: the model is shown at rest".to_owned());
    }
    if root.nodes.iter().any(|node| node.skin.is_some()) {
        warnings.push("skinning is left out: the model is shown in its bind pose".to_owned());
    }
    let unknown = root
        .extensions_used
        .iter()
        .filter(|name| !container::UNDERSTOOD.contains(&name.as_str()));
    let unknown: Vec<&str> = unknown.map(String::as_str).collect();
    if !unknown.is_empty() {
        warnings.push(format!("optional extensions left out: {}", unknown.join(", ")));
    }
    warnings
}

/// The meshes of the scene, each with the transform of its node.
fn mesh_nodes(document: &Document) -> Result<Vec<(usize, DMat4)>, ModelError> {
    let root = &document.root;
    let mut found = Vec::new();
    let mut seen = vec![false; root.nodes.len()];
    let mut open: Vec<(usize, DMat4)> = scene_roots(root)
        .into_iter()
        .map(|node| (node, DMat4::IDENTITY))
        .collect();
    open.reverse();
    while let Some((index, world_from_parent)) = open.pop() {
        if std::mem::replace(&mut seen[index], true) {
            return Err(document.invalid(format!("node {index} is in its scene twice, or is its own ancestor")));
        }
        let node = &root.nodes[index];
        let world_from_node = world_from_parent * parent_from_node(node);
        found.extend(node.mesh.map(|mesh| (mesh.value(), world_from_node)));
        let children = node.children.iter().flatten().rev();
        open.extend(children.map(|child| (child.value(), world_from_node)));
    }
    Ok(found)
}

/// The topmost nodes of the default scene; of the first where none is the default; all topmost nodes where there is no
/// scene.
fn scene_roots(root: &json::Root) -> Vec<usize> {
    let scene = root.scene.map_or(0, |scene| scene.value());
    if let Some(scene) = root.scenes.get(scene) {
        return scene.nodes.iter().map(|node| node.value()).collect();
    }
    let mut is_child = vec![false; root.nodes.len()];
    for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
        is_child[child.value()] = true;
    }
    (0..root.nodes.len()).filter(|&node| !is_child[node]).collect()
}

fn parent_from_node(node: &json::Node) -> DMat4 {
    if let Some(matrix) = node.matrix {
        return DMat4::from_cols_array(&matrix.map(f64::from));
    }
    let vector = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    let rotation = node.rotation.map_or(DQuat::IDENTITY, |rotation| {
        let rotation = DQuat::from_array(rotation.0.map(f64::from));
        if rotation.length_squared() > 0.0 {
            rotation.normalize()
        } else {
            DQuat::IDENTITY
        }
    });
    DMat4::from_scale_rotation_translation(
        vector(node.scale.unwrap_or([1.0; 3])),
        rotation,
        vector(node.translation.unwrap_or_default()),
    )
}

/// A mesh moved by a node's transform. One that mirrors turns the triangles round, so that they still face outwards.
fn transformed(mut mesh: Mesh, world_from_node: DMat4) -> Mesh {
    let linear = DMat3::from_mat4(world_from_node);
    let mirrors = linear.determinant() < 0.0;
    let normals_from = normal_matrix(linear);
    for position in &mut mesh.positions {
        *position = world_from_node.transform_point3(*position);
    }
    for normal in &mut mesh.normals {
        *normal = (normals_from * normal.as_dvec3()).as_vec3();
    }
    for tangent in &mut mesh.tangents {
        let direction = (linear * tangent.truncate().as_dvec3()).normalize_or_zero().as_vec3();
        *tangent = direction.extend(if mirrors { -tangent.w } else { tangent.w });
    }
    if mirrors {
        mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    mesh.repair_normals();
    mesh
}

/// What normals are multiplied by, up to a positive factor: the inverse transpose, as the matrix of cofactors so that
/// one that flattens the mesh works too.
fn normal_matrix(linear: DMat3) -> DMat3 {
    let largest = linear
        .to_cols_array()
        .into_iter()
        .fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
    let scaled = if largest > 0.0 {
        linear * largest.recip()
    } else {
        linear
    };
    let (x, y, z) = (scaled.x_axis, scaled.y_axis, scaled.z_axis);
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    if scaled.determinant() < 0.0 {
        -cofactors
    } else {
        cofactors
    }
}
