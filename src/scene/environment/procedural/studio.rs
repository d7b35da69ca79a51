//! A photographer's studio: soft boxes around a dark room, made for a glossy object of about unit size at the origin
//! that is seen from +Z, slightly above.

use rayon::prelude::*;

use super::super::{Environment, EnvironmentError, environment_direction};
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
    centre: [-2.9, 2.7, 2.1],
    half_width: 1.35,
    half_height: 1.35,
    radiance: 9.0,
    corner_share: 0.55,
    edge: 0.16,
    tint: [1.0, 0.985, 0.96],
};
/// From the right, weak and wide: opens the shadows.
const FILL: SoftBox = SoftBox {
    centre: [3.6, 0.9, 2.4],
    half_width: 1.5,
    half_height: 1.5,
    radiance: 0.8,
    corner_share: 0.5,
    edge: 0.5,
    tint: [0.97, 0.99, 1.0],
};
/// Above, a little behind: draws the upper edges.
const TOP: SoftBox = SoftBox {
    centre: [0.5, 3.8, -1.2],
    half_width: 1.7,
    half_height: 0.55,
    radiance: 4.5,
    corner_share: 0.6,
    edge: 0.14,
    tint: [1.0, 1.0, 1.0],
};
/// Behind on the right, narrow and tall: a rim of light.
const RIGHT_RIM: SoftBox = SoftBox {
    centre: [3.3, 1.5, -2.2],
    half_width: 0.36,
    half_height: 1.7,
    radiance: 11.0,
    corner_share: 0.6,
    edge: 0.09,
    tint: [0.97, 0.985, 1.0],
};
/// Behind on the left, narrower.
const LEFT_RIM: SoftBox = SoftBox {
    centre: [-3.5, 1.2, -1.7],
    half_width: 0.28,
    half_height: 1.6,
    radiance: 7.0,
    corner_share: 0.6,
    edge: 0.09,
    tint: [0.97, 0.985, 1.0],
};
const BOXES: [SoftBox; 5] = [KEY, FILL, TOP, RIGHT_RIM, LEFT_RIM];

/// The studio's map, 1024 × 512.
///
/// # Errors
/// None in practice; the signature is that of the other environments.
pub fn studio() -> Result<Environment, EnvironmentError> {
    let mut texels = vec![[1.0_f32; 4]; (WIDTH * HEIGHT) as usize];
    texels
        .par_chunks_mut(WIDTH as usize)
        .enumerate()
        .for_each(|(row, texels)| {
            for (column, texel) in texels.iter_mut().enumerate() {
                let uv = [
                    (column as f64 + 0.5) / f64::from(WIDTH),
                    (row as f64 + 0.5) / f64::from(HEIGHT),
                ];
                let direction = environment_direction(uv);
                let radiance = BOXES
                    .iter()
                    .fold(room(direction), |behind, soft_box| soft_box.over(behind, direction));
                texel[..3].copy_from_slice(&radiance.to_f32());
            }
        });
    Environment::from_texels("studio", WIDTH, HEIGHT, texels)
}

/// The empty room: a floor and a ceiling that darken away from the horizon, and a wash of light on the backdrop.
fn room(direction: Vec3<f64>) -> Vec3<f64> {
    let height = direction.y;
    let ceiling = mix(0.085, 0.022, smoothstep(0.0, 0.9, height));
    let floor = mix(0.085, 0.05, smoothstep(0.0, 0.8, -height));
    let walls = if height > 0.0 { ceiling } else { floor };
    let backdrop = vec3(0.0, -0.12, -1.0).normalize();
    let from_backdrop = 1.0 - direction.dot(backdrop);
    let wash = 0.24 * (-from_backdrop / 0.22).exp();
    vec3(1.0, 1.0, 1.015) * (walls + wash)
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
