//! What is being loaded, said in the viewport, where one looks.

use egui::{Color32, Rect, Ui, Vec2};

use super::LOADING_MARGIN;
use super::header::model_label;
use crate::app::desk::Desk;
use crate::render::worker::{Activity, Picture};

/// Width of what is said in the middle, points.
const WIDTH: f32 = 280.0;
const HEIGHT: f32 = 34.0;

/// Says what is being loaded while the image before it stays. An image of another model than the panels show is dimmed,
/// with what will come in the middle.
pub fn show(ui: &mut Ui, area: Rect, picture: &Picture, desk: &Desk<'_>) {
    let (shown, document) = (&picture.document, &*desk.document);
    let is_other = (&shown.model, &shown.import) != (&document.model, &document.import);
    let text = match &desk.snapshot.activity {
        Activity::Loading(what) => format!("Loading {what} …"),
        Activity::Starting => "Starting the engine …".to_owned(),
        // Before it is asked for, or where it can't be had.
        Activity::Done if is_other => format!("The image still shows {}", model_label(&shown.model)),
        _ if is_other => format!("Preparing {} …", model_label(&document.model)),
        _ => return,
    };
    let (place, layout) = if is_other {
        ui.painter().rect_filled(area, 0.0, Color32::from_black_alpha(150));
        let middle = Rect::from_center_size(area.center(), Vec2::new(WIDTH.min(area.width()), HEIGHT));
        (middle, egui::Layout::top_down(egui::Align::Center))
    } else {
        let corner = Rect::from_min_max(area.min + Vec2::splat(LOADING_MARGIN), area.max);
        (corner, egui::Layout::left_to_right(egui::Align::Min))
    };
    let builder = egui::UiBuilder::new()
        .scope_id(egui::Id::unique("loading"))
        .max_rect(place)
        .layout(layout);
    let mut inside = ui.new_child(builder);
    egui::Frame::popup(inside.style()).show(&mut inside, |ui| {
        ui.horizontal(|ui| {
            ui.add(egui::Spinner::new().size(14.0));
            ui.add(egui::Label::new(text).truncate())
        })
    });
}
