//! Pose of a model: node transforms, morph target weights and skinning.

use std::collections::HashMap;

use glam::{DMat4, DQuat, DVec3, DVec4};
use gltf::json;
use json::animation::{Interpolation, Property};
use json::validation::Checked;

use super::container::Document;

/// The nodes of a file at one time.
pub(super) struct Pose {
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
    fn of(node: &json::Node) -> Self {
        let vector = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
        Self {
            translation: vector(node.translation.unwrap_or_default()),
            rotation: node
                .rotation
                .map_or(DQuat::IDENTITY, |rotation| unit_rotation(rotation.0.map(f64::from))),
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
pub(super) fn unit_rotation(xyzw: [f64; 4]) -> DQuat {
    let rotation = DQuat::from_array(xyzw);
    if rotation.length_squared() > 0.0 && rotation.is_finite() {
        rotation.normalize()
    } else {
        DQuat::IDENTITY
    }
}

impl Pose {
    /// The rest pose, or that of the first animation at a time.
    pub(super) fn new(document: &Document, time_s: Option<f32>) -> Self {
        let nodes = &document.root.nodes;
        let mut moved: HashMap<usize, Placement> = HashMap::new();
        let mut weights = HashMap::new();
        if let (Some(time_s), Some(animation)) = (time_s, document.root.animations.first()) {
            for channel in &animation.channels {
                // An unreadable channel is ignored.
                let _ = animate(document, animation, channel, time_s, &mut moved, &mut weights);
            }
        }
        let mut pose = Self {
            moved,
            world_from_node: Vec::new(),
            weights,
        };
        if !document.root.skins.is_empty() {
            pose.world_from_node = world_transforms(nodes, |index| pose.parent_from_node(index, &nodes[index]));
        }
        pose
    }

    /// A node's own transform, its parent's space from its own.
    pub(super) fn parent_from_node(&self, index: usize, node: &json::Node) -> DMat4 {
        let moved = self.moved.get(&index).copied();
        moved.unwrap_or_else(|| Placement::of(node)).parent_from_node()
    }

    /// Weights of a node's morph targets: from the animation, else the node, else the mesh.
    pub(super) fn weights<'a>(&'a self, document: &'a Document, node: usize) -> &'a [f32] {
        let animated = self.weights.get(&node);
        let node = document.root.nodes.get(node);
        let own = animated.or(node.and_then(|node| node.weights.as_ref()));
        if let Some(own) = own.filter(|own| !own.is_empty()) {
            return own;
        }
        let mesh = node.and_then(|node| node.mesh);
        let mesh = mesh.and_then(|mesh| document.root.meshes.get(mesh.value()));
        mesh.and_then(|mesh| mesh.weights.as_deref()).unwrap_or_default()
    }

    /// Joint matrices of a skin; `None` without the skin.
    pub(super) fn joints(&self, document: &Document, skin: usize) -> Option<Vec<DMat4>> {
        let skin = document.root.skins.get(skin)?;
        let inverse = skin
            .inverse_bind_matrices
            .and_then(|accessor| document.read_matrices(accessor.value(), "inverse bind matrices").ok());
        let joints = skin.joints.iter().enumerate().map(|(index, joint)| {
            let world = self.world_from_node.get(joint.value()).copied().unwrap_or_default();
            let bind = inverse.as_ref().and_then(|matrices| matrices.get(index));
            world * bind.map_or(DMat4::IDENTITY, |bind| DMat4::from_cols_array(&bind.map(f64::from)))
        });
        Some(joints.collect())
    }
}

/// World transforms of all nodes, from the roots down.
fn world_transforms(nodes: &[json::Node], parent_from_node: impl Fn(usize) -> DMat4) -> Vec<DMat4> {
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
        let children = nodes[index].children.iter().flatten();
        open.extend(children.map(|child| (child.value(), world[index])));
    }
    world
}

/// The nodes that are no node's child.
pub(super) fn root_nodes(nodes: &[json::Node]) -> Vec<usize> {
    let mut is_child = vec![false; nodes.len()];
    for child in nodes.iter().flat_map(|node| node.children.iter().flatten()) {
        if let Some(is_child) = is_child.get_mut(child.value()) {
            *is_child = true;
        }
    }
    (0..nodes.len()).filter(|&node| !is_child[node]).collect()
}

/// Applies an animation channel to its node; `None` if unreadable.
fn animate(
    document: &Document,
    animation: &json::Animation,
    channel: &json::animation::Channel,
    time_s: f32,
    moved: &mut HashMap<usize, Placement>,
    weights: &mut HashMap<usize, Vec<f32>>,
) -> Option<()> {
    let node = channel.target.node.value();
    let sampler = animation.samplers.get(channel.sampler.value())?;
    let Checked::Valid(path) = channel.target.path else {
        return None;
    };
    let times = document.read_vectors::<1>(sampler.input.value(), "times").ok()?;
    let times: Vec<f32> = times.into_iter().flatten().collect();
    let interpolation = match sampler.interpolation {
        Checked::Valid(interpolation) => interpolation,
        Checked::Invalid => Interpolation::Linear,
    };
    let output = sampler.output.value();
    let at_rest = Placement::of(document.root.nodes.get(node)?);
    let placement = moved.entry(node).or_insert(at_rest);
    match path {
        Property::Translation | Property::Scale => {
            let values = document.read_vectors::<3>(output, "animation").ok()?;
            let values: Vec<DVec4> = values
                .iter()
                .map(|v| DVec3::from_array(v.map(f64::from)).extend(0.0))
                .collect();
            let value = sample(&times, &values, interpolation, time_s, false)?.truncate();
            if path == Property::Scale {
                placement.scale = value;
            } else {
                placement.translation = value;
            }
            placement.matrix = None;
        }
        Property::Rotation => {
            let values = document.read_vectors::<4>(output, "animation").ok()?;
            let values: Vec<DVec4> = values.iter().map(|v| DVec4::from_array(v.map(f64::from))).collect();
            placement.rotation = unit_rotation(sample(&times, &values, interpolation, time_s, true)?.to_array());
            placement.matrix = None;
        }
        Property::MorphTargetWeights => {
            let values = document.read_vectors::<1>(output, "animation").ok()?;
            let parts = if interpolation == Interpolation::CubicSpline {
                3
            } else {
                1
            };
            let targets = values.len() / (times.len() * parts).max(1);
            let of_target = |target: usize| {
                let values: Vec<DVec4> = (0..times.len() * parts)
                    .map(|key| DVec4::splat(f64::from(values[key * targets + target][0])))
                    .collect();
                sample(&times, &values, interpolation, time_s, false).map(|value| value.x as f32)
            };
            weights.insert(node, (0..targets).map(of_target).collect::<Option<_>>()?);
        }
    }
    Some(())
}

/// The value at a time; before the first key and after the last theirs. Cubic splines have an incoming tangent, a value
/// and an outgoing tangent a key.
fn sample(
    times: &[f32],
    values: &[DVec4],
    interpolation: Interpolation,
    time_s: f32,
    is_rotation: bool,
) -> Option<DVec4> {
    let is_cubic = interpolation == Interpolation::CubicSpline;
    let value = |key: usize| values.get(if is_cubic { 3 * key + 1 } else { key }).copied();
    let next = times.partition_point(|&key| key <= time_s);
    let Some(before) = next.checked_sub(1) else {
        return value(0);
    };
    if next == times.len() || interpolation == Interpolation::Step {
        return value(before);
    }
    let span = f64::from(times[next] - times[before]);
    let t = f64::from(time_s - times[before]) / span;
    let (from, to) = (value(before)?, value(next)?);
    if is_cubic {
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
