//! The camera in a photographer's terms, beside the values that are kept: focal length on a sensor, f-number, aspect.

use egui::Ui;

use crate::app::desk::Desk;
use crate::app::kit::widgets::{self, Name, NumberStyle};
use crate::document::range;

/// Sensors by their height in millimetres.
const SENSORS: [(f64, &str, &str); 5] = [
    (24.0, "Full frame", "36 × 24 mm"),
    (15.6, "APS-C", "23.5 × 15.6 mm"),
    (18.66, "Super 35", "24.89 × 18.66 mm"),
    (13.0, "Four Thirds", "17.3 × 13 mm"),
    (33.0, "Medium format", "44 × 33 mm"),
];
/// Millimetres in a unit of the scene, which glTF says is a metre.
const MM_PER_UNIT: f64 = 1000.0;
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

/// The sensor that focal lengths refer to.
pub struct Photographic {
    sensor_height_mm: f64,
}

impl Default for Photographic {
    fn default() -> Self {
        Self {
            sensor_height_mm: SENSORS[0].0,
        }
    }
}

impl Photographic {
    pub fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        let name = Name::new(
            "Sensor",
            "Sensor",
            "Sensor size for focal length only; doesn't change the image.",
        );
        let chosen = widgets::row(ui, name, |ui| {
            widgets::choice(ui, "sensor", &mut self.sensor_height_mm, &SENSORS)
        });
        if chosen.reset {
            self.sensor_height_mm = SENSORS[0].0;
        }
        self.focal_length(ui, desk);
        widgets::comes_and_goes(ui, |ui| self.f_number(ui, desk));
        let frames = ui.checkbox(&mut desk.shared.viewing.shows_safe_frames, "Safe frames");
        frames.on_hover_text(
            "Marks what every screen shows: actions within 93 %, titles within 90 % of the image (EBU R 95).",
        );
    }

    fn focal_length(&self, ui: &mut Ui, desk: &mut Desk<'_>) {
        let of = |fov_deg: f64| focal_length_mm(fov_deg, self.sensor_height_mm);
        let mut focal_mm = of(desk.document.camera.fov_deg);
        let style = NumberStyle::plain(
            of(*range::FOV_DEG.end())..=of(*range::FOV_DEG.start()),
            " mm",
            0.005 * focal_mm,
            1,
        );
        let name = Name::new(
            "Focal length",
            "Focal length",
            "The field of view as a lens on the sensor has it.",
        );
        let response = widgets::row(ui, name, |ui| widgets::number(ui, &mut focal_mm, &style));
        if response.changed {
            desk.document.camera.fov_deg = fov_deg(focal_mm, self.sensor_height_mm);
        }
        desk.edited(response, "Focal length", |document| &mut document.camera.fov_deg);
    }

    /// Known once the model is, which says how large a bounding radius is.
    fn f_number(&self, ui: &mut Ui, desk: &mut Desk<'_>) {
        let Some(scene) = desk.scene() else { return };
        let mm_per_radius = scene.job.geometry.world_units_per_unit * MM_PER_UNIT;
        let focal_mm = focal_length_mm(desk.document.camera.fov_deg, self.sensor_height_mm);
        let exchanged = |x: f64| {
            if x > 0.0 {
                focal_mm / (2.0 * mm_per_radius * x)
            } else {
                0.0
            }
        };
        let mut number = exchanged(desk.document.camera.aperture);
        let style = NumberStyle {
            // Without limits: a number beyond one would be clamped at once, an edit that the user did not make and that
            // would get in the way of undo.
            range: 0.0..=f64::MAX,
            bar: None,
            unit: "",
            speed: 0.01 * number.max(1.0),
            decimals: 4,
        };
        let help = "Focal length over the lens's diameter, where a unit of the scene is a metre: the smaller, the less is sharp. \
                    0 is a pinhole, with which everything is sharp.";
        let name = Name::new("f-number", "f-number", help);
        let response = widgets::row(ui, name, |ui| {
            widgets::number_or(ui, &mut number, &style, Some("pinhole"))
        });
        if response.changed {
            desk.document.camera.aperture = exchanged(number).min(*range::APERTURE.end());
        }
        desk.edited(response, "f-number", |document| &mut document.camera.aperture);
    }
}

/// The focal length of a lens with this vertical field of view on a sensor.
fn focal_length_mm(fov_deg: f64, sensor_height_mm: f64) -> f64 {
    0.5 * sensor_height_mm / (0.5 * fov_deg).to_radians().tan()
}

fn fov_deg(focal_length_mm: f64, sensor_height_mm: f64) -> f64 {
    2.0 * (0.5 * sensor_height_mm / focal_length_mm).atan().to_degrees()
}

/// The image's width to height, where its size is the document's: a choice changes the height.
pub fn aspect(ui: &mut Ui, desk: &mut Desk<'_>) {
    let render = &desk.document.render;
    let height = |[across, down]: [u32; 2]| {
        let height = f64::from(render.width) * f64::from(down) / f64::from(across);
        height.round().clamp(*range::SIZE.start(), *range::SIZE.end()) as u32
    };
    let current = ASPECTS.iter().find(|(aspect, _)| height(*aspect) == render.height);
    let mut chosen = current.map(|(aspect, _)| *aspect);
    let choices: Vec<_> = ASPECTS
        .iter()
        .map(|(aspect, label)| (Some(*aspect), *label, ""))
        .collect();
    let name = Name::new("Aspect", "Aspect", "Width to height: changes the height.");
    let response = widgets::row(ui, name, |ui| widgets::choice(ui, "aspect", &mut chosen, &choices));
    if let Some(aspect) = chosen.filter(|_| response.changed) {
        desk.document.render.height = height(aspect);
    }
    desk.edited(response, "Aspect", |document| &mut document.render.height);
}
