//! A photographer's studio: soft boxes around a dark room, made for a glossy object of about unit size at the origin
//! that is seen from +Z, slightly above.

use super::super::{Environment, EnvironmentError};
use super::texels_of;
use crate::optics::vector::{Vec3, vec3};

const WIDTH: u32 = 1024;
const HEIGHT: u32 = 512;

/// A rectangular soft box with rounded corners, facing the origin, its sides level. Lengths in units of the object.
struct SoftBox {
    centre: [f64; 3],
    half_width: f64,
    half_height: f64,
    /// Radiance in the middle.
    radiance: f64,
    /// Radiance at the corners as a share of that in the middle: cloth in front of one lamp.
    corner_share: f64,
    /// Width of the soft edge.
    edge: f64,
    tint: [f64; 3],
}

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
pub fn studio() -> Result<Environment, EnvironmentError> {
    let texels = texels_of(WIDTH, HEIGHT, |direction| {
        let over = |behind, soft_box: &SoftBox| soft_box.over(behind, direction);
        BOXES.iter().fold(room(direction), over).to_f32()
    });
    Environment::from_texels("studio", WIDTH, HEIGHT, texels)
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

impl SoftBox {
    /// The light from a direction when the box stands in front of `behind`.
    fn over(&self, behind: Vec3<f64>, direction: Vec3<f64>) -> Vec3<f64> {
        let centre = Vec3::from_f64(self.centre);
        let normal = centre.normalize();
        let facing = direction.dot(normal);
        if facing <= 0.0 {
            return behind;
        }
        let right = vec3(0.0, 1.0, 0.0).cross(normal).normalize();
        let up = normal.cross(right);
        let offset = direction * (centre.length() / facing) - centre;
        let (x, y) = (offset.dot(right), offset.dot(up));
        let cover = 1.0 - smoothstep(-self.edge, 0.0, self.distance(x, y));
        let from_middle = ((x / self.half_width).powi(2) + (y / self.half_height).powi(2)) / 2.0;
        let radiance = self.radiance * mix(1.0, self.corner_share, from_middle.min(1.0));
        behind.mix(Vec3::from_f64(self.tint) * radiance, cover)
    }

    /// The signed distance, negative inside, of a point in the box's plane to its outline with rounded corners.
    fn distance(&self, x: f64, y: f64) -> f64 {
        let corner = 0.35 * self.half_width.min(self.half_height);
        let (dx, dy) = (x.abs() - self.half_width + corner, y.abs() - self.half_height + corner);
        dx.max(0.0).hypot(dy.max(0.0)) + dx.max(dy).min(0.0) - corner
    }
}

/// `a` at t = 0, `b` at t = 1.
fn mix(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

/// 0 up to `low`, 1 from `high`, smooth between.
fn smoothstep(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
