//! The camera in a photographer's terms, beside the values that are kept: focal length on a sensor, f-number, aspect.

use super::*;
use crate::{document::CameraSettings, render::worker::Scene};

/// Sensors by their height in millimetres.
const SENSORS: [(f64, &str, &str); 5] = [
    (24.0, "Full frame", "36 × 24 mm"),
    (15.6, "APS-C", "23.5 × 15.6 mm"),
    (18.66, "Super 35", "24.89 × 18.66 mm"),
    (13.0, "Four Thirds", "17.3 × 13 mm"),
    (33.0, "Medium format", "44 × 33 mm"),
];
/// Millimetres in a metre.
const MM_PER_M: f64 = 1000.0;
/// Width to height of the images to choose from.
const ASPECTS: [([u32; 2], &str); 7] = [
    ([1, 1], "1 : 1"),
    ([4, 3], "4 : 3"),
    ([3, 2], "3 : 2"),
    ([16, 9], "16 : 9"),
    ([239, 100], "2.39 : 1"),
    ([4, 5], "4 : 5"),
    ([9, 16], "9 : 16"),
];

/// `sensor_mm` is the height of the sensor that focal lengths refer to.
pub fn show(ui: &mut Ui, desk: &mut Desk, sensor_mm: &mut Option<f64>) {
    let first = SENSORS[0].0;
    let height_mm = sensor_mm.get_or_insert(first);
    let name = [
        "Sensor",
        "Sensor",
        "Sensor size for focal length only; doesn't change the image.",
    ];
    widgets::value_row(ui, name, height_mm, first, |ui, height_mm| {
        widgets::choice(ui, "sensor", height_mm, &SENSORS)
    });
    let height_mm = *height_mm;
    let focal_mm = |fov_deg: f64| 0.5 * height_mm / (0.5 * fov_deg).to_radians().tan();
    let fov_deg = |focal_mm: f64| 2.0 * (0.5 * height_mm / focal_mm).atan().to_degrees();
    let range = focal_mm(*range::FOV_DEG.end())..=focal_mm(*range::FOV_DEG.start());
    let present_mm = focal_mm(desk.document.camera.fov_deg);
    let style = NumberStyle::plain(range, " mm", 0.005 * present_mm, 1);
    let help = "The field of view as a lens on the sensor has it.";
    let name = ["Focal length", "Focal length", help];
    desk.row(
        ui,
        name,
        |document| &mut document.camera.fov_deg,
        |ui, fov| widgets::number_as(ui, fov, &style, focal_mm, fov_deg),
    );
    widgets::comes_and_goes(ui, |ui| f_number(ui, desk, focal_mm(desk.document.camera.fov_deg)));
    let frames = ui.checkbox(&mut desk.shared.viewing.shows_safe_frames, "Safe frames");
    frames.on_hover_text(
        "Marks what every screen shows: actions within 93 %, titles within 90 % of the image (EBU R 95).",
    );
}

/// Known once the model is, which says how large a bounding radius is.
fn f_number(ui: &mut Ui, desk: &mut Desk, focal_mm: f64) {
    let Some(scene) = desk.scene() else { return };
    let mm_per_radius = scene.job.geometry.world_units_per_unit * MM_PER_M * desk.document.unit_m;
    // Either way.
    let exchanged = |x: f64| match x > 0.0 {
        true => focal_mm / (2.0 * mm_per_radius * x),
        false => 0.0,
    };
    let speed = 0.01 * exchanged(desk.document.camera.aperture).max(1.0);
    let style = NumberStyle {
        zero: Some("pinhole"),
        // Without limits: a number beyond one would be clamped at once, an edit that the user did not make and that
        // would get in the way of undo.
        ..NumberStyle::plain(0.0..=f64::MAX, "", speed, 4)
    };
    let help = "Focal length over the lens's diameter, where a unit of the scene is as large as Light › Scene unit says: the smaller, the less is sharp. \
                0 is a pinhole, with which everything is sharp.";
    let blur = blur_px(&desk.document.camera, scene);
    desk.row(
        ui,
        ["f-number", "f-number", help],
        |document| &mut document.camera.aperture,
        |ui, aperture| {
            let of_number = |number| exchanged(number).min(*range::APERTURE.end());
            widgets::number_as(ui, aperture, &style, exchanged, of_number)
        },
    );
    widgets::comes_and_goes(ui, |ui| {
        if (f64::MIN_POSITIVE..1.0).contains(&blur) {
            let text = format!(
                "Nothing blurs: the model is {:.2} m across. Choose a smaller f-number, or a smaller unit in Light › Scene unit.",
                0.002 * mm_per_radius
            );
            widgets::note(ui, text);
        }
    });
}

/// How wide a point far behind what is sharp becomes in the image, pixels.
fn blur_px(camera: &CameraSettings, scene: &Scene) -> f64 {
    let (settings, height) = (&scene.job.settings.camera, f64::from(scene.document.render.height));
    let distance = (settings.focus_distance - settings.parallel_from).max(1e-9);
    camera.aperture / (0.5 * camera.fov_deg).to_radians().tan() / distance * height
}

/// The image's width to height, where its size is the document's: a choice changes the height.
pub fn aspect(ui: &mut Ui, desk: &mut Desk) {
    let width = desk.document.render.width;
    let height = |[across, down]: [u32; 2]| {
        let height = f64::from(width) * f64::from(down) / f64::from(across);
        height.round().clamp(*range::SIZE.start(), *range::SIZE.end()) as u32
    };
    let choices = ASPECTS.map(|(aspect, label)| (height(aspect), label, ""));
    desk.row(
        ui,
        ["Aspect", "Aspect", "Width to height: changes the height."],
        |document| &mut document.render.height,
        |ui, height| widgets::choice(ui, "aspect", height, &choices),
    );
}
