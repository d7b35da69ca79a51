//! The materials of the model's slots: chosen, several at once, renamed, copied, replaced by what is dropped on them.

use egui::{Color32, Sense, Ui, vec2};

use super::{Renamed, ScenePanel, light_up, line};
use crate::app::actions::{Action, Command};
use crate::app::desk::Desk;
use crate::app::kit::{theme, widgets};
use crate::app::services::selection::Thing;
use crate::document::MaterialSettings;

/// Side of the square with a material's colour, points.
const SWATCH: f32 = 14.0;

pub fn show(ui: &mut Ui, desk: &mut Desk<'_>, panel: &mut ScenePanel) {
    let Some(count) = desk.scene().map(|scene| scene.model.slots.len()) else {
        return;
    };
    widgets::group(ui, "Materials", |ui| {
        for slot in 0..count {
            let material = desk.document.material(slot);
            if panel.is_wanted(&material.name) {
                ui.push_id(("material", slot), |ui| entry(ui, desk, panel, slot, &material));
            }
        }
        let chosen = desk.shared.selection.slots().len();
        if chosen > 1 {
            widgets::note(ui, format!("{chosen} materials are edited together."));
        }
    });
}

fn entry(ui: &mut Ui, desk: &mut Desk<'_>, panel: &mut ScenePanel, slot: usize, material: &MaterialSettings) {
    let what = Renamed::Thing(Thing::Slot(slot));
    let (renamed, is_renaming) = panel.new_name(ui, &what);
    if let Some(renamed) = renamed {
        desk.document.material_mut(slot).name = renamed;
        desk.edits.note("Rename material", "");
    }
    if is_renaming {
        return;
    }
    ui.horizontal(|ui| {
        let (square, _) = ui.allocate_exact_size(vec2(SWATCH, theme::ROW_HEIGHT), Sense::hover());
        let square = egui::Rect::from_center_size(square.center(), vec2(SWATCH, SWATCH));
        let [r, g, b] = widgets::srgb_of(material.base_color);
        let stroke = ui.visuals().widgets.noninteractive.bg_stroke;
        ui.painter().rect(
            square,
            3.0,
            Color32::from_rgb(r, g, b),
            stroke,
            egui::StrokeKind::Inside,
        );
        let is_chosen = desk.shared.selection.slots().contains(&slot);
        let shown = line(ui, "Material", &material.name, is_chosen, false);
        light_up(ui, desk, &shown, Thing::Slot(slot));
        if shown.clicked() {
            if ui.input(|input| input.modifiers.command || input.modifiers.shift) && slot != desk.shared.selection.slot
            {
                desk.shared.selection.choose_also(slot);
            } else {
                desk.shared.selection.objects.clear();
                desk.actions.push(Action::SelectSlot(slot));
            }
        }
        shown.dnd_set_drag_payload(material.clone());
        if let Some(dropped) = shown.dnd_release_payload::<MaterialSettings>() {
            desk.actions.push(Action::SelectSlot(slot));
            desk.actions
                .push(Action::UseMaterial(Box::new(MaterialSettings::clone(&dropped))));
        }
        shown.context_menu(|ui| {
            if ui.button("Rename").clicked() {
                panel.rename(what, &material.name);
                ui.close();
            }
            for command in [Command::CopyMaterial, Command::PasteMaterial, Command::FrameSelected] {
                let is_possible = command != Command::PasteMaterial || desk.shared.selection.copied.is_some();
                let button = ui.add_enabled(is_possible, egui::Button::new(command.label()));
                if button.on_hover_text(command.help()).clicked() {
                    desk.shared.selection.objects.clear();
                    desk.actions.push(Action::SelectSlot(slot));
                    desk.act(command);
                    ui.close();
                }
            }
        });
    });
}
