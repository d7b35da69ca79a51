//! The materials of the model's slots: chosen, several at once, renamed, copied, replaced by what is dropped on them.

use super::*;
use crate::document::MaterialSettings;

pub fn show(ui: &mut Ui, desk: &mut Desk, panel: &mut ScenePanel) {
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

fn entry(ui: &mut Ui, desk: &mut Desk, panel: &mut ScenePanel, slot: usize, material: &MaterialSettings) {
    let what = Renamed::Thing(Thing::Slot(slot));
    if let Some(renamed) = panel.new_name(ui, &what) {
        if let Some(renamed) = renamed {
            desk.document.material_mut(slot).name = renamed;
            desk.edits.note("Rename material", "");
        }
        return;
    }
    ui.horizontal(|ui| {
        widgets::swatch(ui, Vec2::splat(14.0), widgets::shown(material.base_color));
        let is_chosen = desk.shared.selection.slots().contains(&slot);
        let shown = line(ui, "Material", &material.name, is_chosen, false);
        light_up(ui, desk, &shown, Thing::Slot(slot));
        if shown.clicked() {
            if is_beside_others(ui) && slot != desk.shared.selection.slot {
                desk.shared.selection.choose_also(slot);
            } else {
                desk.shared.selection.objects.clear();
                desk.actions.push(Action::SelectSlot(slot));
            }
        }
        shown.dnd_set_drag_payload(material.clone());
        if let Some(dropped) = shown.dnd_release_payload() {
            desk.drop_on(slot, &dropped);
        }
        shown.context_menu(|ui| {
            if widgets::entry(ui, "Rename", "") {
                panel.rename(what, &material.name);
            }
            for command in [Command::CopyMaterial, Command::PasteMaterial, Command::FrameSelected] {
                let is_possible = command != Command::PasteMaterial || desk.shared.selection.copied.is_some();
                if widgets::pressed_if(ui, is_possible, command.label(), command.help(), "") {
                    desk.shared.selection.objects.clear();
                    desk.actions.push(Action::SelectSlot(slot));
                    desk.act(command);
                    ui.close();
                }
            }
        });
    });
}
