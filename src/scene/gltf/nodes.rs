//! The nodes of the scene with what hangs on them: meshes, their instances, cameras and lights.

use glam::{DMat4, DVec3};
use gltf::json;
use serde_json::Value as Json;

use super::container::Document;
use super::pose::{Pose, root_nodes, unit_rotation};
use crate::scene::model::{LightKind, ModelCamera, ModelLight};
use crate::scene::report::{Fate, ImportReport};

/// The most instances of one node.
const INSTANCES_MAX: usize = 1 << 20;

/// A mesh at a place in the scene.
pub(super) struct MeshNode {
    pub mesh: usize,
    pub node: usize,
    pub world_from_node: DMat4,
}

/// What is in the scene.
#[derive(Default)]
pub(super) struct Contents {
    pub meshes: Vec<MeshNode>,
    pub cameras: Vec<ModelCamera>,
    pub lights: Vec<ModelLight>,
}

/// Walks through a scene: the given one, else the default.
pub(super) fn contents(document: &Document, pose: &Pose, scene: Option<usize>, report: &mut ImportReport) -> Contents {
    let root = &document.root;
    let mut contents = Contents::default();
    let mut seen = vec![false; root.nodes.len()];
    let mut open: Vec<(usize, DMat4)> = scene_roots(root, scene)
        .into_iter()
        .map(|node| (node, DMat4::IDENTITY))
        .collect();
    open.reverse();
    while let Some((index, world_from_parent)) = open.pop() {
        let Some(node) = root.nodes.get(index) else {
            report.note(Fate::Missing, "a node that is out of bounds", &format!("node {index}"));
            continue;
        };
        if std::mem::replace(&mut seen[index], true) {
            let what = "a node that is in its scene twice, or is its own ancestor";
            report.note(Fate::Ignored, what, &node_name(root, index));
            continue;
        }
        let world_from_node = world_from_parent * pose.parent_from_node[index];
        contents.add(document, index, node, world_from_node, report);
        let children = node.children.iter().flatten().rev();
        open.extend(children.map(|child| (child.value(), world_from_node)));
    }
    contents
}

/// What to call a node.
pub(super) fn node_name(root: &json::Root, node: usize) -> String {
    let name = root.nodes.get(node).and_then(|node| node.name.clone());
    name.unwrap_or_else(|| format!("node {node}"))
}

/// The topmost nodes of a scene; of the default one, of the first where none is the default; all topmost nodes where
/// there is no scene.
fn scene_roots(root: &json::Root, scene: Option<usize>) -> Vec<usize> {
    let scene = scene.unwrap_or_else(|| root.scene.map_or(0, |scene| scene.value()));
    match root.scenes.get(scene).or(root.scenes.first()) {
        Some(scene) => scene.nodes.iter().map(|node| node.value()).collect(),
        None => root_nodes(&root.nodes),
    }
}

impl Contents {
    fn add(
        &mut self,
        document: &Document,
        index: usize,
        node: &json::Node,
        world_from_node: DMat4,
        report: &mut ImportReport,
    ) {
        let root = &document.root;
        if let Some(mesh) = node.mesh {
            let mesh = mesh.value();
            let instances = instances(document, index, report);
            let places = instances.unwrap_or_else(|| vec![DMat4::IDENTITY]);
            self.meshes
                .extend(places.into_iter().map(|node_from_instance| MeshNode {
                    mesh,
                    node: index,
                    world_from_node: world_from_node * node_from_instance,
                }));
        }
        let name = node_name(root, index);
        if let Some(camera) = node.camera.and_then(|camera| root.cameras.get(camera.value())) {
            match camera_at(camera, &name, world_from_node) {
                Some(camera) => self.cameras.push(camera),
                None => report.note(Fate::Ignored, "an orthographic camera", &name),
            }
        }
        let extension = document.extension(&document.raw["nodes"][index], "KHR_lights_punctual");
        if let Some(light) = extension.and_then(|extension| extension["light"].as_u64()) {
            let light = &document.raw["extensions"]["KHR_lights_punctual"]["lights"][light as usize];
            match light_at(light, &name, world_from_node) {
                Some(light) => self.lights.push(light),
                None => report.note(Fate::Missing, "a light that is out of bounds", &name),
            }
        }
    }
}

/// Where a node's instances are in its space (EXT_mesh_gpu_instancing); none where it has none.
fn instances(document: &Document, node: usize, report: &mut ImportReport) -> Option<Vec<DMat4>> {
    let extension = document.extension(&document.raw["nodes"][node], "EXT_mesh_gpu_instancing")?;
    let name = node_name(&document.root, node);
    let accessor = |semantic: &str| Some(extension["attributes"].get(semantic)?.as_u64()? as usize);
    let vectors = |semantic: &str| document.read_vectors::<3>(accessor(semantic)?, semantic).ok();
    let translations = vectors("TRANSLATION");
    let scales = vectors("SCALE");
    let rotations = accessor("ROTATION").and_then(|index| document.read_vectors::<4>(index, "ROTATION").ok());
    let counts = [
        translations.as_ref().map(Vec::len),
        scales.as_ref().map(Vec::len),
        rotations.as_ref().map(Vec::len),
    ];
    let Some(count) = counts.into_iter().flatten().min() else {
        report.note(Fate::Missing, "the places of instances", &name);
        return None;
    };
    report.count(Fate::Used, "instances", &name, count.min(INSTANCES_MAX));
    report.count(
        Fate::Ignored,
        "instances of too many",
        &name,
        count.saturating_sub(INSTANCES_MAX),
    );
    let vector = |values: &Option<Vec<[f32; 3]>>, i: usize, default: DVec3| {
        values
            .as_ref()
            .map_or(default, |values| DVec3::from_array(values[i].map(f64::from)))
    };
    let place = |i: usize| {
        let rotation = rotations
            .as_ref()
            .map_or([0.0, 0.0, 0.0, 1.0], |values| values[i].map(f64::from));
        DMat4::from_scale_rotation_translation(
            vector(&scales, i, DVec3::ONE),
            unit_rotation(rotation),
            vector(&translations, i, DVec3::ZERO),
        )
    };
    Some((0..count.min(INSTANCES_MAX)).map(place).collect())
}

/// A camera looks along −Z of its node.
fn camera_at(camera: &json::Camera, name: &str, world_from_node: DMat4) -> Option<ModelCamera> {
    let perspective = camera.perspective.as_ref()?;
    let forward = world_from_node.transform_vector3(DVec3::NEG_Z).try_normalize()?;
    Some(ModelCamera {
        name: camera.name.clone().unwrap_or_else(|| name.to_owned()),
        position: world_from_node.transform_point3(DVec3::ZERO).to_array(),
        forward: forward.to_array(),
        fov_deg: f64::from(perspective.yfov).to_degrees(),
    })
}

/// A light shines along −Z of its node.
fn light_at(light: &Json, name: &str, world_from_node: DMat4) -> Option<ModelLight> {
    let kind = match light["type"].as_str()? {
        "directional" => LightKind::Directional,
        "spot" => LightKind::Spot,
        _ => LightKind::Point,
    };
    let channel = |i: usize| light["color"][i].as_f64().map_or(1.0, |value| value as f32);
    let forward = world_from_node.transform_vector3(DVec3::NEG_Z).try_normalize()?;
    Some(ModelLight {
        name: light["name"].as_str().unwrap_or(name).to_owned(),
        kind,
        position: world_from_node.transform_point3(DVec3::ZERO).to_array(),
        forward: forward.to_array(),
        color: [channel(0), channel(1), channel(2)],
        intensity: light["intensity"].as_f64().map_or(1.0, |value| value as f32),
    })
}
