//! A photographer's studio: soft boxes around a dark room, made for a glossy object of about unit size at the origin
//! that is seen from +Z, slightly above.

use super::super::{Environment, MapError};
use super::soft_box::{SoftBox, mix, room_with, smoothstep, soft_box};
use crate::optics::vector::{Vec3, vec3};

/// From the left above, in front: shapes the object.
const KEY: SoftBox = soft_box([-2.9, 2.8, 2.0], [1.75, 1.75], [7.0, 0.4, 0.25], [1.0, 0.985, 0.96]);
/// From the right, weak and tall: opens the shadows.
const FILL: SoftBox = soft_box([3.7, 0.9, 1.7], [1.2, 1.9], [0.75, 0.25, 0.45], [0.97, 0.99, 1.0]);
/// Above, a little behind: draws the upper edges.
const TOP: SoftBox = soft_box([0.4, 3.6, -1.7], [1.9, 0.75], [3.6, 0.5, 0.2], [1.0, 1.0, 1.0]);
/// Behind on the right, narrow and tall: a rim of light.
const RIGHT_RIM: SoftBox = soft_box([3.3, 1.3, -2.2], [0.38, 2.0], [9.5, 0.5, 0.12], [0.97, 0.985, 1.0]);
/// Behind on the left, narrower.
const LEFT_RIM: SoftBox = soft_box([-3.5, 1.1, -1.7], [0.28, 1.9], [6.5, 0.5, 0.12], [0.97, 0.985, 1.0]);
const BOXES: [SoftBox; 5] = [KEY, FILL, TOP, RIGHT_RIM, LEFT_RIM];

/// The studio's map, 1024 × 512.
pub fn studio() -> Result<Environment, MapError> {
    room_with("studio", &BOXES, room)
}

/// The empty room: a dark ceiling, a floor with a pool of light in front of the object that is lost towards the nadir,
/// and a glow on the backdrop behind it.
fn room(direction: Vec3<f64>) -> Vec3<f64> {
    let (height, depth) = (direction.y.max(0.0), (-direction.y).max(0.0));
    let ceiling = mix(0.05, 0.012, smoothstep(0.0, 0.8, height));
    let in_front = mix(0.4, 1.0, 0.5 + 0.5 * direction.z);
    let pool = 0.11 * in_front * smoothstep(0.0, 0.45, depth) * mix(1.0, 0.25, smoothstep(0.45, 1.0, depth));
    let walls = ceiling + pool;
    let from_backdrop = 1.0 - direction.dot(vec3(0.0, -0.05, -1.0).normalize());
    let glow = 0.19 * (-from_backdrop / 0.06).exp() + 0.05 * (-from_backdrop / 0.3).exp();
    vec3(1.0, 1.0, 1.015) * (walls + glow)
}
