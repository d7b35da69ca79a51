//! Area lights as shapes: rectangles, triangles, ellipses and balls.

use glam::{DQuat, DVec3};

use super::{camera::orbit_direction, camera::right_and_up, mesh::Mesh, shapes};

/// Placement of an area light. Positions are relative to the centre of the model's bounding box; they and lengths are in
/// units of its bounding radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaShape {
    /// Target that the light faces.
    pub target: [f64; 3],
    /// Azimuth in degrees, as a camera's: 0 on the +Z side, 90 on the +X side.
    pub yaw_deg: f64,
    /// Height above the horizon in degrees.
    pub pitch_deg: f64,
    /// Distance of its middle from the target, above 0.
    pub distance: f64,
    /// Horizontal side, above 0.
    pub width: f64,
    /// Other side, above 0.
    pub height: f64,
    /// Rotation about the line to its target in degrees, clockwise seen from there.
    pub turn_deg: f64,
    /// Outline of the light.
    pub outline: Outline,
}

/// Outline of an area light within its width and height.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outline {
    Rectangle,
    /// The width is its base; its tip is at the middle of the upper side.
    Triangle,
    /// Width and height are its axes.
    Ellipse,
    /// A ball as large as the width.
    Sphere,
}

/// The middle of an area light, and unit vectors along its sides and away from its target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaFrame {
    /// Centre, in the geometry's units.
    pub middle: DVec3,
    /// Unit axis of its width, to the right seen from the target.
    pub across: DVec3,
    /// Unit axis of its height, upwards.
    pub up: DVec3,
    /// Unit direction from the target to the centre.
    pub outwards: DVec3,
}

impl AreaShape {
    /// Position and axes of the light.
    pub fn frame(&self) -> AreaFrame {
        let outwards = orbit_direction(self.yaw_deg, self.pitch_deg);
        let [left, mut up] = right_and_up(-outwards);
        let mut across = -left;
        if self.turn_deg != 0.0 {
            let turn = DQuat::from_axis_angle(outwards, self.turn_deg.to_radians());
            (across, up) = (turn * across, turn * up);
        }
        AreaFrame {
            middle: DVec3::from_array(self.target) + self.distance * outwards,
            across,
            up,
            outwards,
        }
    }

    /// Its triangles in the geometry's units, facing the target.
    pub fn mesh(&self, slot: u32) -> Mesh {
        let AreaFrame { middle, across, up, .. } = self.frame();
        let (half_u, half_v) = (across * (0.5 * self.width), up * (-0.5 * self.height));
        match self.outline {
            Outline::Rectangle => shapes::rectangle(middle, half_u, half_v, 1.0, slot),
            Outline::Triangle => shapes::triangle(middle, half_u, half_v, slot),
            Outline::Ellipse => shapes::ellipse(middle, half_u, half_v, slot),
            Outline::Sphere => shapes::ball(middle, 0.5 * self.width, slot),
        }
    }

    /// The corners of its triangles, in the geometry's units.
    pub fn corners(&self) -> Vec<[DVec3; 3]> {
        let mesh = self.mesh(0);
        (0..mesh.triangles.len())
            .map(|triangle| mesh.corners(triangle))
            .collect()
    }

    /// Whether one of its triangles is seen from a place: of a ball the near ones alone.
    pub fn shows(&self, [a, b, c]: &[DVec3; 3], place: DVec3) -> bool {
        self.outline != Outline::Sphere || (b - a).cross(c - a).dot(place - a) > 0.0
    }
}
