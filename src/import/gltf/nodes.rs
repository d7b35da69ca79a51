//! Nodes of the scene with their contents: meshes, instances, cameras and lights.

use std::f64::consts::FRAC_PI_4;

use glam::{DMat4, DVec3};
use serde_json::Value as Json;

use super::{
    container::Document,
    json::{Camera, Node, Root},
    pose::{Pose, root_nodes, unit_rotation},
};
use crate::scene::{LightKind, ModelCamera, ModelLens, ModelLight, report::Fate, report::ImportReport};

/// The most instances of one node.
const INSTANCES_MAX: usize = 1 << 20;

/// A mesh at a place in the scene.
pub struct MeshNode {
    pub mesh: usize,
    pub node: usize,
    pub world_from_node: DMat4,
}

/// Contents of the scene.
#[derive(Default)]
pub struct Contents {
    pub meshes: Vec<MeshNode>,
    pub cameras: Vec<ModelCamera>,
    pub lights: Vec<ModelLight>,
}

/// Walks through a scene: the given one, else the default.
pub fn contents(document: &Document, pose: &Pose, scene: Option<usize>, report: &mut ImportReport) -> Contents {
    let root = &document.root;
    let contents = Contents::default();
    let mut walk = Walk {
        document,
        report,
        contents,
    };
    let mut seen = vec![false; root.nodes.len()];
    // Node, parent's transform, and whether the parent is hidden.
    let roots = scene_roots(root, scene).into_iter().rev();
    let mut open: Vec<(usize, DMat4, bool)> = roots.map(|node| (node, DMat4::IDENTITY, false)).collect();
    while let Some((index, world_from_parent, is_parent_hidden)) = open.pop() {
        let name = node_name(root, index);
        let Some(node) = root.nodes.get(index) else {
            walk.report.note(Fate::Missing, "a node that is out of bounds", &name);
            continue;
        };
        if std::mem::replace(&mut seen[index], true) {
            let what = "a node that is in its scene twice, or is its own ancestor";
            walk.report.note(Fate::Ignored, what, &name);
            continue;
        }
        let world_from_node = world_from_parent * pose.parent_from_node(index, node);
        // Cameras are there all the same.
        let is_hidden = is_parent_hidden || node.extensions["KHR_node_visibility"]["visible"] == false;
        if is_hidden {
            walk.report.note(Fate::Used, "hidden nodes, not shown", &name);
        } else {
            walk.add_mesh(index, node, &name, world_from_node);
            walk.add_light(node, &name, world_from_node);
        }
        walk.add_camera(node, &name, world_from_node);
        let children = node.children.iter().rev();
        open.extend(children.map(|child| (*child, world_from_node, is_hidden)));
    }
    walk.contents
}

/// Name of a node.
pub fn node_name(root: &Root, node: usize) -> String {
    let name = root.nodes.get(node).and_then(|node| node.name.clone());
    name.unwrap_or_else(|| format!("node {node}"))
}

/// Root nodes of a scene: of the default one, or the first; all root nodes without a scene.
fn scene_roots(root: &Root, scene: Option<usize>) -> Vec<usize> {
    match root.scenes.get(scene.unwrap_or(root.scene)).or(root.scenes.first()) {
        Some(scene) => scene.nodes.clone(),
        None => root_nodes(&root.nodes),
    }
}

struct Walk<'a> {
    document: &'a Document,
    report: &'a mut ImportReport,
    contents: Contents,
}

impl Walk<'_> {
    fn add_mesh(&mut self, index: usize, node: &Node, name: &str, world_from_node: DMat4) {
        let Some(mesh) = node.mesh else { return };
        let places = self.instances(node, name).unwrap_or_else(|| vec![DMat4::IDENTITY]);
        self.contents
            .meshes
            .extend(places.into_iter().map(|node_from_instance| MeshNode {
                mesh,
                node: index,
                world_from_node: world_from_node * node_from_instance,
            }));
    }

    fn add_light(&mut self, node: &Node, name: &str, world_from_node: DMat4) {
        let Some(light) = node.extensions["KHR_lights_punctual"]["light"].as_u64() else {
            return;
        };
        let light = &self.document.root.extensions["KHR_lights_punctual"]["lights"][light as usize];
        match light_at(light, name, world_from_node) {
            Some(light) => self.contents.lights.push(light),
            None if light.is_null() => self.report.note(Fate::Missing, "a light that is out of bounds", name),
            None => self.report.note(Fate::Ignored, "a light of an unknown type", name),
        }
        if light.get("range").is_some() {
            let what = "the range of a light, which shines beyond it";
            self.report.note(Fate::Ignored, what, name);
        }
    }

    fn add_camera(&mut self, node: &Node, name: &str, world_from_node: DMat4) {
        let Some(camera) = node.camera.and_then(|camera| self.document.root.cameras.get(camera)) else {
            return;
        };
        let Some(seen) = camera_at(camera, name, world_from_node) else {
            return self.report.note(Fate::Ignored, "a camera without a lens", name);
        };
        if camera
            .perspective
            .as_ref()
            .is_some_and(|lens| lens.aspect_ratio.is_some())
        {
            let what = "the aspect ratio of a camera: the image keeps its own";
            self.report.note(Fate::Ignored, what, &seen.name);
        }
        self.contents.cameras.push(seen);
    }

    /// Transforms of a node's instances in its space (EXT_mesh_gpu_instancing); `None` without instances.
    fn instances(&mut self, node: &Node, name: &str) -> Option<Vec<DMat4>> {
        let attributes = &node.extensions.get("EXT_mesh_gpu_instancing")?["attributes"];
        let accessor = |semantic: &str| Some(attributes[semantic].as_u64()? as usize);
        let vectors = |semantic: &str| self.document.read_vectors::<3>(accessor(semantic)?, semantic).ok();
        let (translations, scales) = (vectors("TRANSLATION"), vectors("SCALE"));
        let rotations = accessor("ROTATION");
        let rotations = rotations.and_then(|index| self.document.read_vectors::<4>(index, "ROTATION").ok());
        let counts = [&translations, &scales].map(|vectors| vectors.as_ref().map(Vec::len));
        let counts = counts.into_iter().chain([rotations.as_ref().map(Vec::len)]);
        let Some(count) = counts.flatten().min() else {
            self.report.note(Fate::Missing, "the places of instances", name);
            return None;
        };
        let shown = count.min(INSTANCES_MAX);
        self.report.count(Fate::Used, "instances", name, shown);
        self.report
            .count(Fate::Ignored, "instances of too many", name, count - shown);
        let vector = |values: &Option<Vec<[f32; 3]>>, i: usize, default: DVec3| {
            values
                .as_ref()
                .map_or(default, |values| DVec3::from_array(values[i].map(f64::from)))
        };
        let place = |i: usize| {
            let rotation = rotations.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |values| values[i]);
            DMat4::from_scale_rotation_translation(
                vector(&scales, i, DVec3::ONE),
                unit_rotation(rotation.map(f64::from)),
                vector(&translations, i, DVec3::ZERO),
            )
        };
        Some((0..shown).map(place).collect())
    }
}

fn camera_at(camera: &Camera, name: &str, world_from_node: DMat4) -> Option<ModelCamera> {
    let lens = match (&camera.perspective, &camera.orthographic) {
        (Some(perspective), _) => ModelLens::Perspective(f64::from(perspective.yfov).to_degrees()),
        (None, Some(orthographic)) => ModelLens::Orthographic(2.0 * f64::from(orthographic.ymag.abs())),
        (None, None) => return None,
    };
    crate::assembly::camera_at(camera.name.as_deref().unwrap_or(name), world_from_node, lens)
}

/// A light shines along −Z of its node.
fn light_at(light: &Json, name: &str, world_from_node: DMat4) -> Option<ModelLight> {
    let kind = match light["type"].as_str()? {
        "directional" => LightKind::Directional,
        "spot" => LightKind::Spot(cone(&light["spot"])),
        "point" => LightKind::Point,
        _ => return None,
    };
    let number = |value: &Json| value.as_f64().map_or(1.0, |value| value as f32);
    let color = [0, 1, 2].map(|channel| number(&light["color"][channel]));
    let name = light["name"].as_str().unwrap_or(name);
    let shining = (color, number(&light["intensity"]));
    crate::assembly::light_at((name, kind), world_from_node, DVec3::NEG_Z, shining)
}

/// Half the inner and half the outer angle of a spot's cone, radians.
fn cone(spot: &Json) -> [f64; 2] {
    let outer = spot["outerConeAngle"].as_f64().unwrap_or(FRAC_PI_4);
    [spot["innerConeAngle"].as_f64().unwrap_or(0.0).min(outer), outer]
}
