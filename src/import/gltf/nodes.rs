//! Nodes of the scene with their contents: meshes, instances, cameras and lights.

use std::f64::consts::FRAC_PI_4;

use glam::{DMat4, DVec3};
use gltf::json;
use serde_json::Value as Json;

use super::container::Document;
use super::pose::{Pose, root_nodes, unit_rotation};
use crate::scene::report::{Fate, ImportReport};
use crate::scene::{LightKind, ModelCamera, ModelLens, ModelLight};

/// The most instances of one node.
const INSTANCES_MAX: usize = 1 << 20;

/// A mesh at a place in the scene.
pub(super) struct MeshNode {
    pub mesh: usize,
    pub node: usize,
    pub world_from_node: DMat4,
}

/// Contents of the scene.
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
    // Node, parent's transform, and whether the parent is hidden.
    let mut open: Vec<(usize, DMat4, bool)> = scene_roots(root, scene)
        .into_iter()
        .map(|node| (node, DMat4::IDENTITY, false))
        .collect();
    open.reverse();
    while let Some((index, world_from_parent, is_parent_hidden)) = open.pop() {
        let Some(node) = root.nodes.get(index) else {
            report.note(Fate::Missing, "a node that is out of bounds", &format!("node {index}"));
            continue;
        };
        if std::mem::replace(&mut seen[index], true) {
            let what = "a node that is in its scene twice, or is its own ancestor";
            report.note(Fate::Ignored, what, &node_name(root, index));
            continue;
        }
        let world_from_node = world_from_parent * pose.parent_from_node(index, node);
        let is_hidden = is_parent_hidden || hides(document, index);
        if is_hidden {
            report.note(Fate::Used, "hidden nodes, not shown", &node_name(root, index));
        } else {
            contents.add_visible(document, index, node, world_from_node, report);
        }
        contents.add_camera(root, index, node, world_from_node, report);
        let children = node.children.iter().flatten().rev();
        open.extend(children.map(|child| (child.value(), world_from_node, is_hidden)));
    }
    contents
}

/// Whether the file hides a node's contents, except cameras (KHR_node_visibility).
fn hides(document: &Document, node: usize) -> bool {
    let extension = document.extension(&document.raw["nodes"][node], "KHR_node_visibility");
    extension.is_some_and(|extension| extension["visible"] == false)
}

/// Name of a node.
pub(super) fn node_name(root: &json::Root, node: usize) -> String {
    let name = root.nodes.get(node).and_then(|node| node.name.clone());
    name.unwrap_or_else(|| format!("node {node}"))
}

/// Root nodes of a scene: of the default one, or the first; all root nodes without a scene.
fn scene_roots(root: &json::Root, scene: Option<usize>) -> Vec<usize> {
    let scene = scene.unwrap_or_else(|| root.scene.map_or(0, |scene| scene.value()));
    match root.scenes.get(scene).or(root.scenes.first()) {
        Some(scene) => scene.nodes.iter().map(|node| node.value()).collect(),
        None => root_nodes(&root.nodes),
    }
}

impl Contents {
    /// The mesh and the light of a node.
    fn add_visible(
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
        let extension = document.extension(&document.raw["nodes"][index], "KHR_lights_punctual");
        if let Some(light) = extension.and_then(|extension| extension["light"].as_u64()) {
            let light = &document.raw["extensions"]["KHR_lights_punctual"]["lights"][light as usize];
            match light_at(light, &name, world_from_node) {
                Some(light) => self.lights.push(light),
                None if light.is_null() => report.note(Fate::Missing, "a light that is out of bounds", &name),
                None => report.note(Fate::Ignored, "a light of an unknown type", &name),
            }
            if light.get("range").is_some() {
                report.note(Fate::Ignored, "the range of a light, which shines beyond it", &name);
            }
        }
    }

    fn add_camera(
        &mut self,
        root: &json::Root,
        index: usize,
        node: &json::Node,
        world_from_node: DMat4,
        report: &mut ImportReport,
    ) {
        let Some(camera) = node.camera.and_then(|camera| root.cameras.get(camera.value())) else {
            return;
        };
        let name = node_name(root, index);
        match camera_at(camera, &name, world_from_node) {
            Some(seen) => {
                note_camera(camera, &seen, report);
                self.cameras.push(seen);
            }
            None => report.note(Fate::Ignored, "a camera without a lens", &name),
        }
    }
}

/// Transforms of a node's instances in its space (EXT_mesh_gpu_instancing); `None` without instances.
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

/// A camera looks along −Z of its node, with +Y up.
fn camera_at(camera: &json::Camera, name: &str, world_from_node: DMat4) -> Option<ModelCamera> {
    let lens = match (&camera.perspective, &camera.orthographic) {
        (Some(perspective), _) => ModelLens::Perspective(f64::from(perspective.yfov).to_degrees()),
        (None, Some(orthographic)) => ModelLens::Orthographic(2.0 * f64::from(orthographic.ymag.abs())),
        (None, None) => return None,
    };
    let forward = world_from_node.transform_vector3(DVec3::NEG_Z).try_normalize()?;
    let up = world_from_node
        .transform_vector3(DVec3::Y)
        .reject_from_normalized(forward);
    Some(ModelCamera {
        name: camera.name.clone().unwrap_or_else(|| name.to_owned()),
        position: world_from_node.transform_point3(DVec3::ZERO).to_array(),
        forward: forward.to_array(),
        up: up.try_normalize()?.to_array(),
        lens,
    })
}

/// Reports camera properties that a bookmark cannot store.
fn note_camera(camera: &json::Camera, seen: &ModelCamera, report: &mut ImportReport) {
    let perspective = camera.perspective.as_ref();
    if perspective.is_some_and(|perspective| perspective.aspect_ratio.is_some()) {
        report.note(
            Fate::Ignored,
            "the aspect ratio of a camera: the image keeps its own",
            &seen.name,
        );
    }
}

/// A light shines along −Z of its node.
fn light_at(light: &Json, name: &str, world_from_node: DMat4) -> Option<ModelLight> {
    let kind = match light["type"].as_str()? {
        "directional" => LightKind::Directional,
        "spot" => LightKind::Spot(cone(&light["spot"])),
        "point" => LightKind::Point,
        _ => return None,
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

/// Half the inner and half the outer angle of a spot's cone, radians.
fn cone(spot: &Json) -> [f64; 2] {
    let outer = spot["outerConeAngle"].as_f64().unwrap_or(FRAC_PI_4);
    [spot["innerConeAngle"].as_f64().unwrap_or(0.0).min(outer), outer]
}
