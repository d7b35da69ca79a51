//! Camera, view and render settings.

mod photographic;
mod reference;

use super::*;
use crate::{
    desk::PICTURE_SIZE,
    document::{Bookmark, range},
    services::viewing::{Pick, Resolution},
};

/// Camera, view and render settings.
#[derive(Default)]
pub struct CameraPanel {
    sensor_mm: Option<f64>,
}

impl Panel for CameraPanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk) {
        widgets::group(ui, "Camera", |ui| camera(ui, desk));
        widgets::group(ui, "Lens", |ui| photographic::show(ui, desk, &mut self.sensor_mm));
        widgets::group(ui, "Bookmarks", |ui| bookmarks(ui, desk));
        widgets::group(ui, "View", |ui| view(ui, desk));
        widgets::group(ui, "Image", |ui| picture(ui, desk));
        widgets::group(ui, "Stop when", |ui| desk.settings(ui, "Stop when"));
        widgets::group(ui, "Sampling", |ui| desk.settings(ui, "Sampling"));
    }
}

/// How radiance becomes an image, and the table of colours that it goes through last.
fn view(ui: &mut Ui, desk: &mut Desk) {
    desk.settings(ui, "View");
    let help = "A look-up table of colours (.cube), applied last. Linear images (.exr, .hdr) stay as they are.";
    let file = desk.document.view.lut.clone();
    let name = ["Table of colours", "LUT", help];
    let remove = ("Remove the table of colours", "Shows the image without it");
    if desk.file_row(ui, name, file.as_deref(), Action::ChooseLut, remove) {
        desk.document.view.lut = None;
        desk.edits.did(remove.0);
    }
    widgets::comes_and_goes(ui, |ui| reference::show(ui, desk));
}

fn camera(ui: &mut Ui, desk: &mut Desk) {
    desk.settings(ui, "Camera");
    let is_open = desk.document.camera.aperture > 0.0;
    desk.shared
        .viewing
        .picks
        .take_if(|pick| !is_open && *pick == Pick::Focus);
    ui.add_enabled_ui(is_open, |ui| focus(ui, desk));
    ui.horizontal_wrapped(|ui| {
        desk.button(ui, Command::FrameAll);
        for (label, yaw_deg, pitch_deg) in [("Front", 0.0, 0.0), ("Side", 90.0, 0.0), ("Top", 0.0, 90.0)] {
            if ui.button(label).clicked() {
                desk.actions.push(Action::LookFrom(yaw_deg, pitch_deg));
            }
        }
        desk.button(ui, Command::FrameSelected);
    });
}

/// The focus distance: until it is given, that of the target, which only the scene knows.
fn focus(ui: &mut Ui, desk: &mut Desk) {
    let at_target = desk.scene().map_or(1.0, |scene| {
        let camera = scene.job.settings.camera;
        (camera.focus_distance - camera.parallel_from) * scene.job.geometry.world_units_per_unit
    });
    let style = NumberStyle::plain(range::DISTANCE, "", 0.005 * at_target, 4);
    let name = [
        "Focus distance",
        "Focus",
        "How far away things are sharp, in the model's units; at first at the camera's target. In the viewport: \
         click with ctrl.",
    ];
    desk.row(
        ui,
        name,
        |document| &mut document.camera.focus_distance,
        |ui, distance| widgets::number_following(ui, distance, at_target, &style),
    );
    let help = "The next click in the viewport says what is sharp.";
    desk.pick_toggle(ui, Pick::Focus, "Pick focus", help);
}

fn bookmarks(ui: &mut Ui, desk: &mut Desk) {
    let mut bookmarks = desk.document.bookmarks.clone();
    let mut removed = None;
    for (index, bookmark) in bookmarks.iter_mut().enumerate() {
        ui.horizontal(|ui| {
            let is_here = bookmark.camera == desk.document.camera;
            let name = format!("Camera bookmark {}", index + 1);
            let apply = ui.selectable_label(is_here, "Apply");
            if apply.on_hover_text("Looks from there.").clicked() {
                desk.actions.push(Action::UseBookmark(index));
            }
            // From the right, so that the name has what the buttons leave and none is pushed out of the panel.
            widgets::at_right(ui, |ui| {
                let remove = format!("Remove {}", name.to_lowercase());
                if icons::button(ui, Icon::Close, &remove, "Remove this bookmark").clicked() {
                    removed = Some(index);
                    desk.edits.did("Remove bookmark");
                }
                if widgets::pressed(ui, "Update", "Replaces it by the present camera.") {
                    bookmark.camera = desk.document.camera;
                    desk.edits.did("Update bookmark");
                }
                if widgets::wide_field(ui, &mut bookmark.name, &name).changed() {
                    desk.edits.note("Rename bookmark", name);
                }
            });
        });
    }
    if let Some(index) = removed {
        bookmarks.remove(index);
    }
    if widgets::pressed(ui, "Add bookmark", "Remembers the camera with the project.") {
        bookmarks.push(Bookmark {
            name: format!("View {}", bookmarks.len() + 1),
            camera: desk.document.camera,
        });
        desk.edits.did("Add bookmark");
    }
    desk.document.bookmarks = bookmarks;
}

/// What the viewport renders and what is saved.
fn picture(ui: &mut Ui, desk: &mut Desk) {
    let name = ["Image size", "Size", "What the viewport renders, and what is saved."];
    widgets::choice_row(ui, name, &mut desk.shared.viewing.resolution);
    widgets::comes_and_goes(ui, |ui| {
        if desk.shared.viewing.resolution == Resolution::Document {
            desk.settings(ui, PICTURE_SIZE);
            photographic::aspect(ui, desk);
        }
    });
}
