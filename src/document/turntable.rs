//! The frames of a turntable: one document turned once about the vertical axis.

use super::Document;
use crate::named::named;

named! {
    #[derive(Default)]
    Turn {
        #[default]
        Camera, "camera", "Camera", "The camera goes around; model and light stay.";
        Model, "model", "Model", "The model turns where it stands; camera and light stay.";
        Light, "light", "Light", "Environment and area lights go around; camera and model stay.";
    }
}

/// The document of a frame, counted from 0 to `frames` − 1, anticlockwise seen from above; frame 0 is the document
/// itself. `center_world` is the middle of the model, which a camera without a target looks at.
pub fn turned(document: &Document, turn: Turn, frame: u32, frames: u32, center_world: [f64; 3]) -> Document {
    let angle_deg = 360.0 * f64::from(frame) / f64::from(frames.max(1));
    turned_by(document, turn, angle_deg, center_world)
}

/// The same at an angle, anticlockwise seen from above.
pub fn turned_by(document: &Document, turn: Turn, angle_deg: f64, center_world: [f64; 3]) -> Document {
    let mut document = document.clone();
    match turn {
        Turn::Camera => {
            let pivot = document.camera.target.unwrap_or(center_world);
            turn_camera(&mut document, angle_deg, pivot);
        }
        Turn::Light => turn_light(&mut document, angle_deg),
        // All else the other way round: geometry need not be built again, and the ground looks the same all round.
        Turn::Model => {
            turn_camera(&mut document, -angle_deg, center_world);
            turn_light(&mut document, -angle_deg);
        }
    }
    document
}

/// Turns the camera about the vertical axis through a place.
fn turn_camera(document: &mut Document, angle_deg: f64, pivot: [f64; 3]) {
    let camera = &mut document.camera;
    camera.yaw_deg = wrapped_deg(camera.yaw_deg + angle_deg);
    if let Some(target) = &mut camera.target {
        *target = turned_about(*target, pivot, angle_deg);
    }
    if let Some(position) = &mut camera.position {
        *position = turned_about(*position, pivot, angle_deg);
    }
}

fn turn_light(document: &mut Document, angle_deg: f64) {
    let lighting = &mut document.lighting;
    lighting.rotation_deg = wrapped_deg(f64::from(lighting.rotation_deg) + angle_deg) as f32;
    for light in &mut lighting.area_lights {
        light.yaw_deg = wrapped_deg(light.yaw_deg + angle_deg);
        light.target = turned_about(light.target, [0.0; 3], angle_deg);
    }
}

/// A place turned about the vertical axis through another, anticlockwise seen from above.
fn turned_about(place: [f64; 3], center: [f64; 3], angle_deg: f64) -> [f64; 3] {
    let (sine, cosine) = angle_deg.to_radians().sin_cos();
    let (x, z) = (place[0] - center[0], place[2] - center[2]);
    [
        center[0] + cosine * x + sine * z,
        place[1],
        center[2] - sine * x + cosine * z,
    ]
}

/// In [−180, 180).
fn wrapped_deg(angle: f64) -> f64 {
    (angle + 180.0).rem_euclid(360.0) - 180.0
}
