//! Grounds: a plane, or a cyclorama, which curves up into a wall behind the model.

use glam::{DQuat, DVec2, DVec3, dvec2};

use super::{mesh::Mesh, shapes};

/// The plane's half side in bounding radii.
pub(super) const HALF_SIDE: f64 = 20.0;
/// The cyclorama's wall ends so far above the floor, bounding radii.
const WALL_HEIGHT: f64 = 20.0;
/// Cells of the cyclorama's bend.
const BEND_STEPS: u32 = 48;

/// A ground. Lengths are in bounding radii of the model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Ground {
    #[default]
    None,
    /// A horizontal square of half side 20.
    Plane,
    /// A floor that bends up into a wall.
    Cyclorama(Cyclorama),
}

/// Shape of a cyclorama. Lengths are in bounding radii of the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cyclorama {
    /// Azimuth, in degrees, of the side that is open, as a camera's: at 0 the wall is on the −Z side.
    pub yaw_deg: f64,
    /// Distance from the model's centre to the wall, above 0.
    pub distance: f64,
    /// Radius of the bend, above 0; no more than the distance is used.
    pub radius: f64,
}

impl From<bool> for Ground {
    fn from(is_there: bool) -> Self {
        if is_there { Self::Plane } else { Self::None }
    }
}

impl Ground {
    /// Its triangles with the floor at `height`; `None` without a ground.
    pub(super) fn mesh(self, height: f64, slot: u32) -> Option<Mesh> {
        match self {
            Self::None => None,
            Self::Plane => Some(shapes::square(DVec3::Y * height, HALF_SIDE, HALF_SIDE as f32, slot)),
            Self::Cyclorama(cyclorama) => Some(cyclorama.mesh(height, slot)),
        }
    }
}

impl Cyclorama {
    /// Floor, bend and wall, as wide as the plane; u runs along the wall, v from the floor's open end upwards.
    fn mesh(&self, height: f64, slot: u32) -> Mesh {
        let mut mesh = Mesh::default();
        let turn = DQuat::from_rotation_y(self.yaw_deg.to_radians());
        let profile = self.profile();
        let mut length = 0.0;
        for (index, &[place, normal]) in profile.iter().enumerate() {
            length += index
                .checked_sub(1)
                .map_or(0.0, |last| profile[last][0].distance(place));
            for side in [-HALF_SIDE, HALF_SIDE] {
                let position = turn * DVec3::new(side, height + place.y, place.x);
                let normal = (turn * DVec3::new(0.0, normal.y, normal.x)).as_vec3();
                let tangent = (turn * DVec3::X).as_vec3().extend(1.0);
                mesh.push_vertex(position, normal, dvec2(side, length).as_vec2(), tangent);
            }
        }
        for row in (0..profile.len() as u32 - 1).map(|row| 2 * row) {
            mesh.push_triangle([row, row + 1, row + 3], slot);
            mesh.push_triangle([row, row + 3, row + 2], slot);
        }
        mesh
    }

    /// Places and normals of its section: along +Z and upwards, from the open end of the floor to the top of the wall.
    fn profile(&self) -> Vec<[DVec2; 2]> {
        let radius = self.radius.min(self.distance);
        let center = dvec2(radius - self.distance, radius);
        let bend = (0..=BEND_STEPS).map(|step| {
            let angle = std::f64::consts::FRAC_PI_2 * f64::from(step) / f64::from(BEND_STEPS);
            let normal = dvec2(angle.sin(), angle.cos());
            [center - radius * normal, normal]
        });
        let mut profile = vec![[dvec2(HALF_SIDE, 0.0), DVec2::Y]];
        profile.extend(bend);
        profile.push([dvec2(-self.distance, WALL_HEIGHT.max(2.0 * radius)), DVec2::X]);
        profile
    }
}
