//! The camera as it is moved about a target.

use glam::DVec3;

use super::*;
use crate::{document::CameraSettings, scene::camera::framing_distance};

/// Degrees of a turn for a drag of one point.
const DEG_PER_POINT: f64 = 0.35;
/// Bounds of the distance, in bounding radii of the model.
const DISTANCE_RADII: [f64; 2] = [0.01, 200.0];

/// The camera with every number filled in, scene units.
#[derive(Clone, Copy, PartialEq)]
pub struct Orbit {
    target: DVec3,
    yaw_deg: f64,
    pitch_deg: f64,
    distance: f64,
    /// The model's bounding radius.
    radius: f64,
    fov_deg: f64,
    roll_deg: f64,
}

impl Orbit {
    /// The settings' camera; what they leave open is taken from what is being rendered.
    pub fn new(camera: &CameraSettings, job: &Job) -> Self {
        let geometry = &job.geometry;
        let radius = geometry.world_units_per_unit;
        let target = camera.target.map_or(geometry.center_world, DVec3::from_array);
        let [width, height] = job.settings.image_size.map(f64::from);
        let framing = framing_distance(camera.fov_deg, width / height.max(1.0));
        let distance = camera.distance.unwrap_or(framing * radius);
        let mut orbit = Self {
            target,
            yaw_deg: camera.yaw_deg,
            pitch_deg: camera.pitch_deg,
            distance,
            radius,
            fov_deg: camera.fov_deg,
            roll_deg: camera.roll_deg,
        };
        if let Some(position) = camera.position {
            let away = DVec3::from_array(position) - target;
            orbit.distance = away.length().max(1e-6 * radius);
            orbit.yaw_deg = away.x.atan2(away.z).to_degrees();
            orbit.pitch_deg = (away.y / orbit.distance).clamp(-1.0, 1.0).asin().to_degrees();
        }
        orbit
    }

    /// Turns about the target as if it were taken hold of; `points` to the right and down.
    pub fn turn(&mut self, points: [f64; 2]) {
        if points == [0.0; 2] {
            return;
        }
        self.yaw_deg = (self.yaw_deg - DEG_PER_POINT * points[0] + 180.0).rem_euclid(360.0) - 180.0;
        self.pitch_deg = (self.pitch_deg + DEG_PER_POINT * points[1]).clamp(-90.0, 90.0);
    }

    /// Moves the target so that it follows a drag by `shift` heights of the image, to the right and down.
    pub fn pan(&mut self, shift: [f64; 2]) {
        let (yaw, pitch) = (self.yaw_deg.to_radians(), self.pitch_deg.to_radians());
        let right = DVec3::new(yaw.cos(), 0.0, -yaw.sin());
        let up = DVec3::new(-pitch.sin() * yaw.sin(), pitch.cos(), -pitch.sin() * yaw.cos());
        let (sine, cosine) = self.roll_deg.to_radians().sin_cos();
        let (right, up) = (right * cosine - up * sine, up * cosine + right * sine);
        let height = 2.0 * self.distance * (0.5 * self.fov_deg.to_radians()).tan();
        self.target += height * (up * shift[1] - right * shift[0]);
    }

    pub fn zoom(&mut self, factor: f64) {
        if factor != 1.0 {
            let [near, far] = DISTANCE_RADII.map(|radii| radii * self.radius);
            self.distance = (self.distance * factor).clamp(near, far);
        }
    }

    /// Writes what was moved; the target and the distance only where they were, so that an untouched camera goes on
    /// framing any model that comes. What the edit is called, and what others of its kind have in common.
    pub fn write(&self, before: &Self, camera: &mut CameraSettings) -> Option<(&'static str, &'static str)> {
        if self == before {
            return None;
        }
        let is_farther = self.distance != before.distance;
        if camera.position.take().is_some() || is_farther {
            camera.distance = Some(self.distance);
        }
        (camera.yaw_deg, camera.pitch_deg) = (self.yaw_deg, self.pitch_deg);
        if self.target != before.target {
            camera.target = Some(self.target.to_array());
            return Some(("Pan", "pan"));
        }
        Some(if is_farther {
            ("Zoom", "zoom")
        } else {
            ("Turn the camera", "turn")
        })
    }
}
