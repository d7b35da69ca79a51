//! Materials to start from: the shipped ones, and the user's own.

use std::path::Path;

use egui::{Key, Response, Sense, TextureHandle, Ui, vec2};

use super::Desk;
use crate::app::actions::{Action, Command};
use crate::app::library::{Change, Library, Shown};
use crate::app::{theme, widgets};
use crate::document::{MaterialSettings, PRESETS};

/// Side of a material's picture, points.
const PICTURE: f32 = 36.0;

pub(in crate::app) fn show(ui: &mut Ui, desk: &mut Desk<'_>) {
    let search = egui::TextEdit::singleline(&mut desk.state.preset_search)
        .hint_text("Search")
        .desired_width(f32::INFINITY)
        .margin(vec2(6.0, 4.0));
    ui.add(search).accessible_name("Search presets");
    ui.add_space(0.5 * theme::GAP);
    desk.state.library.make_pictures(ui.ctx());
    let wanted = desk.state.preset_search.to_lowercase();
    let current = desk.material();
    let mut found = false;
    for (index, material) in PRESETS.iter().enumerate() {
        if !material.name.to_lowercase().contains(&wanted) {
            continue;
        }
        found = true;
        let picture = desk.state.library.shipped_picture(index);
        if entry(ui, material, picture, *material == current).clicked() {
            desk.actions.push(Action::UseMaterial(Box::new(material.clone())));
        }
    }
    let library = &mut desk.state.library;
    let own: Vec<Shown> = std::mem::take(&mut library.own);
    let is_wanted = |shown: &&Shown| shown.entry.name().to_lowercase().contains(&wanted);
    for (at, shown) in own.iter().filter(is_wanted).enumerate() {
        found = true;
        if at == 0 {
            ui.add_space(0.5 * theme::GAP);
            widgets::note(ui, "Mine");
        }
        own_entry(ui, shown, library, &current, desk.actions);
    }
    library.own = own;
    if !found {
        widgets::note(ui, "No preset of that name.");
    }
    ui.add_space(theme::GAP);
    let removed = desk.state.library.removed.as_ref();
    if let Some(name) = removed.and_then(|removed| removed.path().file_stem())
        && ui.button(format!("Restore {}", name.to_string_lossy())).clicked()
    {
        desk.actions.push(Action::ChangeLibrary(Change::Restore));
    }
    let save = ui.button(Command::SaveToMyPresets.label());
    if save.on_hover_text(Command::SaveToMyPresets.help()).clicked() {
        desk.act(Command::SaveToMyPresets);
    }
}

/// A material of the user's, with what can be done to its file.
fn own_entry(ui: &mut Ui, shown: &Shown, library: &mut Library, current: &MaterialSettings, actions: &mut Vec<Action>) {
    let path = &shown.entry.path;
    if let Some((renamed, name)) = &mut library.renaming
        && renamed == path
    {
        if let Some(change) = name_field(ui, path, name) {
            actions.extend(change.map(Action::ChangeLibrary));
            library.renaming = None;
        }
        return;
    }
    let name = shown.entry.name();
    let mut is_renaming = false;
    let mut more = |ui: &mut Ui| {
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
        button.accessible_name(format!("Rename or delete {name}"));
    });
    if is_chosen && let Ok(material) = &shown.entry.material {
        actions.push(Action::UseMaterial(Box::new(material.clone())));
    }
    if is_renaming {
        library.renaming = Some((path.clone(), name));
    }
}

/// `Some(None)`: left as it was.
fn name_field(ui: &mut Ui, path: &Path, name: &mut String) -> Option<Option<Change>> {
    let field = ui
        .add(egui::TextEdit::singleline(name).desired_width(f32::INFINITY))
        .accessible_name("New name");
    if ui.input(|input| input.key_pressed(Key::Escape)) {
        return Some(None);
    }
    if field.lost_focus() {
        let name = name.trim().to_owned();
        return Some((!name.is_empty()).then(|| Change::Rename(path.to_owned(), name)));
    }
    field.request_focus();
    None
}

/// A preset: its picture, or one colour until it is there, and its name.
fn entry(ui: &mut Ui, material: &MaterialSettings, picture: Option<&TextureHandle>, is_current: bool) -> Response {
    let size = vec2(ui.available_width(), PICTURE + 4.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_current, &material.name));
    let visuals = ui.style().interact_selectable(&response, is_current);
    if is_current || response.hovered() || response.has_focus() {
        ui.painter()
            .rect_filled(rect, visuals.corner_radius, visuals.weak_bg_fill);
    }
    let center = rect.left_center() + vec2(0.5 * PICTURE + 4.0, 0.0);
    match picture {
        Some(picture) => {
            let at = egui::Rect::from_center_size(center, vec2(PICTURE, PICTURE));
            egui::Image::new(picture).corner_radius(3.0).paint_at(ui, at);
        }
        None => {
            let [r, g, b] = widgets::srgb_of(material.base_color);
            let color = egui::Color32::from_rgb(r, g, b);
            ui.painter().circle_filled(center, 0.35 * PICTURE, color);
        }
    }
    let font = egui::TextStyle::Body.resolve(ui.style());
    let at = rect.left_center() + vec2(PICTURE + 14.0, 0.0);
    ui.painter().text(
        at,
        egui::Align2::LEFT_CENTER,
        &material.name,
        font,
        visuals.text_color(),
    );
    response
}
