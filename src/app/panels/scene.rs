//! The objects of the model, and the ground: shown or hidden, chosen, renamed.

use super::*;
use crate::{kit::keys, services::selection::Thing};

/// The list.
#[derive(Default)]
pub struct ScenePanel {
    search: String,
    /// The object that is being given another name, and what was typed so far.
    renaming: Option<(usize, String)>,
}

impl Panel for ScenePanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk) {
        desk.shared.selection.is_shown = true;
        keys::search_field(ui, &mut self.search, "Search the scene", "Search the scene");
        ui.add_space(0.5 * theme::GAP);
        let wanted = self.search.to_lowercase();
        let is_wanted = |name: &str| name.to_lowercase().contains(&wanted);
        widgets::comes_and_goes(ui, |ui| {
            let count = desk.scene().map_or(0, |scene| scene.model.objects.len());
            for number in 0..count {
                let name = desk.object_name(number).unwrap_or_default();
                if is_wanted(&name) {
                    ui.push_id(("object", number), |ui| self.object(ui, desk, number, &name, count));
                }
            }
            if is_wanted("Ground") {
                ui.push_id("ground", |ui| ground(ui, desk));
            }
        });
    }
}

impl ScenePanel {
    fn object(&mut self, ui: &mut Ui, desk: &mut Desk, number: usize, name: &str, count: usize) {
        if let Some((of, typed)) = &mut self.renaming
            && *of == number
        {
            if let Some(chosen) = widgets::name_field(ui, typed) {
                self.renaming = None;
                if let Some(renamed) = chosen {
                    desk.document.object_names.insert(number, renamed);
                    desk.edits.did("Rename an object");
                }
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
                desk.edits.did(format!("{verb} {name}"));
            }
            let is_chosen = desk.shared.selection.objects.contains(&number);
            let shown = line(ui, name, is_chosen, is_hidden);
            desk.light_up(ui, &shown, Thing::Object(number));
            if shown.clicked() {
                choose(desk, number, widgets::is_beside_others(ui));
            }
            shown.context_menu(|ui| {
                if widgets::entry(ui, "Rename", "") {
                    self.renaming = Some((number, name.to_owned()));
                }
                if widgets::entry(ui, "Isolate", "Hides all other objects") {
                    desk.document.hidden_objects = (0..count).filter(|other| *other != number).collect();
                    desk.edits.did(format!("Isolate {name}"));
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
        let shown = line(ui, "Ground", false, is_hidden);
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

/// A line over the width that is left; a faint one is not shown in the image.
fn line(ui: &mut Ui, name: &str, is_selected: bool, is_faint: bool) -> Response {
    let size = vec2(ui.available_width(), theme::ROW_HEIGHT);
    let text = RichText::new(name);
    let text = if is_faint { text.weak() } else { text };
    // At the left, as lines of a tree are.
    let button = Button::selectable(is_selected, (text, Atom::grow()))
        .truncate()
        .sense(Sense::click_and_drag());
    let shown = ui.add_sized(size, button.min_size(size));
    shown.accessible_name(format!("Object {name}"))
}
