//! The selected material: every parameter of the registry, in its group, with the widget that suits its kind.

mod textures;

use egui::Ui;

use super::Panel;
use crate::app::actions::{Action, Command};
use crate::app::desk::Desk;
use crate::app::kit::icons::{self, Icon};
use crate::app::kit::widgets;
use crate::app::kit::{parameter_row, theme};
use crate::document::{Kind, MaterialSettings, PARAMETERS, Parameter};

/// The slots that are seen at once: more are scrolled to, so that the parameters stay in sight.
const SLOTS_SHOWN: f32 = 6.0;

/// The parameters of the selected material.
#[derive(Default)]
pub(super) struct MaterialPanel;

impl Panel for MaterialPanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        widgets::comes_and_goes(ui, |ui| slots(ui, desk));
        let before = desk.material();
        let mut material = before.clone();
        name(ui, desk, &mut material);
        ui.add_space(theme::GAP);
        let mut groups: Vec<&'static str> = Vec::new();
        // The switches of textures stand beside their images.
        let is_shown = |parameter: &&Parameter| !matches!(parameter.kind, Kind::Toggle) && (parameter.applies)(&before);
        for parameter in PARAMETERS.iter() {
            if !groups.contains(&parameter.group) {
                groups.push(parameter.group);
            }
        }
        for group in groups {
            let parameters = || PARAMETERS.iter().filter(|parameter| parameter.group == group);
            let mut rows = |ui: &mut Ui| {
                for parameter in parameters() {
                    widgets::comes_and_goes(ui, |ui| {
                        if is_shown(&parameter) {
                            show_parameter(ui, desk, parameter, &mut material);
                        }
                    });
                }
            };
            widgets::comes_and_goes(ui, |ui| {
                if parameters().any(|parameter| is_shown(&parameter)) {
                    widgets::group(ui, group, &mut rows);
                }
            });
        }
        widgets::group(ui, "Textures", |ui| textures::show(ui, desk, &mut material));
        if material != before {
            desk.set_material(material);
        }
    }
}

/// The model's slots, where there is a choice.
fn slots(ui: &mut Ui, desk: &mut Desk<'_>) {
    // Their number is not known while the model is being loaded.
    let Some(count) = desk.scene().map(|scene| scene.model.slots.len()) else {
        return;
    };
    if desk.shared.slot >= count.max(1) {
        desk.shared.slot = 0;
    }
    if count < 2 {
        return;
    }
    widgets::group(ui, "Slots", |ui| {
        let names: Vec<String> = desk
            .scene()
            .map(|scene| scene.model.slots.iter().map(|slot| slot.name.clone()).collect())
            .unwrap_or_default();
        let height = SLOTS_SHOWN * (theme::ROW_HEIGHT + ui.spacing().item_spacing.y);
        egui::ScrollArea::vertical().max_height(height).show(ui, |ui| {
            for (slot, name) in names.iter().enumerate() {
                slot_entry(ui, desk, slot, name);
            }
        });
    });
}

fn slot_entry(ui: &mut Ui, desk: &mut Desk<'_>, slot: usize, name: &str) {
    let label = if name.is_empty() {
        format!("slot {}", slot + 1)
    } else {
        name.to_owned()
    };
    let is_selected = slot == desk.shared.slot;
    let size = egui::vec2(ui.available_width(), theme::ROW_HEIGHT);
    let button = egui::Button::selectable(is_selected, label.as_str()).truncate();
    let item = ui.add_sized(size, button.min_size(size));
    // Where a click in the viewport selected it.
    let shown = egui::Id::unique("slot in sight");
    if is_selected && ui.memory(|memory| memory.data.get_temp::<usize>(shown)) != Some(slot) {
        item.scroll_to_me(None);
        ui.memory_mut(|memory| memory.data.insert_temp(shown, slot));
    }
    if item.on_hover_text(label).clicked() {
        desk.actions.push(Action::SelectSlot(slot));
    }
}

fn name(ui: &mut Ui, desk: &mut Desk<'_>, material: &mut MaterialSettings) {
    ui.horizontal(|ui| {
        let width = ui.available_width() - theme::ROW_HEIGHT - ui.spacing().item_spacing.x;
        let field = egui::TextEdit::singleline(&mut material.name)
            .desired_width(width)
            .margin(egui::vec2(6.0, 3.0));
        if ui.add(field).accessible_name("Material name").changed() {
            desk.edits.note("Rename material", "material name");
        }
        let more = icons::button(ui, Icon::More, "Material menu", "Open, save, reset");
        egui::Popup::menu(&more).show(|ui| {
            for command in [Command::OpenMaterial, Command::SaveMaterial, Command::ResetMaterial] {
                if ui.button(command.label()).on_hover_text(command.help()).clicked() {
                    desk.act(command);
                }
            }
        });
    });
}

/// The row of a parameter.
fn show_parameter(ui: &mut Ui, desk: &mut Desk<'_>, parameter: &Parameter, material: &mut MaterialSettings) {
    let mut value = parameter.get(material);
    let idle = (parameter.idle)(material);
    let row = ui.add_enabled_ui(idle.is_none(), |ui| {
        parameter_row::show(ui, parameter, &mut value, |_| {})
    });
    if let Some(why) = idle {
        row.response.on_hover_text(why);
    }
    let is_other = row.inner;
    if is_other && parameter.set(material, value).is_ok() {
        let key = format!("{}/{}", desk.shared.slot, parameter.key);
        desk.edits.note(parameter.full_name(), key);
    }
}
