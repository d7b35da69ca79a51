//! A photographer's studio: soft boxes around a dark room, made for a glossy object of about unit size at the origin
//! that is seen from +Z, slightly above.

use super::super::{Environment, MapError};
use super::soft_box::{SoftBox, mix, room_with, smoothstep};
use crate::optics::vector::{Vec3, vec3};

/// From the left above, in front: shapes the object.
const KEY: SoftBox = SoftBox {
    centre: [-2.9, 2.8, 2.0],
    half_width: 1.75,
    half_height: 1.75,
    radiance: 7.0,
    corner_share: 0.4,
    edge: 0.25,
    tint: [1.0, 0.985, 0.96],
};
/// From the right, weak and tall: opens the shadows.
const FILL: SoftBox = SoftBox {
    centre: [3.7, 0.9, 1.7],
    half_width: 1.2,
    half_height: 1.9,
    radiance: 0.75,
    corner_share: 0.25,
    edge: 0.45,
    tint: [0.97, 0.99, 1.0],
};
/// Above, a little behind: draws the upper edges.
const TOP: SoftBox = SoftBox {
    centre: [0.4, 3.6, -1.7],
    half_width: 1.9,
    half_height: 0.75,
    radiance: 3.6,
    corner_share: 0.5,
    edge: 0.2,
    tint: [1.0, 1.0, 1.0],
};
/// Behind on the right, narrow and tall: a rim of light.
const RIGHT_RIM: SoftBox = SoftBox {
    centre: [3.3, 1.3, -2.2],
    half_width: 0.38,
    half_height: 2.0,
    radiance: 9.5,
    corner_share: 0.5,
    edge: 0.12,
    tint: [0.97, 0.985, 1.0],
};
/// Behind on the left, narrower.
const LEFT_RIM: SoftBox = SoftBox {
    centre: [-3.5, 1.1, -1.7],
    half_width: 0.28,
    half_height: 1.9,
    radiance: 6.5,
    corner_share: 0.5,
    edge: 0.12,
    tint: [0.97, 0.985, 1.0],
};
const BOXES: [SoftBox; 5] = [KEY, FILL, TOP, RIGHT_RIM, LEFT_RIM];

/// The studio's map, 1024 × 512.
///
/// # Errors
/// None in practice; the signature is that of the other environments.
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
    let backdrop = vec3(0.0, -0.05, -1.0).normalize();
    let from_backdrop = 1.0 - direction.dot(backdrop);
    let glow = 0.19 * (-from_backdrop / 0.06).exp() + 0.05 * (-from_backdrop / 0.3).exp();
    vec3(1.0, 1.0, 1.015) * (walls + glow)
}
