//! Materials to start from: the shipped ones, and the user's own.

use egui::{Response, TextureHandle, Ui, Vec2, vec2};

use super::Panel;
use crate::app::actions::{Action, Command};
use crate::app::desk::Desk;
use crate::app::kit::theme;
use crate::app::kit::widgets::{self, PictureRow};
use crate::app::services::library::{Change, Library, Shown};
use crate::document::MaterialSettings;
use crate::store::PRESETS;
use crate::store::exchange::FORMATS;

/// Side of a material's picture, points.
const PICTURE: f32 = 36.0;

/// The materials to start from.
#[derive(Default)]
pub(super) struct PresetsPanel {
    /// What is searched for.
    search: String,
}

impl Panel for PresetsPanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        let search = egui::TextEdit::singleline(&mut self.search)
            .hint_text("Search")
            .desired_width(f32::INFINITY)
            .margin(vec2(6.0, 4.0));
        ui.add(search).accessible_name("Search presets");
        ui.add_space(0.5 * theme::GAP);
        desk.shared.library.make_pictures(ui.ctx());
        widgets::comes_and_goes(ui, |ui| entries(ui, desk, &self.search));
        ui.add_space(theme::GAP);
        widgets::comes_and_goes(ui, |ui| restoring(ui, desk));
        let save = ui.button(Command::SaveToMyPresets.label());
        if save.on_hover_text(Command::SaveToMyPresets.help()).clicked() {
            desk.act(Command::SaveToMyPresets);
        }
    }
}

/// The button that brings back what was deleted last.
fn restoring(ui: &mut Ui, desk: &mut Desk<'_>) {
    let removed = desk.shared.library.removed.as_ref();
    if let Some(name) = removed.and_then(|removed| removed.path().file_stem())
        && ui.button(format!("Restore {}", name.to_string_lossy())).clicked()
    {
        desk.actions.push(Action::ChangeLibrary(Change::Restore));
    }
}

/// The materials whose names have what is searched for.
fn entries(ui: &mut Ui, desk: &mut Desk<'_>, search: &str) {
    let wanted = search.to_lowercase();
    let current = desk.material();
    let mut found = false;
    for (index, material) in PRESETS.iter().enumerate() {
        if !material.name.to_lowercase().contains(&wanted) {
            continue;
        }
        found = true;
        let picture = desk.shared.library.shipped_picture(index);
        let response = entry(ui, material, picture, *material == current);
        if response.clicked() {
            desk.actions.push(Action::UseMaterial(Box::new(material.clone())));
        }
        response.context_menu(|ui| taking_along(ui, material, desk.actions));
    }
    let library = &mut desk.shared.library;
    let own: Vec<Shown> = std::mem::take(&mut library.own);
    let is_wanted = |shown: &&Shown| shown.entry.name().to_lowercase().contains(&wanted);
    for (at, shown) in own.iter().filter(is_wanted).enumerate() {
        found = true;
        if at == 0 {
            ui.add_space(0.5 * theme::GAP);
            widgets::note(ui, "Mine");
        }
        // By its file, as others may come before it.
        let builder = egui::UiBuilder::new().scope_id(egui::Id::unique(("preset", &shown.entry.path)));
        ui.scope_builder(builder, |ui| own_entry(ui, shown, library, &current, desk.actions));
    }
    library.own = own;
    if !found {
        widgets::note(ui, "No preset of that name.");
    }
}

/// The ways of a material into other programs: nothing can be dragged out of the window on every system that it runs on.
fn taking_along(ui: &mut Ui, material: &MaterialSettings, actions: &mut Vec<Action>) {
    if ui.button(Command::Export.label()).clicked() {
        actions.push(Action::Export(Box::new(material.clone())));
    }
    ui.menu_button("Copy as", |ui| {
        for format in FORMATS
            .iter()
            .filter(|format| format.is_written && format.format.is_text())
        {
            if ui.button(format.label).on_hover_text(format.help).clicked() {
                actions.push(Action::CopyAs(Box::new(material.clone()), format.name));
            }
        }
    });
}

/// A material of the user's, with what can be done to its file.
fn own_entry(ui: &mut Ui, shown: &Shown, library: &mut Library, current: &MaterialSettings, actions: &mut Vec<Action>) {
    let path = &shown.entry.path;
    if let Some((renamed, name)) = &mut library.renaming
        && renamed == path
    {
        if let Some(chosen) = widgets::name_field(ui, name) {
            let rename = |name| Action::ChangeLibrary(Change::Rename(path.clone(), name));
            actions.extend(chosen.map(rename));
            library.renaming = None;
        }
        return;
    }
    let name = shown.entry.name();
    let mut is_renaming = false;
    let mut more = |ui: &mut Ui| {
        if let Ok(material) = &shown.entry.material {
            taking_along(ui, material, actions);
            ui.separator();
        }
        if ui
            .add_enabled(shown.entry.material.is_ok(), egui::Button::new("Rename"))
            .clicked()
        {
            is_renaming = true;
        }
        if ui
            .add_enabled(shown.entry.material.is_ok(), egui::Button::new("Duplicate"))
            .clicked()
        {
            actions.push(Action::ChangeLibrary(Change::Duplicate(path.clone())));
        }
        if ui.button("Delete").clicked() {
            actions.push(Action::ChangeLibrary(Change::Remove(path.clone())));
        }
    };
    let mut is_chosen = false;
    ui.horizontal(|ui| {
        let width = ui.available_width() - 32.0;
        let response = ui
            .allocate_ui(vec2(width, PICTURE), |ui| match &shown.entry.material {
                Ok(material) => entry(ui, material, library.picture(shown.key), material == current),
                Err(why) => ui
                    .add_enabled(false, egui::Label::new(&name))
                    .on_disabled_hover_text(why),
            })
            .inner;
        is_chosen = response.clicked();
        response.context_menu(&mut more);
        let button = ui.menu_button("…", &mut more).response;
        button.accessible_name(format!("Rename, export or delete {name}"));
    });
    if is_chosen && let Ok(material) = &shown.entry.material {
        actions.push(Action::UseMaterial(Box::new(material.clone())));
    }
    if is_renaming {
        library.renaming = Some((path.clone(), name));
    }
}

/// A preset: its picture, or one colour until it is there, and its name.
fn entry(ui: &mut Ui, material: &MaterialSettings, picture: Option<&TextureHandle>, is_current: bool) -> Response {
    let [r, g, b] = widgets::srgb_of(material.base_color);
    let row = PictureRow {
        name: &material.name,
        picture,
        size: Vec2::splat(PICTURE),
        color: egui::Color32::from_rgb(r, g, b),
        is_current,
    };
    let response = row.show(ui);
    // Onto an object in the viewport, or a material in the tree of the scene.
    response.dnd_set_drag_payload(material.clone());
    response
}
