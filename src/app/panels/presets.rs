//! Materials to start from.

use egui::{Sense, Ui, vec2};

use super::Desk;
use crate::app::actions::Action;
use crate::app::{theme, widgets};
use crate::document::{MaterialSettings, PRESETS};

pub(in crate::app) fn show(ui: &mut Ui, desk: &mut Desk<'_>) {
    let search = egui::TextEdit::singleline(&mut desk.state.preset_search)
        .hint_text("Search")
        .desired_width(f32::INFINITY)
        .margin(vec2(6.0, 4.0));
    ui.add(search).accessible_name("Search presets");
    ui.add_space(0.5 * theme::GAP);
    let wanted = desk.state.preset_search.to_lowercase();
    let current = desk.material();
    let mut found = false;
    for material in PRESETS
        .iter()
        .filter(|material| material.name.to_lowercase().contains(&wanted))
    {
        found = true;
        if entry(ui, material, *material == current) {
            desk.actions.push(Action::UseMaterial(Box::new(material.clone())));
        }
    }
    if !found {
        widgets::note(ui, "No preset of that name.");
    }
}

/// A preset: what it looks like in one colour, and its name.
fn entry(ui: &mut Ui, material: &MaterialSettings, is_current: bool) -> bool {
    let size = vec2(ui.available_width(), theme::ROW_HEIGHT + 2.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_current, &material.name));
    let visuals = ui.style().interact_selectable(&response, is_current);
    if is_current || response.hovered() || response.has_focus() {
        ui.painter()
            .rect_filled(rect, visuals.corner_radius, visuals.weak_bg_fill);
    }
    let [r, g, b] = widgets::srgb_of(material.base_color);
    let center = rect.left_center() + vec2(14.0, 0.0);
    let radius = 7.0;
    ui.painter()
        .circle_filled(center, radius, egui::Color32::from_rgb(r, g, b));
    let font = egui::TextStyle::Body.resolve(ui.style());
    let at = rect.left_center() + vec2(30.0, 0.0);
    ui.painter().text(
        at,
        egui::Align2::LEFT_CENTER,
        &material.name,
        font,
        visuals.text_color(),
    );
    response.clicked()
}
