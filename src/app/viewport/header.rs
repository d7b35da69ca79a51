//! The bar over the image: what is looked at, in which light, and how it is shown.

use egui::{Align, Layout, Rect, Ui, UiBuilder, vec2};

use crate::app::actions::{Action, Command, do_and_close};
use crate::app::desk::Desk;
use crate::app::kit::icons::{self, Icon};
use crate::app::kit::{theme, widgets};
use crate::app::services::environments::environment_label;
use crate::document::{Denoise, LightPaths};
use crate::render::shown::Shown;
use crate::scene::ModelSource;
use crate::scene::environment::BUILT_IN;

/// What stands in the bar beside model and environment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Item {
    ToneMap,
    Exposure,
    Denoise,
    Resolution,
    Compare,
    Shown,
    Pause,
}

/// From left to right, with their widths in points.
const ITEMS: [(Item, f32); 7] = [
    (Item::ToneMap, 116.0),
    (Item::Exposure, 76.0),
    (Item::Denoise, 62.0),
    (Item::Resolution, 104.0),
    (Item::Compare, 44.0),
    (Item::Shown, 84.0),
    (Item::Pause, theme::ROW_HEIGHT),
];
/// Which of them the bar keeps longest when it gets narrow.
const RANKED: [Item; 7] = [
    Item::Pause,
    Item::Exposure,
    Item::Denoise,
    Item::Shown,
    Item::Compare,
    Item::Resolution,
    Item::ToneMap,
];
/// Width of the menu with the others, points.
const MORE: f32 = 28.0;

/// The models that come with the program.
const MODELS: [(&str, ModelSource); 5] = [
    ("Still life", ModelSource::StillLife),
    ("Teapot", ModelSource::Teapot),
    ("Sphere", ModelSource::Sphere),
    ("Plane", ModelSource::Plane),
    ("Shader ball", ModelSource::Shaderball),
];

pub fn model_label(source: &ModelSource) -> String {
    let built_in = MODELS.iter().find(|(_, of)| of == source);
    match (built_in, source) {
        (Some((label, _)), _) => (*label).to_owned(),
        (None, ModelSource::File(path)) => path.file_name().map_or_else(
            || path.display().to_string(),
            |name| name.to_string_lossy().into_owned(),
        ),
        (None, other) => other.to_string(),
    }
}

pub fn show(ui: &mut Ui, bar: Rect, desk: &mut Desk<'_>) {
    ui.painter().rect_filled(bar, 0.0, ui.visuals().panel_fill);
    let inside = bar.shrink2(vec2(8.0, 0.0));
    let builder = UiBuilder::new()
        .max_rect(inside)
        .layout(Layout::left_to_right(Align::Center));
    let mut ui = ui.new_child(builder);
    ui.set_clip_rect(bar.intersect(ui.clip_rect()));
    models(&mut ui, desk);
    environments(&mut ui, desk);
    let inside = fitting(ui.available_width(), ui.spacing().item_spacing.x);
    widgets::at_right(&mut ui, |ui| {
        if inside.len() < ITEMS.len() {
            more(ui, desk, &inside);
        }
        for (item, width) in ITEMS.into_iter().rev().filter(|(item, _)| inside.contains(item)) {
            // An identity that stays while others come and go with the room: a click under way would be lost.
            let builder = UiBuilder::new().scope_id(ui.scope_id().with(("header", item as usize)));
            ui.scope_builder(builder, |ui| sized(ui, width, |ui| show_item(ui, desk, item)));
        }
    });
}

/// The items that there is room for, points, beside a menu with the others.
fn fitting(room: f32, spacing: f32) -> Vec<Item> {
    let width = |item: &Item| {
        ITEMS
            .iter()
            .find(|(of, _)| of == item)
            .map_or(0.0, |(_, width)| width + spacing)
    };
    if RANKED.iter().map(width).sum::<f32>() <= room {
        return RANKED.to_vec();
    }
    let mut left = room - MORE - spacing;
    let fits = |item: &&Item| {
        left -= width(item);
        left >= 0.0
    };
    RANKED.iter().take_while(fits).copied().collect()
}

fn models(ui: &mut Ui, desk: &mut Desk<'_>) {
    let combo = egui::ComboBox::from_id_salt("model")
        .width(120.0)
        .selected_text(model_label(&desk.document.model));
    let shown = combo.show_ui(ui, |ui| {
        for (label, source) in &MODELS {
            if ui.selectable_label(desk.document.model == *source, *label).clicked() {
                do_and_close(ui, desk.actions, Action::UseModel(source.clone()));
            }
        }
        ui.separator();
        if ui.selectable_label(false, "Open…").clicked() {
            do_and_close(ui, desk.actions, Action::Do(Command::OpenModel));
        }
    });
    shown.response.accessible_name("Model").on_hover_text("Model");
}

fn environments(ui: &mut Ui, desk: &mut Desk<'_>) {
    let current = desk.document.lighting.environment.clone();
    let combo = egui::ComboBox::from_id_salt("environment")
        .width(120.0)
        .selected_text(environment_label(&current));
    let shown = combo.show_ui(ui, |ui| {
        for built_in in &BUILT_IN {
            let label = ui.selectable_label(current == built_in.source, built_in.label);
            if label.on_hover_text(built_in.help).clicked() {
                do_and_close(ui, desk.actions, Action::UseEnvironment(built_in.source.clone()));
            }
        }
        ui.separator();
        if ui.selectable_label(false, "Open…").clicked() {
            do_and_close(ui, desk.actions, Action::Do(Command::OpenEnvironment));
        }
    });
    shown
        .response
        .accessible_name("Environment")
        .on_hover_text("Environment");
}

fn show_item(ui: &mut Ui, desk: &mut Desk<'_>, item: Item) {
    match item {
        Item::ToneMap => desk.setting_control(ui, "view.tone_map", "Viewport tone map"),
        Item::Exposure => desk.setting_control(ui, "view.exposure", "Viewport exposure"),
        Item::Denoise => {
            let denoises = ui.selectable_label(desk.document.view.denoise != Denoise::Off, "Denoise");
            let denoises = denoises.on_hover_text(Command::Denoise.help());
            if denoises.clicked() {
                desk.act(Command::Denoise);
            }
            denoises.accessible_name("Viewport denoise");
        }
        Item::Resolution => {
            let response = widgets::choice(
                ui,
                "header size",
                &mut desk.shared.viewing.resolution,
                &widgets::choices(),
            );
            response
                .accessible_name("Resolution")
                .on_hover_text("Size of the image");
        }
        Item::Compare => {
            let compares = ui.selectable_label(desk.shared.compare.is_on, "A | B");
            let compares = compares.on_hover_text("Compare with another material or lobe (C)");
            if compares.clicked() {
                desk.act(Command::Compare);
            }
            compares.accessible_name("Compare");
        }
        Item::Shown => {
            let mut seen = seen(desk);
            let response = widgets::choice(ui, "header shown", &mut seen, &all_seen(desk));
            show_seen(desk, seen);
            response
                .accessible_name("Viewport shows")
                .on_hover_text("Display: image, light passes, or AOVs");
        }
        Item::Pause => {
            let (icon, help) = if desk.shared.rendering.is_paused {
                (Icon::Play, "Resume (space)")
            } else {
                (Icon::Pause, "Pause (space)")
            };
            if icons::button(ui, icon, Command::Pause.label(), help).clicked() {
                desk.act(Command::Pause);
            }
        }
    }
}

/// What the viewport shows of a render, and which light is rendered.
type Seen = (Shown, LightPaths);

fn seen(desk: &Desk<'_>) -> Seen {
    (desk.shared.viewing.shown, desk.document.render.light_paths)
}

/// What there is to be seen: parts of the light behind the image; maps of the light that is rendered.
fn all_seen(desk: &Desk<'_>) -> Vec<(Seen, &'static str, &'static str)> {
    let rendered = desk.document.render.light_paths;
    let maps = Shown::ALL.iter().filter(|(shown, ..)| *shown != Shown::Picture);
    let maps = maps.map(|(shown, label, help)| ((*shown, rendered), *label, *help));
    let (_, picture, help) = Shown::ALL[0];
    let whole = ((Shown::Picture, LightPaths::All), picture, help);
    let parts = [LightPaths::Direct, LightPaths::Indirect];
    let parts = parts.map(|part| ((Shown::Picture, part), part.label(), part.help()));
    std::iter::once(whole).chain(parts).chain(maps).collect()
}

fn show_seen(desk: &mut Desk<'_>, (shown, paths): Seen) {
    if desk.shared.viewing.shown != shown {
        desk.shared.viewing.shown = shown;
        desk.actions.push(Action::Show(shown));
    }
    if desk.document.render.light_paths != paths {
        desk.document.render.light_paths = paths;
        desk.edits.note("Light shown", "");
    }
}

/// A menu of the items that the bar has no room for.
fn more(ui: &mut Ui, desk: &mut Desk<'_>, inside: &[Item]) {
    let menu = ui.menu_button("…", |ui| {
        for (item, _) in ITEMS.iter().filter(|(item, _)| !inside.contains(item)) {
            menu_entry(ui, desk, *item);
        }
    });
    menu.response
        .accessible_name("More of the viewport's controls")
        .on_hover_text("More");
}

/// An item as an entry of a menu, where controls that open menus of their own can't be.
fn menu_entry(ui: &mut Ui, desk: &mut Desk<'_>, item: Item) {
    match item {
        Item::ToneMap => {
            let mut curve = desk.document.view.tone_map;
            if widgets::choice_menu(ui, "Tone map", &mut curve, &widgets::choices()) {
                desk.document.view.tone_map = curve;
                desk.edits.note("Tone map", "view.tone_map");
            }
        }
        Item::Resolution => {
            widgets::choice_menu(
                ui,
                "Resolution",
                &mut desk.shared.viewing.resolution,
                &widgets::choices(),
            );
        }
        Item::Shown => {
            let mut seen = seen(desk);
            widgets::choice_menu(ui, "Viewport shows", &mut seen, &all_seen(desk));
            show_seen(desk, seen);
        }
        Item::Exposure => {
            ui.horizontal(|ui| {
                ui.label("Exposure");
                show_item(ui, desk, item);
            });
        }
        Item::Denoise => command(ui, desk, Command::Denoise),
        Item::Compare => command(ui, desk, Command::Compare),
        Item::Pause => command(ui, desk, Command::Pause),
    }
}

fn command(ui: &mut Ui, desk: &mut Desk<'_>, command: Command) {
    if widgets::pressed(ui, command.label(), command.help()) {
        do_and_close(ui, desk.actions, Action::Do(command));
    }
}

pub fn sized(ui: &mut Ui, width: f32, add: impl FnOnce(&mut Ui)) {
    let layout = Layout::left_to_right(Align::Center);
    ui.allocate_ui_with_layout(vec2(width, theme::ROW_HEIGHT), layout, add);
}
