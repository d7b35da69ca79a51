//! The parameters of an area light.

use std::sync::LazyLock;

use super::{
    Kind, Parameter, Stage, Takes,
    accessors::{choice, color, field, rows, toggle},
    line::{ends, real, single},
};
use crate::document::{AreaLight, AreaLightShape, range};

/// Every parameter of an area light, in the order of its rows; the keys are those of project files.
pub static LIGHT_PARAMETERS: LazyLock<Vec<Parameter<AreaLight>>> = LazyLock::new(|| {
    rows! {
        "lighting.area_lights.shape" "Shape" "Rectangle, triangle, disc or sphere; a spot with a cone; or a sun, far away." choice(AreaLightShape shape);
        "lighting.area_lights.yaw_deg" "Yaw" "Turns the light around its target." field(yaw_deg, real(range::YAW_DEG, "°"))
            .bar(-180.0, 180.0).decimals(1);
        "lighting.area_lights.pitch_deg" "Pitch" "Height of the light above the horizon of its target." field(pitch_deg, real(range::PITCH_DEG, "°"))
            .bar(-90.0, 90.0).decimals(1);
        "lighting.area_lights.distance" "Distance" "From its target, in bounding radii of the model." field(distance, real(range::AREA_LENGTH, "")).idle(of_lamps).bar(0.0, 10.0);
        "lighting.area_lights.target" "Target" "What the light looks at: right, up and forwards of the middle of the model, in its bounding radii." field(target, Kind::Place { range: ends(range::LIGHT_TARGET) }).idle(of_lamps);
        "lighting.area_lights.turn_deg" "Turn" "About the line to its target, clockwise seen from there." field(turn_deg, real(range::YAW_DEG, "°")).idle(of_lamps).bar(-180.0, 180.0).decimals(1);
        "lighting.area_lights.width" "Width" "In bounding radii of the model. A small light makes sharp shadows." field(width, real(range::AREA_LENGTH, "")).idle(of_lamps).bar(0.0, 4.0);
        "lighting.area_lights.height" "Height" "In bounding radii of the model." field(height, real(range::AREA_LENGTH, "")).idle(of_flat).bar(0.0, 4.0);
        "lighting.area_lights.cone_deg" "Cone" "The angle across the cone into which a spot shines." field(cone_deg, real(range::CONE_DEG, "°")).idle(of_spots).bar(1.0, 120.0).decimals(1);
        "lighting.area_lights.softness" "Softness" "The share of the cone over which a spot fades to its edge." field(softness, real(0.0..=1.0, "")).idle(of_spots).bar(0.0, 1.0);
        "lighting.area_lights.angle_deg" "Angle" "How large a sun is in the sky; the real one measures 0.53°. A large one makes soft shadows." field(angle_deg, real(range::SUN_ANGLE_DEG, "°")).idle(of_suns).bar(0.05, 10.0);
        "lighting.area_lights.color" "Colour" "Colour of the light." color(color);
        "lighting.area_lights.strength" "Strength" "Radiance of the light: a larger one of the same strength gives more light. Of a sun the irradiance of what faces it." field(strength, single(range::STRENGTH, ""))
            .bar(0.0, 100.0);
        "lighting.area_lights.hidden_from_camera" "Hidden from camera" "It shines, but the camera doesn't see it: only mirrors and glass show it." toggle(is_hidden);
    }
});

fn of_lamps(light: &AreaLight) -> Option<&'static str> {
    light.is_sun().then_some("A sun is too far away for this to matter.")
}

fn of_flat(light: &AreaLight) -> Option<&'static str> {
    let of_sphere = light.is_sphere().then_some("A sphere is as high as it is wide.");
    of_sphere.or_else(|| of_lamps(light))
}

fn of_spots(light: &AreaLight) -> Option<&'static str> {
    (!light.is_spot()).then_some("Only a spot has a cone.")
}

fn of_suns(light: &AreaLight) -> Option<&'static str> {
    (!light.is_sun()).then_some("The size of other lights is their width and height.")
}

fn of(key: &'static str, label: &'static str, help: &'static str, takes: Takes<AreaLight>) -> Parameter<AreaLight> {
    Parameter {
        group: "Area light",
        ..Parameter::plain(key, label, help, takes, Stage::Geometry)
    }
}

impl Parameter<AreaLight> {
    /// The word for it on the command line: its key within the light, without the unit.
    pub fn word(&self) -> &'static str {
        let last = self.key.rsplit('.').next().unwrap_or(self.key);
        last.trim_end_matches("_deg")
    }
}
