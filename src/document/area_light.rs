//! Lights of the document's own: rectangles and triangles that shine.

use std::ops::RangeInclusive;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{MaterialSettings, range};
use crate::named::named;
use crate::scene::light::AreaShape;

/// A rectangle that shines with the same radiance from both sides, seen by the camera like anything else. It looks at
/// the centre of the model's bounding box, around which yaw and pitch turn as a camera's. Lengths are in units of the
/// model's bounding radius.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct AreaLight {
    /// Azimuth, degrees.
    pub yaw_deg: f64,
    /// Height, degrees in [−90, 90].
    pub pitch_deg: f64,
    /// Distance from the centre, bounding radii.
    pub distance: f64,
    /// Horizontal side, bounding radii.
    pub width: f64,
    /// Other side, bounding radii.
    pub height: f64,
    /// Its shape.
    pub shape: AreaLightShape,
    /// Linear RGB in [0, 1].
    pub color: [f32; 3],
    /// Radiance of white.
    pub strength: f32,
    /// It does not shine, and is not there.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub is_muted: bool,
}

impl Default for AreaLight {
    fn default() -> Self {
        Self {
            yaw_deg: -35.0,
            pitch_deg: 40.0,
            distance: 3.0,
            width: 1.0,
            height: 1.0,
            shape: AreaLightShape::Quad,
            color: [1.0; 3],
            strength: 10.0,
            is_muted: false,
        }
    }
}

impl AreaLight {
    /// Where it is and how large.
    pub fn shape(&self) -> AreaShape {
        AreaShape {
            yaw_deg: self.yaw_deg,
            pitch_deg: self.pitch_deg,
            distance: self.distance,
            width: self.width,
            height: self.height,
            is_triangle: self.shape == AreaLightShape::Triangle,
        }
    }

    /// Turns it around the model so that its middle is seen mirrored at a place: `mirrored` is the direction, of length 1,
    /// in which the viewer's ray leaves from there. Both in the geometry's units, the middle of the model at the origin.
    /// Where the place is farther out than the light it is moved outwards, too.
    pub fn put_highlight(&mut self, place: DVec3, mirrored: DVec3) {
        let beyond = self.distance.max(1.5 * place.length());
        self.distance = beyond.min(*range::AREA_LENGTH.end());
        let along = place.dot(mirrored);
        let below_root = along * along + self.distance * self.distance - place.length_squared();
        let middle = place + mirrored * (below_root.max(0.0).sqrt() - along);
        let [x, y, z] = middle.normalize_or(mirrored).to_array();
        self.yaw_deg = x.atan2(z).to_degrees();
        self.pitch_deg = y.clamp(-1.0, 1.0).asin().to_degrees();
    }

    /// What it is checked for.
    pub(super) fn numbers(&self) -> impl Iterator<Item = (&'static str, f64, RangeInclusive<f64>)> {
        use range as r;
        let [red, green, blue] = self.color.map(f64::from);
        let color = |value| ("lighting.area_lights.color", value, r::COLOR);
        [
            ("lighting.area_lights.yaw_deg", self.yaw_deg, r::YAW_DEG),
            ("lighting.area_lights.pitch_deg", self.pitch_deg, r::PITCH_DEG),
            ("lighting.area_lights.distance", self.distance, r::AREA_LENGTH),
            ("lighting.area_lights.width", self.width, r::AREA_LENGTH),
            ("lighting.area_lights.height", self.height, r::AREA_LENGTH),
            ("lighting.area_lights.strength", f64::from(self.strength), r::STRENGTH),
            color(red),
            color(green),
            color(blue),
        ]
        .into_iter()
    }

    /// Its surface: black but for what it emits.
    pub fn material(&self) -> MaterialSettings {
        MaterialSettings {
            emission_color: self.color,
            emission_strength: self.strength,
            ..MaterialSettings::diffuse("area light", [0.0; 3])
        }
    }
}

named! {
    /// The shape of an area light.
    #[derive(Default)]
    AreaLightShape {
        #[default]
        Quad = 0, "quad", "Rectangle", "Two sides, width and height.";
        Triangle = 1, "triangle", "Triangle", "Width is its base, height its height; the tip is up.";
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::camera::orbit_direction;

    #[test]
    fn a_highlight_is_where_the_lights_middle_is_mirrored() {
        for (place, mirrored) in [
            (DVec3::new(0.3, 0.5, 0.6), DVec3::new(-0.6, 0.64, 0.48)),
            (DVec3::ZERO, DVec3::Y),
            (DVec3::new(8.0, -1.0, 3.0), DVec3::new(0.0, 1.0, 0.0)),
        ] {
            let mut light = AreaLight::default();
            light.put_highlight(place, mirrored);
            let middle = light.distance * orbit_direction(light.yaw_deg, light.pitch_deg);
            let seen = (middle - place).normalize();
            assert!(seen.distance(mirrored) < 1e-9, "{place} {mirrored}: {light:?}");
            assert!(light.distance >= AreaLight::default().distance);
        }
    }
}
