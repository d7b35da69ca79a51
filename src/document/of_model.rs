//! What a model's file says beside its shapes, as parts of a document: materials, cameras, lights.

use std::f64::consts::PI;

use glam::DVec3;

use super::{
    AreaLight, AreaLightShape, Bookmark, CameraSettings, CoatLobe, Document, GroupName, ImportLobe, MaterialSettings,
    range,
};
use crate::{
    optics::lobe::Lobe,
    scene::{
        Fate, ImportReport, LIGHTS_MAX, LightKind, Model, ModelCamera, ModelLens, ModelLight,
        camera::{Projection, right_and_up},
    },
};

/// Diameter of the balls and discs that stand for lights of no size, over their distance from the middle of the model or its
/// bounding radius: so small that a disc a tenth of a radius from a surface lights it within 0.02 %. A smaller one far away would be
/// lost in the rounding of its place.
const LIGHT_SIDE: f64 = 0.002;
/// The farthest that a light is put from the model, bounding radii.
const FARTHEST: f64 = 900.0;
/// The field of view that an orthographic camera gets, degrees: its place follows from it.
const PARALLEL_FOV_DEG: f64 = 30.0;

/// The materials of a model's slots.
pub fn materials_of(model: &Model, lobe: ImportLobe) -> Vec<MaterialSettings> {
    let slots = model.slots.iter();
    slots.map(|slot| MaterialSettings::from_slot(slot, lobe)).collect()
}

/// What became of the parts of a model's file whose materials got this lobe.
pub fn import_report(model: &Model, lobe: ImportLobe) -> ImportReport {
    let mut report = model.report.clone();
    if lobe == ImportLobe::Ggx {
        return report;
    }
    for slot in &model.slots {
        let mut note = |what: &str| report.note(Fate::Approximated, what, &slot.name);
        let material = MaterialSettings::from_slot(slot, lobe);
        let has_ggx_below = material.lobe == Lobe::Ggx;
        if has_ggx_below || (material.coat_weight > 0.0 && material.coat_lobe == CoatLobe::Ggx) {
            note("a roughness above 0.7, for which the lobe is GGX");
        }
        if !has_ggx_below && material.transmission_weight > 0.0 && material.roughness > 0.0 {
            note("a rough refraction, as wide as that of GGX but without its tail");
        }
    }
    report
}

/// Message if lights of a file found no room.
pub fn lights_left_out(count: usize) -> Option<String> {
    (count > 0).then(|| format!("{count} lights of the file are left out: there may be {LIGHTS_MAX} in all"))
}

impl Document {
    /// Adds the lights of a model, and its cameras as bookmarks: those that are not there already. Returns how many lights
    /// found no room.
    pub fn add_lights_and_cameras(&mut self, model: &Model) -> usize {
        let mut left_out = 0;
        let lights = &mut self.lighting.area_lights;
        // Two of the file may be alike.
        let there = lights.len();
        for light in model.lights.iter().map(|light| area_light(light, model)) {
            let is_there = |own: &AreaLight| {
                AreaLight {
                    group: light.group,
                    is_hidden: false,
                    is_muted: false,
                    ..*own
                } == light
            };
            if lights[..there].iter().any(is_there) {
                continue;
            }
            if lights.len() < LIGHTS_MAX {
                lights.push(light);
            } else {
                left_out += 1;
            }
        }
        for bookmark in model.cameras.iter().map(|camera| bookmark(camera, model)) {
            if !self.bookmarks.contains(&bookmark) {
                self.bookmarks.push(bookmark);
            }
        }
        left_out
    }
}

/// The light with the intensity of the file's: a small ball, a small disc with a cone, or a sun.
fn area_light(light: &ModelLight, model: &Model) -> AreaLight {
    let brightest = light.color.into_iter().fold(0.0_f32, f32::max);
    let white = AreaLight {
        color: light
            .color
            .map(|channel| (channel / brightest.max(f32::MIN_POSITIVE)).clamp(0.0, 1.0)),
        group: GroupName::new("model"),
        ..AreaLight::default()
    };
    let intensity = f64::from(light.intensity.max(0.0) * brightest);
    let forward = DVec3::from_array(light.forward);
    let (shape, cone) = match light.kind {
        LightKind::Directional => {
            let mut sun = AreaLight {
                strength: intensity.min(*range::STRENGTH.end()) as f32,
                color: white.color,
                group: white.group,
                ..AreaLight::sun()
            };
            sun.look_from(-forward);
            return sun;
        }
        LightKind::Point => (AreaLightShape::Sphere, [0.0; 2]),
        LightKind::Spot(cone) => (AreaLightShape::Spot, cone),
    };
    let radius = model.radius.max(f64::MIN_POSITIVE);
    let place = (DVec3::from_array(light.position) - DVec3::from_array(model.center)) / radius;
    // What is farther away is put nearer, as bright at the model as before.
    let nearer = place.clamp_length_max(FARTHEST);
    let intensity = intensity / (radius * radius) * (nearer.length() / place.length().max(f64::MIN_POSITIVE)).powi(2);
    let mut lamp = AreaLight { shape, ..white };
    aim(&mut lamp, nearer, forward);
    put_cone(&mut lamp, cone);
    put_intensity(&mut lamp, intensity, LIGHT_SIDE * nearer.length().max(1.0));
    lamp
}

/// Puts a lamp at a place, looking along `forward` at what is nearest to the middle of the model; a ball looks there.
fn aim(lamp: &mut AreaLight, place: DVec3, forward: DVec3) {
    let (least, most) = range::AREA_LENGTH.into_inner();
    let forward = if lamp.is_sphere() {
        (-place).normalize_or(forward)
    } else {
        forward
    };
    let along = -place.dot(forward);
    lamp.distance = if along > least { along.min(most) } else { 1.0 };
    lamp.target = (place + lamp.distance * forward).to_array();
    lamp.look_from(-forward);
}

fn put_cone(lamp: &mut AreaLight, [inner, outer]: [f64; 2]) {
    if lamp.is_spot() {
        let (narrowest, widest) = range::CONE_DEG.into_inner();
        lamp.cone_deg = (2.0 * outer).to_degrees().clamp(narrowest, widest);
        lamp.softness = (1.0 - inner / outer.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    }
}

/// Gives a lamp the radiance of an intensity straight on, per squared bounding radius; a size at which its strength is one
/// that it takes, and no less than `least`.
fn put_intensity(lamp: &mut AreaLight, intensity: f64, least: f64) {
    let brightest = *range::STRENGTH.end();
    let needed = (intensity / (0.25 * PI * brightest)).sqrt();
    let side = least.max(needed).min(*range::AREA_LENGTH.end());
    (lamp.width, lamp.height) = (side, side);
    lamp.strength = (intensity / (0.25 * PI * side * side)).min(brightest) as f32;
}

/// The camera, looking at the place on its line of sight that is nearest to the middle of the model.
fn bookmark(camera: &ModelCamera, model: &Model) -> Bookmark {
    let (mut position, forward) = (DVec3::from_array(camera.position), DVec3::from_array(camera.forward));
    let along = forward.dot(DVec3::from_array(model.center) - position);
    let target = position + forward * if along > 0.0 { along } else { model.radius };
    let (narrowest, widest) = (*range::FOV_DEG.start(), *range::FOV_DEG.end());
    let (fov_deg, projection) = match camera.lens {
        ModelLens::Perspective(fov_deg) => (fov_deg.clamp(narrowest, widest), Projection::Perspective),
        ModelLens::Orthographic(height) => {
            position = target - forward * (0.5 * height / (0.5 * PARALLEL_FOV_DEG.to_radians()).tan());
            (PARALLEL_FOV_DEG, Projection::Orthographic)
        }
    };
    // From the upright camera's up to the file's, clockwise.
    let [right, upright] = right_and_up(forward);
    let up = DVec3::from_array(camera.up);
    let roll_deg = up.dot(right).atan2(up.dot(upright)).to_degrees();
    Bookmark {
        name: camera.name.clone(),
        camera: CameraSettings {
            target: Some(target.to_array()),
            position: Some(position.to_array()),
            fov_deg,
            projection,
            roll_deg: if roll_deg.abs() < 0.0001 { 0.0 } else { roll_deg },
            ..CameraSettings::default()
        },
    }
}
