//! The scene as a tree: objects, materials, lights and cameras of the document.

mod materials;
mod objects;

use super::*;
use crate::app::kit::keys;
use crate::app::services::selection::Thing;
use crate::app::services::shelves::environment_label;

/// The tree.
#[derive(Default)]
pub struct ScenePanel {
    search: String,
    /// What is being given another name, and what was typed so far.
    renaming: Option<(Renamed, String)>,
}

/// What may be given another name.
#[derive(PartialEq)]
enum Renamed {
    Thing(Thing),
    Camera(usize),
}

impl Panel for ScenePanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk) {
        desk.shared.selection.is_shown = true;
        keys::search_field(ui, &mut self.search, "Search the scene", "Search the scene");
        ui.add_space(0.5 * theme::GAP);
        widgets::comes_and_goes(ui, |ui| objects::show(ui, desk, self));
        widgets::comes_and_goes(ui, |ui| materials::show(ui, desk, self));
        widgets::group(ui, "Lights", |ui| self.lights(ui, desk));
        widgets::group(ui, "Cameras", |ui| self.cameras(ui, desk));
    }
}

impl ScenePanel {
    /// Whether a name has what is searched for.
    fn is_wanted(&self, name: &str) -> bool {
        name.to_lowercase().contains(&self.search.to_lowercase())
    }

    /// The field for the new name of something, where it is being renamed: once a name was typed, that.
    fn new_name(&mut self, ui: &mut Ui, what: &Renamed) -> Option<Option<String>> {
        let (_, name) = self.renaming.as_mut().filter(|(of, _)| of == what)?;
        let done = widgets::name_field(ui, name);
        if done.is_some() {
            self.renaming = None;
        }
        Some(done.flatten())
    }

    fn rename(&mut self, what: Renamed, name: &str) {
        self.renaming = Some((what, name.to_owned()));
    }

    fn lights(&mut self, ui: &mut Ui, desk: &mut Desk) {
        let environment = environment_label(&desk.document.lighting.environment);
        let mut names = vec![format!("Environment: {environment}")];
        for (index, light) in desk.document.lighting.area_lights.iter().enumerate() {
            let muted = if light.is_muted { ", muted" } else { "" };
            names.push(format!("Area light {}{muted}", index + 1));
        }
        for name in names.into_iter().filter(|name| self.is_wanted(name)) {
            let line = line(ui, "Light", &name, false, false);
            if line.on_hover_text("Shows the light's parameters").clicked() {
                desk.actions.push(Action::Reveal(Pane::Lighting));
            }
        }
    }

    fn cameras(&mut self, ui: &mut Ui, desk: &mut Desk) {
        if self.is_wanted("View") && line(ui, "Camera", "View", false, false).clicked() {
            desk.actions.push(Action::Reveal(Pane::Camera));
        }
        for number in 0..desk.document.bookmarks.len() {
            let bookmark = desk.document.bookmarks[number].clone();
            if !self.is_wanted(&bookmark.name) {
                continue;
            }
            let what = Renamed::Camera(number);
            if let Some(renamed) = self.new_name(ui, &what) {
                if let Some(name) = renamed {
                    desk.document.bookmarks[number].name = name;
                    desk.edits.note("Rename a camera", "");
                }
                continue;
            }
            let is_current = bookmark.camera == desk.document.camera;
            let shown = line(ui, "Camera", &bookmark.name, is_current, false).on_hover_text("Looks from there");
            if shown.clicked() {
                desk.document.camera = bookmark.camera;
                desk.edits.note(format!("Look from {}", bookmark.name), "");
            }
            shown.context_menu(|ui| {
                if widgets::entry(ui, "Rename", "") {
                    self.rename(what, &bookmark.name);
                }
            });
        }
    }
}

/// A line of the tree over the width that is left; a faint one is not shown in the image. What kind of thing it is shows
/// it from others of its name.
fn line(ui: &mut Ui, kind: &str, name: &str, is_selected: bool, is_faint: bool) -> Response {
    let size = vec2(ui.available_width(), theme::ROW_HEIGHT);
    let text = RichText::new(name);
    let text = if is_faint { text.weak() } else { text };
    // At the left, as lines of a tree are.
    let button = Button::selectable(is_selected, (text, Atom::grow()))
        .truncate()
        .sense(Sense::click_and_drag());
    let shown = ui.add_sized(size, button.min_size(size));
    shown.accessible_name(format!("{kind} {name}"))
}

/// A frame around a line that the pointer is over in the viewport.
fn light_up(ui: &Ui, desk: &mut Desk, response: &Response, thing: Thing) {
    if response.hovered() {
        desk.shared.selection.hovered = Some(thing);
    } else if desk.shared.selection.lit == Some(thing) {
        widgets::frame(ui, response.rect);
    }
}

/// Whether a click chooses something beside what is chosen.
fn is_beside_others(ui: &Ui) -> bool {
    ui.input(|input| input.modifiers.command || input.modifiers.shift)
}
