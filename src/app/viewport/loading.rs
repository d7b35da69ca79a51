//! What is being loaded, said in the viewport, where one looks.

use super::header::model_label;
use super::*;
use crate::render::worker::Activity;

/// Says what is being loaded while the image before it stays. An image of another model than the panels show is dimmed,
/// with what will come in the middle.
pub fn show(ui: &mut Ui, area: Rect, picture: &Picture, desk: &Desk) {
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
    let mut place = Rect::from_min_max(area.min + Vec2::splat(LOADING_MARGIN), area.max);
    let mut layout = Layout::left_to_right(Align::Min);
    if is_other {
        ui.painter().rect_filled(area, 0.0, Color32::from_black_alpha(150));
        place = Rect::from_center_size(area.center(), Vec2::new(280.0_f32.min(area.width()), 34.0));
        layout = Layout::top_down(Align::Center);
    }
    let mut inside = laid_over(ui, "loading", place, layout);
    Frame::popup(inside.style()).show(&mut inside, |ui| {
        ui.horizontal(|ui| {
            ui.add(Spinner::new().size(14.0));
            widgets::line(ui, text)
        })
    });
}
