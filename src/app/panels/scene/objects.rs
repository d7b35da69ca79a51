//! The objects of the model, and the ground: shown or hidden, chosen, renamed.

use egui::Ui;

use super::{Renamed, ScenePanel, light_up, line};
use crate::app::actions::{Action, Command};
use crate::app::desk::Desk;
use crate::app::kit::icons::{self, Icon};
use crate::app::kit::{theme, widgets};
use crate::app::services::selection::Thing;

/// The lines that are seen at once: more are scrolled to.
const SHOWN: f32 = 12.0;

pub fn show(ui: &mut Ui, desk: &mut Desk<'_>, panel: &mut ScenePanel) {
    let Some(count) = desk.scene().map(|scene| scene.model.objects.len()) else {
        return;
    };
    let height = SHOWN * (theme::ROW_HEIGHT + ui.spacing().item_spacing.y);
    widgets::group(ui, "Objects", |ui| {
        egui::ScrollArea::vertical()
            .max_height(height)
            .id_salt("objects")
            .show(ui, |ui| {
                for number in 0..count {
                    let name = desk.object_name(number).unwrap_or_default();
                    if panel.is_wanted(&name) {
                        ui.push_id(("object", number), |ui| object(ui, desk, panel, number, &name, count));
                    }
                }
                if panel.is_wanted("Ground") {
                    ui.push_id("ground", |ui| ground(ui, desk));
                }
            });
    });
}

fn object(ui: &mut Ui, desk: &mut Desk<'_>, panel: &mut ScenePanel, number: usize, name: &str, count: usize) {
    let what = Renamed::Thing(Thing::Object(number));
    let (renamed, is_renaming) = panel.new_name(ui, &what);
    if let Some(renamed) = renamed {
        desk.document.object_names.insert(number, renamed);
        desk.edits.note("Rename an object", "");
    }
    if is_renaming {
        return;
    }
    let is_hidden = desk.document.hidden_objects.contains(&number);
    ui.horizontal(|ui| {
        if eye(ui, name, is_hidden) {
            set_hidden(desk, number, !is_hidden);
            desk.edits
                .note(format!("{} {name}", if is_hidden { "Show" } else { "Hide" }), "");
        }
        let is_chosen = desk.shared.selection.objects.contains(&number);
        let shown = line(ui, "Object", name, is_chosen, is_hidden);
        light_up(ui, desk, &shown, Thing::Object(number));
        if shown.clicked() {
            let beside_others = ui.input(|input| input.modifiers.command || input.modifiers.shift);
            choose(desk, number, beside_others);
        }
        shown.context_menu(|ui| {
            if ui.button("Rename").clicked() {
                panel.rename(what, name);
                ui.close();
            }
            if widgets::pressed(ui, "Isolate", "Hides all other objects") {
                desk.document.hidden_objects = (0..count).filter(|other| *other != number).collect();
                desk.edits.note(format!("Isolate {name}"), "");
                ui.close();
            }
            if widgets::pressed(ui, "Focus", Command::FrameSelected.help()) {
                choose(desk, number, false);
                desk.act(Command::FrameSelected);
                ui.close();
            }
            let all = Command::ShowObjects;
            let is_any_hidden = !desk.document.hidden_objects.is_empty();
            if ui.add_enabled(is_any_hidden, egui::Button::new(all.label())).clicked() {
                desk.act(all);
                ui.close();
            }
        });
    });
}

/// Chooses an object, and with it the material that it shows.
fn choose(desk: &mut Desk<'_>, number: usize, beside_others: bool) {
    desk.shared.selection.choose_object(number, beside_others);
    let slots = desk.scene().map_or_else(Vec::new, |scene| scene.model.slots_of(number));
    match slots.first() {
        Some(slot) if !beside_others => desk.actions.push(Action::SelectSlot(*slot)),
        _ if beside_others => {
            let chosen = desk.shared.selection.objects.contains(&number);
            let also = &mut desk.shared.selection.also;
            slots.iter().for_each(|slot| {
                if chosen {
                    also.insert(*slot);
                } else {
                    also.remove(slot);
                }
            });
        }
        _ => {}
    }
}

fn set_hidden(desk: &mut Desk<'_>, number: usize, is_hidden: bool) {
    let hidden = &mut desk.document.hidden_objects;
    hidden.retain(|other| *other != number);
    if is_hidden {
        hidden.push(number);
        hidden.sort_unstable();
    }
}

fn ground(ui: &mut Ui, desk: &mut Desk<'_>) {
    let is_hidden = !desk.document.ground;
    ui.horizontal(|ui| {
        if eye(ui, "ground", is_hidden) {
            desk.document.ground = is_hidden;
            desk.edits.note("Ground", "scene.ground");
        }
        let shown = line(ui, "Object", "Ground", false, is_hidden);
        if shown.on_hover_text("Shows the ground's parameters").clicked() {
            desk.actions.push(Action::Reveal(crate::app::pane::Pane::Lighting));
        }
    });
}

/// The button that shows or hides something; true where it was pressed.
fn eye(ui: &mut Ui, name: &str, is_hidden: bool) -> bool {
    let (icon, verb) = if is_hidden {
        (Icon::Hidden, "Show")
    } else {
        (Icon::Shown, "Hide")
    };
    icons::button(ui, icon, &format!("{verb} {name}"), verb).clicked()
}
