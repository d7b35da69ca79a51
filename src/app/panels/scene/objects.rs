//! The objects of the model, and the ground: shown or hidden, chosen, renamed.

use super::*;

/// The lines that are seen at once: more are scrolled to.
const SHOWN: f32 = 12.0;

pub fn show(ui: &mut Ui, desk: &mut Desk, panel: &mut ScenePanel) {
    let Some(count) = desk.scene().map(|scene| scene.model.objects.len()) else {
        return;
    };
    let height = SHOWN * (theme::ROW_HEIGHT + ui.spacing().item_spacing.y);
    widgets::group(ui, "Objects", |ui| {
        let area = ScrollArea::vertical().max_height(height).id_salt("objects");
        area.show(ui, |ui| {
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

fn object(ui: &mut Ui, desk: &mut Desk, panel: &mut ScenePanel, number: usize, name: &str, count: usize) {
    let what = Renamed::Thing(Thing::Object(number));
    if let Some(renamed) = panel.new_name(ui, &what) {
        if let Some(renamed) = renamed {
            desk.document.object_names.insert(number, renamed);
            desk.edits.note("Rename an object", "");
        }
        return;
    }
    let is_hidden = desk.document.hidden_objects.contains(&number);
    ui.horizontal(|ui| {
        if let Some(verb) = eye(ui, name, is_hidden) {
            let hidden = &mut desk.document.hidden_objects;
            if is_hidden {
                hidden.retain(|other| *other != number);
            } else {
                hidden.push(number);
                hidden.sort_unstable();
            }
            desk.edits.note(format!("{verb} {name}"), "");
        }
        let is_chosen = desk.shared.selection.objects.contains(&number);
        let shown = line(ui, "Object", name, is_chosen, is_hidden);
        light_up(ui, desk, &shown, Thing::Object(number));
        if shown.clicked() {
            choose(desk, number, is_beside_others(ui));
        }
        shown.context_menu(|ui| {
            if widgets::entry(ui, "Rename", "") {
                panel.rename(what, name);
            }
            if widgets::entry(ui, "Isolate", "Hides all other objects") {
                desk.document.hidden_objects = (0..count).filter(|other| *other != number).collect();
                desk.edits.note(format!("Isolate {name}"), "");
            }
            if widgets::entry(ui, "Focus", Command::FrameSelected.help()) {
                choose(desk, number, false);
                desk.act(Command::FrameSelected);
            }
            let is_any_hidden = !desk.document.hidden_objects.is_empty();
            if widgets::pressed_if(ui, is_any_hidden, Command::ShowObjects.label(), "", "") {
                desk.act(Command::ShowObjects);
                ui.close();
            }
        });
    });
}

/// Chooses an object, and with it the material that it shows.
fn choose(desk: &mut Desk, number: usize, beside_others: bool) {
    desk.shared.selection.choose_object(number, beside_others);
    let slots = desk.scene().map_or_else(Vec::new, |scene| scene.model.slots_of(number));
    if !beside_others {
        let first = slots.first().map(|slot| Action::SelectSlot(*slot));
        desk.actions.extend(first);
        return;
    }
    let selection = &mut desk.shared.selection;
    if selection.objects.contains(&number) {
        selection.also.extend(slots);
    } else {
        selection.also.retain(|slot| !slots.contains(slot));
    }
}

fn ground(ui: &mut Ui, desk: &mut Desk) {
    let is_hidden = !desk.document.ground;
    ui.horizontal(|ui| {
        if eye(ui, "ground", is_hidden).is_some() {
            desk.document.ground = is_hidden;
            desk.edits.note("Ground", "scene.ground");
        }
        let shown = line(ui, "Object", "Ground", false, is_hidden);
        if shown.on_hover_text("Shows the ground's parameters").clicked() {
            desk.actions.push(Action::Reveal(Pane::Lighting));
        }
    });
}

/// The button that shows or hides something; what it does where it was pressed.
fn eye(ui: &mut Ui, name: &str, is_hidden: bool) -> Option<&'static str> {
    let (icon, verb) = if is_hidden {
        (Icon::Hidden, "Show")
    } else {
        (Icon::Shown, "Hide")
    };
    let is_pressed = icons::button(ui, icon, &format!("{verb} {name}"), verb).clicked();
    is_pressed.then_some(verb)
}
