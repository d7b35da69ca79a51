//! The bar over the image: what is looked at, in which light, and how it is shown.

use super::*;
use crate::{
    actions::do_and_close,
    desk::lights,
    document::{Denoise, LightPaths},
    render::shown::Shown,
    scene::ModelSource,
    services::shelves::environment_label,
};

/// What stands in the bar beside model and environment: what it keeps longest when it gets narrow first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Item {
    Pause,
    Exposure,
    Denoise,
    Shown,
    Compare,
    Resolution,
    ToneMap,
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
        (None, ModelSource::File(path)) => {
            let name = path.file_name().unwrap_or(path.as_os_str());
            name.to_string_lossy().into_owned()
        }
        (None, other) => other.to_string(),
    }
}

pub fn show(ui: &mut Ui, bar: Rect, desk: &mut Desk) {
    ui.painter().rect_filled(bar, 0.0, ui.visuals().panel_fill);
    let mut ui = in_bar(ui, "header", bar);
    models(&mut ui, desk);
    environments(&mut ui, desk);
    let (room, spacing) = (ui.available_width(), ui.spacing().item_spacing.x);
    let widths = ITEMS.map(|(item, width)| (item, width + spacing)).to_vec();
    let mut last = widgets::fitting(widths.clone(), room);
    let has_all = last == Some(Item::ToneMap);
    if !has_all {
        last = widgets::fitting(widths, room - 28.0 - spacing);
    }
    let fits = |(item, _): &(Item, f32)| Some(*item) <= last;
    widgets::at_right(&mut ui, |ui| {
        if !has_all {
            // The items that the bar has no room for.
            let menu = ui.menu_button("…", |ui| {
                for (item, _) in ITEMS.into_iter().filter(|item| !fits(item)) {
                    menu_entry(ui, desk, item);
                }
            });
            let name = "More of the viewport's controls";
            menu.response.accessible_name(name).on_hover_text("More");
        }
        for (item, width) in ITEMS.into_iter().rev().filter(fits) {
            // An identity that stays while others come and go with the room: a click under way would be lost.
            widgets::known_by(ui, ("header", item as usize), |ui| {
                widgets::sized(ui, width, |ui| show_item(ui, desk, item));
            });
        }
    });
}

/// The inside of a bar.
pub fn in_bar(ui: &mut Ui, name: &str, bar: Rect) -> Ui {
    let mut inside = over(ui, name, bar.shrink2(vec2(8.0, 0.0)));
    inside.set_clip_rect(bar.intersect(ui.clip_rect()));
    inside
}

/// A list of what comes with the program, and the way to a file of one's own.
fn list(ui: &mut Ui, desk: &mut Desk, (name, current): (&str, String), entries: &[(&str, &str, bool, Action)]) {
    let combo = ComboBox::from_id_salt(name).width(120.0).selected_text(current);
    let shown = combo.show_ui(ui, |ui| {
        for (label, help, is_current, action) in entries {
            let entry = ui.selectable_label(*is_current, *label);
            if widgets::explained(entry, help).clicked() {
                do_and_close(ui, desk.actions, action.clone());
            }
        }
        ui.separator();
        if ui.selectable_label(false, "Open…").clicked() {
            do_and_close(ui, desk.actions, Action::Do(Command::Open));
        }
    });
    shown.response.accessible_name(name).on_hover_text(name);
}

fn models(ui: &mut Ui, desk: &mut Desk) {
    let current = &desk.document.model;
    let name = ("Model", model_label(current));
    let entries = MODELS.map(|(label, source)| (label, "", source == *current, Action::UseModel(source)));
    list(ui, desk, name, &entries);
}

fn environments(ui: &mut Ui, desk: &mut Desk) {
    let current = &desk.document.lighting.environment;
    let name = ("Environment", environment_label(current));
    let entries = lights().map(|built_in| {
        let action = Action::UseEnvironment(built_in.source.clone());
        (built_in.label, built_in.help, *current == built_in.source, action)
    });
    let entries: Vec<_> = entries.collect();
    list(ui, desk, name, &entries);
}

fn show_item(ui: &mut Ui, desk: &mut Desk, item: Item) {
    let mut toggle = |ui: &mut Ui, command: Command, (text, name, help): (&str, &str, &str), is_on: bool| {
        let toggle = ui.selectable_label(is_on, text).on_hover_text(help);
        if toggle.clicked() {
            desk.actions.push(Action::Do(command));
        }
        toggle.accessible_name(name);
    };
    match item {
        Item::ToneMap => desk.setting_control(ui, "view.tone_map", "Viewport tone map"),
        Item::Exposure => desk.setting_control(ui, "view.exposure", "Viewport exposure"),
        Item::Denoise => {
            let words = ("Denoise", "Viewport denoise", Command::Denoise.help());
            let is_on = desk.document.view.denoise != Denoise::Off;
            toggle(ui, Command::Denoise, words, is_on);
        }
        Item::Resolution => {
            let resolution = &mut desk.shared.viewing.resolution;
            let response = widgets::choice(ui, "header size", resolution, &widgets::choices());
            let response = response.accessible_name("Resolution");
            response.on_hover_text("Size of the image");
        }
        Item::Compare => {
            let words = ("A | B", "Compare", "Compare with another material or lobe (C)");
            toggle(ui, Command::Compare, words, desk.shared.compare.is_on);
        }
        Item::Shown => {
            let mut seen = seen(desk);
            let response = widgets::choice(ui, "header shown", &mut seen, &all_seen(desk));
            show_seen(desk, seen);
            let response = response.accessible_name("Viewport shows");
            response.on_hover_text("Display: image, light passes, or AOVs");
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

fn seen(desk: &Desk) -> Seen {
    (desk.shared.viewing.shown, desk.document.render.light_paths)
}

/// What there is to be seen: parts of the light behind the image; maps of the light that is rendered.
fn all_seen(desk: &Desk) -> Vec<(Seen, &'static str, &'static str)> {
    let rendered = desk.document.render.light_paths;
    let maps = Shown::ALL[1..]
        .iter()
        .map(|shown| ((*shown, rendered), shown.label(), shown.help()));
    let whole = (
        (Shown::Picture, LightPaths::All),
        Shown::Picture.label(),
        Shown::Picture.help(),
    );
    let parts = [LightPaths::Direct, LightPaths::Indirect];
    let parts = parts.map(|part| ((Shown::Picture, part), part.label(), part.help()));
    std::iter::once(whole).chain(parts).chain(maps).collect()
}

fn show_seen(desk: &mut Desk, (shown, paths): Seen) {
    if desk.shared.viewing.shown != shown {
        desk.shared.viewing.shown = shown;
        desk.actions.push(Action::Show(shown));
    }
    if desk.document.render.light_paths != paths {
        desk.document.render.light_paths = paths;
        desk.edits.did("Light shown");
    }
}

/// An item as an entry of a menu, where controls that open menus of their own can't be.
fn menu_entry(ui: &mut Ui, desk: &mut Desk, item: Item) {
    let mut entry = |ui: &mut Ui, command: Command| {
        if widgets::entry(ui, command.label(), command.help()) {
            desk.actions.push(Action::Do(command));
        }
    };
    match item {
        Item::ToneMap => {
            let mut curve = desk.document.view.tone_map;
            if widgets::choice_menu(ui, "Tone map", &mut curve, &widgets::choices()) {
                desk.document.view.tone_map = curve;
                desk.edits.note("Tone map", "view.tone_map");
            }
        }
        Item::Resolution => {
            let resolution = &mut desk.shared.viewing.resolution;
            widgets::choice_menu(ui, "Resolution", resolution, &widgets::choices());
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
        Item::Denoise => entry(ui, Command::Denoise),
        Item::Compare => entry(ui, Command::Compare),
        Item::Pause => entry(ui, Command::Pause),
    }
}
