//! Pinned states as thumbnails: to bring back, to compare with, to remove.

use egui::{Rect, Sense, Ui, vec2};

use super::Panel;
use crate::app::actions::{Action, Command};
use crate::app::desk::Desk;
use crate::app::kit::{theme, widgets};
use crate::app::services::compare::Rival;
use crate::app::services::library::Change;

/// Width and height of an image's place, points.
const PLACE: egui::Vec2 = vec2(112.0, 74.0);

/// The pinned states.
#[derive(Default)]
pub struct SnapshotsPanel;

impl Panel for SnapshotsPanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        ui.horizontal_wrapped(|ui| {
            desk.button(ui, Command::Pin);
            let removed = desk.shared.snapshots.removed.as_ref();
            let name = removed.and_then(|removed| removed.path().file_stem());
            if let Some(name) = name
                && ui.button(format!("Restore {}", name.to_string_lossy())).clicked()
            {
                desk.actions.push(Action::ChangeSnapshots(Change::Restore));
            }
        });
        ui.add_space(theme::GAP);
        renaming(ui, desk);
        if desk.shared.snapshots.pinned.is_empty() {
            widgets::note(
                ui,
                "P pins material, light and camera as they are, to come back to and to compare with.",
            );
            return;
        }
        ui.horizontal_wrapped(|ui| {
            for index in 0..desk.shared.snapshots.pinned.len() {
                entry(ui, desk, index);
            }
        });
    }
}

/// The field for the new name of the one that is being renamed.
fn renaming(ui: &mut Ui, desk: &mut Desk<'_>) {
    let Some((path, name)) = &mut desk.shared.snapshots.renaming else {
        return;
    };
    let chosen = widgets::name_field(ui, name);
    ui.add_space(theme::GAP);
    if let Some(chosen) = chosen {
        let rename = |name| Action::ChangeSnapshots(Change::Rename(path.clone(), name));
        desk.actions.extend(chosen.map(rename));
        desk.shared.snapshots.renaming = None;
    }
}

fn entry(ui: &mut Ui, desk: &mut Desk<'_>, index: usize) {
    let pinned = &desk.shared.snapshots.pinned[index];
    let (name, path) = (pinned.name.clone(), pinned.path.clone());
    let materials = pinned.document.materials.clone();
    let size = pinned.size.map(|side| side as f32);
    let is_current = pinned.document.materials == desk.document.materials
        && pinned.document.camera == desk.document.camera
        && pinned.document.lighting == desk.document.lighting;
    let (_, rect) = ui.allocate_space(PLACE + vec2(0.0, theme::ROW_HEIGHT));
    // By its file, as others may come before it.
    let id = egui::Id::unique(("snapshot", &path));
    let response = ui.interact(rect, id, Sense::click());
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_current, &name));
    let visuals = ui.style().interact_selectable(&response, is_current);
    if is_current || response.hovered() || response.has_focus() {
        ui.painter()
            .rect_filled(rect, visuals.corner_radius, visuals.weak_bg_fill);
    }
    let place = Rect::from_min_size(rect.min, PLACE).shrink(4.0);
    // The middle of the image fills the place.
    let scale = (place.width() / size[0]).max(place.height() / size[1]);
    let share = place.size() / (scale * vec2(size[0], size[1]));
    let middle = Rect::from_center_size(egui::pos2(0.5, 0.5), share);
    let ctx = ui.ctx().clone();
    if let Some(picture) = desk.shared.snapshots.picture(&ctx, index) {
        egui::Image::new(picture)
            .uv(middle)
            .corner_radius(3.0)
            .paint_at(ui, place);
    }
    let font = egui::TextStyle::Small.resolve(ui.style());
    let mut job = egui::text::LayoutJob::simple_singleline(name.clone(), font, visuals.text_color());
    job.wrap = egui::text::TextWrapping::truncate_at_width(PLACE.x - 8.0);
    let galley = ui.painter().layout_job(job);
    let below = egui::pos2(rect.center().x - 0.5 * galley.size().x, place.bottom() + 5.0);
    ui.painter().galley(below, galley, visuals.text_color());
    let mut is_renaming = false;
    let mut more = |ui: &mut Ui| {
        if ui.button("Bring back").clicked() {
            desk.actions.push(Action::UseSnapshot(path.clone()));
        }
        if ui.button("Compare as B").clicked() {
            let rival = Rival::Materials(name.clone(), materials.clone());
            desk.actions.push(Action::CompareWith(rival));
        }
        is_renaming |= ui.button("Rename").clicked();
        if ui.button("Delete").clicked() {
            desk.actions.push(Action::ChangeSnapshots(Change::Remove(path.clone())));
        }
    };
    response.context_menu(&mut more);
    let corner = Rect::from_min_size(rect.right_top() + vec2(-28.0, 6.0), vec2(22.0, 18.0));
    let mut inside = ui.new_child(egui::UiBuilder::new().max_rect(corner).scope_id(id.with("more")));
    inside.spacing_mut().interact_size = corner.size();
    inside.spacing_mut().button_padding = vec2(5.0, 0.0);
    let button = inside.menu_button("…", &mut more).response;
    button.accessible_name(format!("More of {name}"));
    let help = "Click to bring it back; right-click for more";
    if response.on_hover_text(help).clicked() {
        desk.actions.push(Action::UseSnapshot(path.clone()));
    }
    if is_renaming {
        desk.shared.snapshots.renaming = Some((path, name));
    }
}
