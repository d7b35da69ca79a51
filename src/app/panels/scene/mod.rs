//! The scene as a tree: objects, materials, lights and cameras of the document.

mod materials;
mod objects;

use egui::{Response, RichText, Sense, Ui, vec2};

use super::Panel;
use crate::app::actions::Action;
use crate::app::desk::Desk;
use crate::app::kit::{keys, theme, widgets};
use crate::app::pane::Pane;
use crate::app::services::environments::environment_label;
use crate::app::services::selection::Thing;

/// The tree.
#[derive(Default)]
pub struct ScenePanel {
    search: String,
    renaming: Option<Renaming>,
}

/// What is being given another name.
#[derive(Clone, Debug, PartialEq)]
enum Renamed {
    Thing(Thing),
    Camera(usize),
}

struct Renaming {
    what: Renamed,
    name: String,
}

impl Panel for ScenePanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
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

    /// The field for the new name of something, where it is being renamed: a new name that was typed, and whether it is.
    fn new_name(&mut self, ui: &mut Ui, what: &Renamed) -> (Option<String>, bool) {
        let Some(renaming) = self.renaming.as_mut().filter(|renaming| renaming.what == *what) else {
            return (None, false);
        };
        let done = widgets::name_field(ui, &mut renaming.name);
        if done.is_some() {
            self.renaming = None;
        }
        (done.flatten(), true)
    }

    fn rename(&mut self, what: Renamed, name: &str) {
        self.renaming = Some(Renaming {
            what,
            name: name.to_owned(),
        });
    }

    fn lights(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        let environment = format!(
            "Environment: {}",
            environment_label(&desk.document.lighting.environment)
        );
        let lights = desk.document.lighting.area_lights.clone();
        let names = (1..).zip(&lights).map(|(number, light): (u32, _)| {
            let muted = if light.is_muted { ", muted" } else { "" };
            format!("Area light {number}{muted}")
        });
        for name in std::iter::once(environment)
            .chain(names)
            .filter(|name| self.is_wanted(name))
        {
            let line = line(ui, "Light", &name, false, false);
            if line.on_hover_text("Shows the light's parameters").clicked() {
                desk.actions.push(Action::Reveal(Pane::Lighting));
            }
        }
    }

    fn cameras(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        if self.is_wanted("View") && line(ui, "Camera", "View", false, false).clicked() {
            desk.actions.push(Action::Reveal(Pane::Camera));
        }
        for number in 0..desk.document.bookmarks.len() {
            let bookmark = desk.document.bookmarks[number].clone();
            if !self.is_wanted(&bookmark.name) {
                continue;
            }
            let what = Renamed::Camera(number);
            let (name, is_renaming) = self.new_name(ui, &what);
            if let Some(name) = name {
                desk.document.bookmarks[number].name = name;
                desk.edits.note("Rename a camera", "");
            }
            if is_renaming {
                continue;
            }
            let is_current = bookmark.camera == desk.document.camera;
            let shown = line(ui, "Camera", &bookmark.name, is_current, false).on_hover_text("Looks from there");
            if shown.clicked() {
                desk.document.camera = bookmark.camera;
                desk.edits.note(format!("Look from {}", bookmark.name), "");
            }
            shown.context_menu(|ui| {
                if ui.button("Rename").clicked() {
                    self.rename(what, &bookmark.name);
                    ui.close();
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
    let button = egui::Button::selectable(is_selected, (text, egui::Atom::grow()))
        .truncate()
        .sense(Sense::click_and_drag());
    let shown = ui.add_sized(size, button.min_size(size));
    shown.accessible_name(format!("{kind} {name}"))
}

/// A frame around a line that the pointer is over in the viewport.
fn light_up(ui: &Ui, desk: &mut Desk<'_>, response: &Response, thing: Thing) {
    if response.hovered() {
        desk.shared.selection.hovered = Some(thing);
    } else if desk.shared.selection.lit == Some(thing) {
        let stroke = egui::Stroke::new(1.0, theme::accent(ui.visuals().dark_mode));
        ui.painter()
            .rect_stroke(response.rect, 3.0, stroke, egui::StrokeKind::Inside);
    }
}
