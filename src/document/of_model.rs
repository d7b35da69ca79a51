//! What a model's file says beside its shapes, as parts of a document: materials, cameras, lights.

use glam::DVec3;

use super::import::ROUGHNESS_MAX;
use super::{AreaLight, AreaLightShape, Bookmark, CameraSettings, Document, ImportLobe, MaterialSettings, range};
use crate::scene::{Fate, ImportReport, LightKind, Model, ModelCamera, ModelLight};

/// Sides of the squares that stand for lights of no size, bounding radii.
const LIGHT_SIDE: f64 = 0.1;
/// How far away a light is that shines from everywhere far away, bounding radii.
const FAR: f64 = 20.0;
/// Sides of its square, bounding radii: as large as the sun would be, twenty times over.
const FAR_SIDE: f64 = 4.0;

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
        let mut tell = |what: &str| report.note(Fate::Approximated, what, &slot.name);
        if lobe.of_slot(slot) != lobe {
            tell("a roughness above 0.7, for which the lobe is GGX");
        } else if slot.transmission > 0.0 && slot.roughness > 0.0 {
            tell("a rough refraction, as wide as that of GGX but without its tail");
        }
        if slot.coat > 0.0 && slot.coat_roughness > ROUGHNESS_MAX {
            tell("a coat's roughness above 0.7, taken as 0.7");
        }
    }
    report
}

impl Document {
    /// Adds the lights of a model, as squares that look at its middle, and its cameras as bookmarks: those that are not
    /// there already.
    pub fn add_lights_and_cameras(&mut self, model: &Model) {
        let most = *range::AREA_LIGHTS.end() as usize;
        for light in model.lights.iter().map(|light| area_light(light, model)) {
            let lights = &mut self.lighting.area_lights;
            let is_there = |own: &AreaLight| {
                AreaLight {
                    is_muted: false,
                    ..*own
                } == light
            };
            if lights.len() < most && !lights.iter().any(is_there) {
                lights.push(light);
            }
        }
        for bookmark in model.cameras.iter().map(|camera| bookmark(camera, model)) {
            if !self.bookmarks.contains(&bookmark) {
                self.bookmarks.push(bookmark);
            }
        }
    }
}

/// A square of the same intensity towards the middle of the model, and from the same direction.
fn area_light(light: &ModelLight, model: &Model) -> AreaLight {
    let radius = model.radius.max(f64::MIN_POSITIVE);
    let is_far = light.kind == LightKind::Directional;
    let from_middle = if is_far {
        -FAR * DVec3::from_array(light.forward)
    } else {
        (DVec3::from_array(light.position) - DVec3::from_array(model.center)) / radius
    };
    let (shortest, longest) = (*range::AREA_LENGTH.start(), *range::AREA_LENGTH.end());
    let distance = from_middle.length().clamp(shortest, longest);
    let toward = from_middle.normalize_or(DVec3::Y);
    let side = if is_far { FAR_SIDE } else { LIGHT_SIDE };
    // Candela are radiance times area; lux are that over the squared distance.
    let area = if is_far {
        (side / distance).powi(2)
    } else {
        (side * radius).powi(2)
    };
    let brightest = light.color.into_iter().fold(0.0_f32, f32::max);
    let strength = f64::from(light.intensity.max(0.0) * brightest) / area;
    AreaLight {
        yaw_deg: toward.x.atan2(toward.z).to_degrees(),
        pitch_deg: toward.y.clamp(-1.0, 1.0).asin().to_degrees(),
        distance,
        width: side,
        height: side,
        shape: AreaLightShape::Quad,
        color: light
            .color
            .map(|channel| (channel / brightest.max(f32::MIN_POSITIVE)).clamp(0.0, 1.0)),
        strength: strength.clamp(0.0, *range::STRENGTH.end()) as f32,
        ..AreaLight::default()
    }
}

/// The camera, looking at the place on its line of sight that is nearest to the middle of the model.
fn bookmark(camera: &ModelCamera, model: &Model) -> Bookmark {
    let (position, forward) = (DVec3::from_array(camera.position), DVec3::from_array(camera.forward));
    let along = forward.dot(DVec3::from_array(model.center) - position);
    let target = position + forward * if along > 0.0 { along } else { model.radius };
    let (narrowest, widest) = (*range::FOV_DEG.start(), *range::FOV_DEG.end());
    Bookmark {
        name: camera.name.clone(),
        camera: CameraSettings {
            target: Some(target.to_array()),
            position: Some(camera.position),
            fov_deg: camera.fov_deg.clamp(narrowest, widest),
            ..CameraSettings::default()
        },
    }
}
