//! Rooms to photograph in, each a page of numbers: large warm and cool lamps that wrap around an object of about unit size at
//! the origin, walls and a floor that reflect them. The object is seen from +Z, slightly above.

use super::super::{Environment, MapError};
use super::soft_box::{SoftBox, mix, room_with, smoothstep, soft_box};
use super::texels_of;
use crate::optics::vector::{Vec3, vec3};

/// Radiance of the floor, the walls and the ceiling, linear Rec. 709; from one to the other it changes smoothly.
struct Walls {
    floor: [f64; 3],
    wall: [f64; 3],
    ceiling: [f64; 3],
    /// Half of the height, as the sine of an elevation, over which the floor becomes the wall.
    bend: f64,
}

impl Walls {
    /// The map of a room with these walls.
    fn with(&self, name: &str, boxes: &[SoftBox]) -> Result<Environment, MapError> {
        room_with(name, boxes, |direction| self.radiance(direction))
    }

    fn radiance(&self, direction: Vec3<f64>) -> Vec3<f64> {
        let [floor, wall, ceiling] = [self.floor, self.wall, self.ceiling].map(Vec3::from_f64);
        let above = wall.mix(ceiling, smoothstep(0.2, 0.8, direction.y));
        above.mix(floor, smoothstep(0.25 - self.bend, 0.25 + self.bend, -direction.y))
    }
}

/// Wood. The lamps are as much cooler as it is warm: a level table gets neutral light, so white is white, while metals, which
/// reflect more of the room than of the lamps, are warm.
const PRODUCT_WALLS: Walls = Walls {
    floor: [0.486, 0.387, 0.272],
    wall: [0.328, 0.262, 0.184],
    ceiling: [0.267, 0.213, 0.15],
    bend: 0.25,
};
/// Radiance of the grey backdrop.
const BACKDROP: [f64; 3] = [0.404, 0.376, 0.344];
/// The way to its middle, behind the object; cosines to it where the backdrop ends, and within which it hides the wall.
const TO_BACKDROP: [f64; 3] = [-0.34, -0.15, -0.94];
const BACKDROP_EDGE: [f64; 2] = [0.3, 0.9];
const DAYLIGHT: [f64; 3] = [0.943, 0.969, 1.0];
const PRODUCT: [SoftBox; 5] = [
    // From the left above, in front: large, shapes the object.
    soft_box([-2.6, 2.3, 2.2], [2.1, 1.9], [8.0, 0.4, 0.6], DAYLIGHT),
    // From the right: large and weak, opens the shadows.
    soft_box([3.5, 1.0, 1.2], [1.8, 2.2], [2.14, 0.35, 0.7], DAYLIGHT),
    // Above, a little behind: draws the upper edges.
    soft_box([0.3, 3.8, -1.2], [2.4, 1.0], [4.4, 0.5, 0.3], DAYLIGHT),
    // Behind on the right and on the left, narrow.
    soft_box([2.9, 1.2, -2.6], [0.5, 2.2], [8.55, 0.5, 0.2], DAYLIGHT),
    soft_box([-3.4, 0.9, -2.0], [0.4, 2.0], [6.2, 0.5, 0.2], DAYLIGHT),
];

/// Dim, so that the lamps alone shape the object.
const PORTRAIT_WALLS: Walls = Walls {
    floor: [0.16, 0.145, 0.13],
    wall: [0.12, 0.115, 0.115],
    ceiling: [0.07, 0.07, 0.075],
    bend: 0.25,
};
/// For faces.
const PORTRAIT: [SoftBox; 4] = [
    // The main lamp, large, warm and near the camera.
    soft_box([-2.4, 2.0, 2.6], [1.5, 1.5], [13.0, 0.35, 0.5], [1.0, 0.9, 0.76]),
    // A reflector at the side.
    soft_box([3.2, 0.6, 2.2], [1.5, 2.0], [1.1, 0.3, 0.7], [0.75, 0.86, 1.0]),
    // A reflector below.
    soft_box([0.0, -2.2, 2.4], [1.8, 0.8], [1.0, 0.4, 0.5], [1.0, 0.9, 0.8]),
    // Behind on the right above: parts the object from what is behind it.
    soft_box([2.2, 2.2, -2.6], [0.9, 1.1], [8.0, 0.5, 0.3], [0.85, 0.92, 1.0]),
];

/// Nearly black.
const RIM_WALLS: Walls = Walls {
    floor: [0.05, 0.05, 0.055],
    wall: [0.035, 0.035, 0.04],
    ceiling: [0.03, 0.03, 0.035],
    bend: 0.25,
};
/// For outlines.
const RIM: [SoftBox; 4] = [
    // Behind on the left, warm.
    soft_box([-3.2, 1.2, -1.9], [0.55, 2.3], [16.0, 0.5, 0.2], [1.0, 0.8, 0.58]),
    // Behind on the right, cool.
    soft_box([3.2, 1.2, -1.9], [0.55, 2.3], [16.0, 0.5, 0.2], [0.62, 0.8, 1.0]),
    // Above.
    soft_box([0.0, 3.8, -0.9], [2.2, 0.5], [5.0, 0.5, 0.25], [1.0, 1.0, 1.0]),
    // In front, weak: the side that is seen is not black.
    soft_box([-1.2, 1.6, 3.8], [1.4, 0.9], [0.9, 0.4, 0.5], [1.0, 0.96, 0.9]),
];

/// Concrete and wood.
const WAREHOUSE_WALLS: Walls = Walls {
    floor: [0.23, 0.21, 0.19],
    wall: [0.2, 0.175, 0.15],
    ceiling: [0.1, 0.1, 0.105],
    bend: 0.15,
};
const fn skylight(x: f64) -> SoftBox {
    soft_box([x, 3.4, 0.2], [0.34, 2.6], [4.2, 0.8, 0.1], [1.0, 0.97, 0.9])
}
/// On the left.
const fn window(z: f64) -> SoftBox {
    soft_box([-4.2, 1.0, z], [0.62, 1.3], [5.5, 0.8, 0.08], [0.78, 0.89, 1.0])
}
/// Skylights, windows, a gate.
const WAREHOUSE: [SoftBox; 8] = [
    skylight(-2.2),
    skylight(-0.75),
    skylight(0.75),
    skylight(2.2),
    window(-1.6),
    window(0.0),
    window(1.6),
    // The open gate on the right, in the evening.
    soft_box([4.2, 0.3, 0.4], [1.6, 1.5], [1.3, 0.7, 0.15], [1.0, 0.72, 0.45]),
];

/// A photographer's table: large soft boxes of daylight and a grey backdrop in a room of wood. 1024 × 512.
pub fn product() -> Result<Environment, MapError> {
    let [backdrop, to_backdrop] = [BACKDROP, TO_BACKDROP].map(Vec3::from_f64);
    let [from, to] = BACKDROP_EDGE;
    room_with("product", &PRODUCT, |direction| {
        let cover = smoothstep(from, to, direction.dot(to_backdrop.normalize()));
        PRODUCT_WALLS.radiance(direction).mix(backdrop, cover)
    })
}

/// A portrait studio: one large warm lamp near the camera, reflectors, a dim room. 1024 × 512.
pub fn portrait() -> Result<Environment, MapError> {
    PORTRAIT_WALLS.with("portrait", &PORTRAIT)
}

/// Two narrow lamps behind the object, warm and cool, in the dark. 1024 × 512.
pub fn rim() -> Result<Environment, MapError> {
    RIM_WALLS.with("rim", &RIM)
}

/// A hall: skylights, windows on one side, a gate on the other. 1024 × 512.
pub fn warehouse() -> Result<Environment, MapError> {
    WAREHOUSE_WALLS.with("warehouse", &WAREHOUSE)
}

/// An overcast sky with a bright place where the sun is, over dry ground, 512 × 256. Its luminance is that of CIE's standard
/// overcast sky, (1 + 2 sin elevation)/3 of that at the zenith (Moon and Spencer 1942).
pub fn overcast() -> Result<Environment, MapError> {
    let sun = vec3(-0.55, 0.62, 0.56).normalize();
    let texels = texels_of(512, 256, |direction| {
        let clouds = vec3(0.93, 0.985, 1.06) * (ZENITH * mix(1.0 / 3.0, 1.0, direction.y.max(0.0)));
        let glow = vec3(1.0, 0.96, 0.88) * (SUN_GLOW * ((direction.dot(sun) - 1.0) / 0.1).exp());
        vec3(0.28, 0.25, 0.215)
            .mix(clouds + glow, smoothstep(-0.06, 0.02, direction.y))
            .to_f32()
    });
    Environment::from_texels("overcast", 512, 256, texels)
}

/// Radiance of the clouds at the zenith.
const ZENITH: f64 = 1.3;
/// Radiance that the sun behind the clouds adds where it stands.
const SUN_GLOW: f64 = 2.2;
