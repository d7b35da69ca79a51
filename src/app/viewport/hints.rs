//! Hints for new users, shown one after the other until they are closed.

use egui::{Rect, Ui, pos2, vec2};

use super::LOADING_MARGIN;
use crate::app::desk::Desk;

/// The hints, in order.
const HINTS: [&str; 5] = [
    "Drag to orbit, scroll to zoom, Shift+drag to rotate the light.",
    "Click a preset to apply it; drag it onto a part to change only that part.",
    "Ctrl+K finds commands, presets, environments and parameters. F1 opens the manual; Help › Examples has scenes.",
    "C: compare with what you had before the last change. Press it again to go on.",
    "Ctrl+E: save the image. A .png holds the whole project and opens again.",
];
/// Width of the hint, points.
const WIDTH: f32 = 380.0;
const HEIGHT: f32 = 64.0;

/// Largest width of what stands in the viewport's lower left corner, points: the offer of the denoiser.
const CORNER: f32 = 270.0;

/// How far what stands in the lower left corner is raised, so that no hint lies over it.
pub(super) fn raised(area: Rect, desk: &Desk<'_>) -> f32 {
    let is_shown = desk.shared.offers.hints_seen < HINTS.len();
    let is_narrow = area.width() < WIDTH + 2.0 * (CORNER + LOADING_MARGIN);
    if is_shown && is_narrow {
        HEIGHT + LOADING_MARGIN
    } else {
        0.0
    }
}

/// Shows the hint that is next over the lower edge of the image.
pub(super) fn show(ui: &mut Ui, area: Rect, desk: &mut Desk<'_>) {
    let number = desk.shared.offers.hints_seen;
    let Some(hint) = HINTS.get(number) else { return };
    let size = vec2(WIDTH.min(area.width() - 2.0 * LOADING_MARGIN), HEIGHT);
    let at = pos2(area.center().x - 0.5 * size.x, area.bottom() - LOADING_MARGIN - size.y);
    let builder = egui::UiBuilder::new()
        .scope_id(egui::Id::unique("hint"))
        .max_rect(Rect::from_min_size(at, size))
        .layout(egui::Layout::top_down(egui::Align::Min));
    let mut inside = ui.new_child(builder);
    egui::Frame::popup(inside.style()).show(&mut inside, |ui| {
        ui.set_width(size.x - 16.0);
        ui.add(egui::Label::new(*hint).wrap());
        ui.horizontal(|ui| {
            if number + 1 < HINTS.len() && ui.button("Next hint").clicked() {
                desk.shared.offers.hints_seen += 1;
            }
            if ui.button("No more hints").clicked() {
                desk.shared.offers.hints_seen = HINTS.len();
            }
            ui.weak(format!("{} of {}", number + 1, HINTS.len()));
        });
    });
}
