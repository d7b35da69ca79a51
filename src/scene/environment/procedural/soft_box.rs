//! Soft boxes: rectangular lamps behind cloth, of which rooms to photograph in are made.

use super::super::{Environment, MapError};
use super::texels_of;
use crate::optics::vector::{Vec3, vec3};

const WIDTH: u32 = 1024;
const HEIGHT: u32 = 512;

/// A rectangular soft box with rounded corners, facing the origin, its sides level. Lengths in units of the object.
pub struct SoftBox {
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

/// A soft box, in its tables' columns: centre; half of its width and height; radiance, share at the corners and edge; tint.
pub const fn soft_box(
    centre: [f64; 3],
    [half_width, half_height]: [f64; 2],
    [radiance, corner_share, edge]: [f64; 3],
    tint: [f64; 3],
) -> SoftBox {
    SoftBox {
        centre,
        half_width,
        half_height,
        radiance,
        corner_share,
        edge,
        tint,
    }
}

/// The map of a room, 1024 × 512: soft boxes before its walls, the last one in front.
pub fn room_with(
    name: &str,
    boxes: &[SoftBox],
    walls: impl Fn(Vec3<f64>) -> Vec3<f64> + Sync,
) -> Result<Environment, MapError> {
    let placed: Vec<_> = boxes.iter().map(Placed::of).collect();
    let texels = texels_of(WIDTH, HEIGHT, |direction| {
        let over = |behind, soft_box: &Placed| soft_box.over(behind, direction);
        placed.iter().fold(walls(direction), over).to_f32()
    });
    Environment::from_texels(name, WIDTH, HEIGHT, texels)
}

/// A soft box with its axes.
struct Placed<'a> {
    of: &'a SoftBox,
    centre: Vec3<f64>,
    distance: f64,
    normal: Vec3<f64>,
    right: Vec3<f64>,
    up: Vec3<f64>,
}

impl<'a> Placed<'a> {
    fn of(of: &'a SoftBox) -> Self {
        let centre = Vec3::from_f64(of.centre);
        let normal = centre.normalize();
        let right = vec3(0.0, 1.0, 0.0).cross(normal).normalize();
        Self {
            of,
            centre,
            distance: centre.length(),
            normal,
            right,
            up: normal.cross(right),
        }
    }

    /// Radiance from a direction with the box composited over `behind`.
    fn over(&self, behind: Vec3<f64>, direction: Vec3<f64>) -> Vec3<f64> {
        let facing = direction.dot(self.normal);
        if facing <= 0.0 {
            return behind;
        }
        let offset = direction * (self.distance / facing) - self.centre;
        self.of.over(behind, [offset.dot(self.right), offset.dot(self.up)])
    }
}

impl SoftBox {
    /// Radiance from a point in the box's plane with the box composited over `behind`.
    fn over(&self, behind: Vec3<f64>, [x, y]: [f64; 2]) -> Vec3<f64> {
        if x.abs() > self.half_width || y.abs() > self.half_height {
            return behind;
        }
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
pub fn mix(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

/// 0 up to `low`, 1 from `high`, smooth between.
pub fn smoothstep(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
