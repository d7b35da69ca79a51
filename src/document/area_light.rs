//! Lights of the document's own: rectangles, triangles, discs and spheres that shine, spots and suns.

use std::f64::consts::PI;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{GroupName, MaterialSettings, ProfileFile, range};
use crate::{
    named::{named, with_defaults},
    optics::{material::Material, vector::Vec3},
    scene::{AreaFrame, AreaShape, Outline, catcher::NearLight},
};

/// How far away a sun is, bounding radii: its light is parallel to a hundredth of a degree.
pub const SUN_DISTANCE: f64 = 1e4;
/// The narrowest ramp of a spot's edge, in the cosine.
const RAMP_MIN: f64 = 0.0001;

with_defaults! {
    /// A surface that shines and is seen by the camera like anything else: with the same radiance to both sides, or into a cone
    /// where it is a spot. It looks at its target, around which yaw and pitch turn as a camera's. Lengths are in units of the
    /// model's bounding radius.
    #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(default)]
    pub struct AreaLight {
        /// Azimuth, degrees.
        pub yaw_deg: f64 = -35.0,
        /// Height, degrees in [−90, 90].
        pub pitch_deg: f64 = 40.0,
        /// Distance from the target, bounding radii; a sun's is [`SUN_DISTANCE`].
        pub distance: f64 = 3.0,
        /// What it looks at, relative to the centre of the model's bounding box, bounding radii.
        pub target: [f64; 3],
        /// Turn about the line to its target, clockwise seen from there, degrees.
        pub turn_deg: f64,
        /// Horizontal side, bounding radii.
        pub width: f64 = 1.0,
        /// Other side, bounding radii.
        pub height: f64 = 1.0,
        pub shape: AreaLightShape = AreaLightShape::Quad,
        /// The angle across a spot's cone, degrees.
        pub cone_deg: f64 = 40.0,
        /// The share of the cone's angle over which it fades to its edge, in [0, 1].
        pub softness: f64 = 0.2,
        /// The angle across a sun, degrees.
        pub angle_deg: f64 = 0.53,
        /// Linear RGB in [0, 1].
        pub color: [f32; 3] = [1.0; 3],
        /// Radiance of white; a sun's irradiance at the model.
        pub strength: f32 = 10.0,
        /// The file of its intensities by direction, which a sphere alone takes; the power is as without.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub profile: Option<ProfileFile>,
        /// Its light group; without a name that of its kind, see [`AreaLight::group_name`].
        #[serde(skip_serializing_if = "GroupName::is_empty")]
        pub group: GroupName,
        /// It shines and throws shadows, but the camera does not see it, except in mirrors and through glass.
        #[serde(rename = "hidden_from_camera", skip_serializing_if = "std::ops::Not::not")]
        pub is_hidden: bool,
        /// It does not shine, and is not there.
        #[serde(skip_serializing_if = "std::ops::Not::not")]
        pub is_muted: bool,
    }
}

impl AreaLight {
    /// A small lamp with a cone.
    pub fn spot() -> Self {
        Self {
            shape: AreaLightShape::Spot,
            width: 0.3,
            height: 0.3,
            strength: 200.0,
            ..Self::default()
        }
    }

    /// The sun, as bright as a white sky of radiance 1.
    pub fn sun() -> Self {
        Self {
            shape: AreaLightShape::Sun,
            strength: PI as f32,
            ..Self::default()
        }
    }

    /// Whether it sends its light into a cone.
    pub fn is_spot(&self) -> bool {
        self.shape == AreaLightShape::Spot
    }

    /// Whether its light depends on the direction as a file says.
    pub fn has_profile(&self) -> bool {
        self.is_sphere() && self.profile.is_some()
    }

    /// Whether it is as far away as the sun.
    pub fn is_sun(&self) -> bool {
        self.shape == AreaLightShape::Sun
    }

    /// Where it is and how large.
    pub fn shape(&self) -> AreaShape {
        let outline = match self.shape {
            AreaLightShape::Quad => Outline::Rectangle,
            AreaLightShape::Triangle => Outline::Triangle,
            AreaLightShape::Disc | AreaLightShape::Spot | AreaLightShape::Sun => Outline::Ellipse,
            AreaLightShape::Sphere => Outline::Sphere,
        };
        let seen = AreaShape {
            target: self.target,
            yaw_deg: self.yaw_deg,
            pitch_deg: self.pitch_deg,
            distance: self.distance,
            width: self.width,
            height: self.seen_height(),
            turn_deg: self.turn_deg,
            outline,
        };
        if !self.is_sun() {
            return seen;
        }
        let across = 2.0 * SUN_DISTANCE * self.half_angle_rad().tan();
        AreaShape {
            target: [0.0; 3],
            distance: SUN_DISTANCE,
            width: across,
            height: across,
            turn_deg: 0.0,
            ..seen
        }
    }

    /// Whether it is a ball, which has a width alone.
    pub fn is_sphere(&self) -> bool {
        self.shape == AreaLightShape::Sphere
    }

    /// Its other side: a sphere is as high as it is wide.
    fn seen_height(&self) -> f64 {
        if self.is_sphere() { self.width } else { self.height }
    }

    fn half_angle_rad(&self) -> f64 {
        0.5 * self.angle_deg.to_radians()
    }

    /// The cosines of half the angles within which a spot is as bright as it gets, and outside which it is dark.
    fn cone_cosines(&self) -> [f64; 2] {
        let outer_rad = 0.5 * self.cone_deg.to_radians();
        let outer = outer_rad.cos();
        let inner = (outer_rad * (1.0 - self.softness)).cos();
        [inner.max(outer + RAMP_MIN), outer]
    }

    /// Radiance of white.
    pub fn radiance(&self) -> f64 {
        let strength = f64::from(self.strength);
        if self.is_sun() {
            strength / (PI * self.half_angle_rad().sin().powi(2))
        } else {
            strength
        }
    }

    /// Luminous flux in lumens where a radiance of 1 is a luminance of 1 cd/m² and a bounding radius this many metres; for
    /// a sun its illuminance in lux.
    pub fn power(&self, radius_m: f64) -> f64 {
        f64::from(self.strength) * self.power_of_one(radius_m)
    }

    /// Gives it the strength at which [`AreaLight::power`] is this, or the nearest that it takes; black stays black.
    pub fn set_power(&mut self, power: f64, radius_m: f64) {
        let of_one = self.power_of_one(radius_m);
        if of_one > 0.0 {
            let (least, most) = range::STRENGTH.into_inner();
            self.strength = (power / of_one).clamp(least, most) as f32;
        }
    }

    /// The power at strength 1.
    fn power_of_one(&self, radius_m: f64) -> f64 {
        let luminance = Vec3::<f64>::from_f32(self.color).luminance();
        let share = match self.shape {
            AreaLightShape::Sun => return luminance,
            AreaLightShape::Quad => 1.0,
            AreaLightShape::Triangle => 0.5,
            AreaLightShape::Disc | AreaLightShape::Spot => 0.25 * PI,
            // Four times its disc, of which one side shines outwards.
            AreaLightShape::Sphere => 0.5 * PI,
        };
        let area_m2 = share * self.width * self.seen_height() * radius_m * radius_m;
        // What leaves a place, over its radiance: π to each side, or the integral of share × cosine over the cone.
        let projected_sr = if self.is_spot() {
            let [inner, outer] = self.cone_cosines();
            let ramp = inner - outer;
            PI * (1.0 - inner * inner) + 2.0 * PI * ramp * (outer / 3.0 + ramp / 4.0)
        } else {
            2.0 * PI
        };
        luminance * area_m2 * projected_sr
    }

    /// Turns it around its target so that its middle is seen mirrored at a place: `mirrored` is the direction, of length 1,
    /// in which the viewer's ray leaves from there. Both in the geometry's units, the middle of the model at the origin.
    /// Where the place is farther out than the light it is moved outwards, too. A spot looks at the place from then on.
    pub fn put_highlight(&mut self, place: DVec3, mirrored: DVec3) {
        if self.is_spot() {
            let (least, most) = range::LIGHT_TARGET.into_inner();
            self.target = place.to_array().map(|x| x.clamp(least, most));
        }
        let place = if self.is_sun() {
            DVec3::ZERO
        } else {
            place - DVec3::from_array(self.target)
        };
        let beyond = self.distance.max(1.5 * place.length());
        self.distance = beyond.min(*range::AREA_LENGTH.end());
        let along = place.dot(mirrored);
        let below_root = along * along + self.distance * self.distance - place.length_squared();
        let middle = place + mirrored * (below_root.max(0.0).sqrt() - along);
        self.look_from(middle.normalize_or(mirrored));
    }

    /// Puts it in this direction of length 1 from its target.
    pub fn look_from(&mut self, outwards: DVec3) {
        let [x, y, z] = outwards.to_array();
        // Straight above or below any yaw is right: the one that it has.
        if x != 0.0 || z != 0.0 {
            self.yaw_deg = x.atan2(z).to_degrees();
        }
        self.pitch_deg = y.clamp(-1.0, 1.0).asin().to_degrees();
    }

    /// Its surface: black but for what it emits.
    pub fn material(&self) -> MaterialSettings {
        MaterialSettings {
            emission_color: self.color,
            emission_strength: self.radiance() as f32,
            ..MaterialSettings::diffuse("area light", [0.0; 3])
        }
    }

    /// How it lights a shadow catcher.
    pub fn seen_from_near(&self) -> NearLight {
        let radiance = self.radiance();
        NearLight {
            shape: self.shape(),
            radiance: self.color.map(|channel| f64::from(channel) * radiance),
            spot: self.shine().ramp(),
        }
    }

    /// All that its compiled surface depends on.
    pub fn shine(&self) -> Shine {
        Shine {
            color: self.color,
            radiance: self.radiance() as f32,
            cone_cosines: self.is_spot().then(|| self.cone_cosines()),
            profile: self
                .profile
                .filter(|_| self.has_profile())
                .map(|file| (file, self.shape().frame())),
            is_sun: self.is_sun(),
        }
    }
}

/// How the surface of an area light shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shine {
    color: [f32; 3],
    radiance: f32,
    cone_cosines: Option<[f64; 2]>,
    profile: Option<(ProfileFile, AreaFrame)>,
    is_sun: bool,
}

impl Shine {
    /// Scale and offset of a spot's ramp, see [`spot_share`](crate::scene::light::spot_share); 0 and 1 of other lights.
    fn ramp(&self) -> [f64; 2] {
        let Some([inner, outer]) = self.cone_cosines else {
            return [0.0, 1.0];
        };
        let scale = 1.0 / (inner - outer);
        [scale, -outer * scale]
    }

    /// The file of its profile, and how it lies.
    pub fn profile(&self) -> Option<(ProfileFile, AreaFrame)> {
        self.profile
    }

    /// What of its compiled surface a material of the model can't have: a spot's cone, and how often a sun is drawn, which
    /// its irradiance says and not its area.
    pub fn finish(&self, material: &mut Material<f32>) {
        [material.spot_scale, material.spot_offset] = self.ramp().map(|number| number as f32);
        if self.is_sun {
            material.light_luminance *= (SUN_DISTANCE * SUN_DISTANCE).recip() as f32;
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
        Disc = 2, "disc", "Disc", "A circle or an ellipse: width and height are its axes.";
        Spot = 3, "spot", "Spot", "A disc that sends its light into a cone around its target.";
        Sphere = 5, "sphere", "Sphere", "A ball that shines in all directions alike: the width is its diameter.";
        Sun = 4, "sun", "Sun", "A disc so far away that its light is parallel.";
    }
}
