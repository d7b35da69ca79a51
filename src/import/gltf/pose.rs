//! Pose of a model: node transforms, morph target weights and skinning.

use std::collections::HashMap;

use glam::{DMat4, DQuat, DVec3, DVec4};

use super::container::Document;
use super::json::{Animation, Channel, Node};

/// The nodes of a file at one time.
pub struct Pose {
    /// The nodes that an animation moves.
    moved: HashMap<usize, Placement>,
    /// World transform of every node, in the scene or not; empty without skins.
    world_from_node: Vec<DMat4>,
    /// Weights of morph targets of nodes that an animation changes.
    weights: HashMap<usize, Vec<f32>>,
}

/// Translation, rotation and scale of a node.
#[derive(Clone, Copy)]
struct Placement {
    translation: DVec3,
    rotation: DQuat,
    scale: DVec3,
    /// Matrix instead of the three, for nodes without animation.
    matrix: Option<DMat4>,
}

impl Placement {
    fn of(node: &Node) -> Self {
        let vector = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
        Self {
            translation: vector(node.translation),
            rotation: node
                .rotation
                .map_or(DQuat::IDENTITY, |rotation| unit_rotation(rotation.map(f64::from))),
            scale: vector(node.scale.unwrap_or([1.0; 3])),
            matrix: node.matrix.map(|matrix| DMat4::from_cols_array(&matrix.map(f64::from))),
        }
    }

    fn parent_from_node(&self) -> DMat4 {
        self.matrix
            .unwrap_or_else(|| DMat4::from_scale_rotation_translation(self.scale, self.rotation, self.translation))
    }
}

/// Normalised rotation; the identity for a zero quaternion.
pub fn unit_rotation(xyzw: [f64; 4]) -> DQuat {
    let rotation = DQuat::from_array(xyzw);
    if rotation.length_squared() > 0.0 && rotation.is_finite() {
        rotation.normalize()
    } else {
        DQuat::IDENTITY
    }
}

impl Pose {
    /// The rest pose, or that of the first animation at a time.
    pub fn new(document: &Document, time_s: Option<f32>) -> Self {
        let nodes = &document.root.nodes;
        let mut pose = Self {
            moved: HashMap::new(),
            world_from_node: Vec::new(),
            weights: HashMap::new(),
        };
        if let (Some(time_s), Some(animation)) = (time_s, document.root.animations.first()) {
            for channel in &animation.channels {
                // An unreadable channel is ignored.
                let _ = pose.animate(document, animation, channel, time_s);
            }
        }
        if !document.root.skins.is_empty() {
            pose.world_from_node = world_transforms(nodes, |index| pose.parent_from_node(index, &nodes[index]));
        }
        pose
    }

    /// Applies an animation channel to its node; `None` if unreadable.
    fn animate(&mut self, document: &Document, animation: &Animation, channel: &Channel, time_s: f32) -> Option<()> {
        let node = channel.target.node?;
        let curve = animation.samplers.get(channel.sampler)?;
        let times = document.read_vectors::<1>(curve.input, "times").ok()?;
        let keys = Keys {
            times: times.into_iter().flatten().collect(),
            is_cubic: curve.interpolation == "CUBICSPLINE",
            is_step: curve.interpolation == "STEP",
        };
        let at_rest = Placement::of(document.root.nodes.get(node)?);
        let placement = self.moved.entry(node).or_insert(at_rest);
        match channel.target.path.as_str() {
            path @ ("translation" | "scale") => {
                let values = document.read_vectors::<3>(curve.output, "animation").ok()?;
                let values: Vec<DVec4> = values
                    .iter()
                    .map(|v| DVec3::from_array(v.map(f64::from)).extend(0.0))
                    .collect();
                let value = keys.sample(&values, time_s, false)?.truncate();
                match path {
                    "scale" => placement.scale = value,
                    _ => placement.translation = value,
                }
                placement.matrix = None;
            }
            "rotation" => {
                let values = document.read_vectors::<4>(curve.output, "animation").ok()?;
                let values: Vec<DVec4> = values.iter().map(|v| DVec4::from_array(v.map(f64::from))).collect();
                placement.rotation = unit_rotation(keys.sample(&values, time_s, true)?.to_array());
                placement.matrix = None;
            }
            "weights" => {
                let values = document.read_vectors::<1>(curve.output, "animation").ok()?;
                let count = keys.times.len() * if keys.is_cubic { 3 } else { 1 };
                let targets = values.len() / count.max(1);
                let of_target = |target: usize| {
                    let value = |key: usize| DVec4::splat(f64::from(values[key * targets + target][0]));
                    let values: Vec<DVec4> = (0..count).map(value).collect();
                    keys.sample(&values, time_s, false).map(|value| value.x as f32)
                };
                self.weights
                    .insert(node, (0..targets).map(of_target).collect::<Option<_>>()?);
            }
            _ => return None,
        }
        Some(())
    }

    /// A node's own transform, its parent's space from its own.
    pub fn parent_from_node(&self, index: usize, node: &Node) -> DMat4 {
        let moved = self.moved.get(&index).copied();
        moved.unwrap_or_else(|| Placement::of(node)).parent_from_node()
    }

    /// Weights of a node's morph targets: from the animation, else the node, else the mesh.
    pub fn weights<'a>(&'a self, document: &'a Document, node: usize) -> &'a [f32] {
        let of_node = &document.root.nodes[node];
        let of_mesh = of_node.mesh.and_then(|mesh| document.root.meshes.get(mesh));
        let of_mesh = of_mesh.map(|mesh| &mesh.weights);
        let mut all = [self.weights.get(&node), Some(&of_node.weights), of_mesh]
            .into_iter()
            .flatten();
        all.find(|weights| !weights.is_empty()).map_or(&[], Vec::as_slice)
    }

    /// Joint matrices of a skin; `None` without the skin.
    pub fn joints(&self, document: &Document, skin: usize) -> Option<Vec<DMat4>> {
        let skin = document.root.skins.get(skin)?;
        let inverse: Option<Vec<[f32; 16]>> = skin
            .inverse_bind_matrices
            .and_then(|accessor| document.read_vectors(accessor, "inverse bind matrices").ok());
        let joints = skin.joints.iter().enumerate().map(|(index, joint)| {
            let world = self.world_from_node.get(*joint).copied().unwrap_or_default();
            let bind = inverse.as_ref().and_then(|matrices| matrices.get(index));
            world * bind.map_or(DMat4::IDENTITY, |bind| DMat4::from_cols_array(&bind.map(f64::from)))
        });
        Some(joints.collect())
    }
}

/// World transforms of all nodes, from the roots down.
fn world_transforms(nodes: &[Node], parent_from_node: impl Fn(usize) -> DMat4) -> Vec<DMat4> {
    let mut world = vec![DMat4::IDENTITY; nodes.len()];
    let mut seen = vec![false; nodes.len()];
    let mut open: Vec<(usize, DMat4)> = root_nodes(nodes)
        .into_iter()
        .map(|node| (node, DMat4::IDENTITY))
        .collect();
    while let Some((index, world_from_parent)) = open.pop() {
        if index >= nodes.len() || std::mem::replace(&mut seen[index], true) {
            continue;
        }
        world[index] = world_from_parent * parent_from_node(index);
        open.extend(nodes[index].children.iter().map(|child| (*child, world[index])));
    }
    world
}

/// The nodes that are no node's child.
pub fn root_nodes(nodes: &[Node]) -> Vec<usize> {
    let mut is_child = vec![false; nodes.len()];
    for child in nodes.iter().flat_map(|node| &node.children) {
        if let Some(is_child) = is_child.get_mut(*child) {
            *is_child = true;
        }
    }
    (0..nodes.len()).filter(|&node| !is_child[node]).collect()
}

/// Times at which a curve has values, and what is between them.
struct Keys {
    times: Vec<f32>,
    /// Each key has an incoming tangent, a value and an outgoing tangent.
    is_cubic: bool,
    is_step: bool,
}

impl Keys {
    /// The value at a time; before the first key and after the last theirs.
    fn sample(&self, values: &[DVec4], time_s: f32, is_rotation: bool) -> Option<DVec4> {
        let times = &self.times;
        let value = |key: usize| values.get(if self.is_cubic { 3 * key + 1 } else { key }).copied();
        let next = times.partition_point(|&key| key <= time_s);
        let Some(before) = next.checked_sub(1) else {
            return value(0);
        };
        if next == times.len() || self.is_step {
            return value(before);
        }
        let span = f64::from(times[next] - times[before]);
        let t = f64::from(time_s - times[before]) / span;
        let (from, to) = (value(before)?, value(next)?);
        if self.is_cubic {
            let (leaving, arriving) = (span * *values.get(3 * before + 2)?, span * *values.get(3 * next)?);
            let (t2, t3) = (t * t, t * t * t);
            return Some(
                from * (2.0 * t3 - 3.0 * t2 + 1.0)
                    + leaving * (t3 - 2.0 * t2 + t)
                    + to * (3.0 * t2 - 2.0 * t3)
                    + arriving * (t3 - t2),
            );
        }
        if is_rotation {
            let [from, to] = [from, to].map(|rotation| unit_rotation(rotation.to_array()));
            return Some(DVec4::from_array(from.slerp(to, t).to_array()));
        }
        Some(from.lerp(to, t))
    }
}
