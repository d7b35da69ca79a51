//! The bar over the picture: what is looked at, in which light, and how it is shown.

use egui::{Align, Layout, Rect, Ui, UiBuilder, vec2};

use crate::app::actions::{Action, Command, do_and_close};
use crate::app::desk::{Desk, RESOLUTIONS};
use crate::app::kit::icons::{self, Icon};
use crate::app::kit::widgets;
use crate::app::services::environments;
use crate::render::display::Shown;
use crate::scene::ModelSource;

/// From this width on there is room for more than model and environment, points.
const WIDE: f32 = 650.0;
/// Width of the tone map's menu, points.
const TONE_MAP: f32 = 116.0;

/// The models that come with the program.
const MODELS: [(&str, ModelSource); 4] = [
    ("Teapot", ModelSource::Teapot),
    ("Sphere", ModelSource::Sphere),
    ("Plane", ModelSource::Plane),
    ("Shader ball", ModelSource::Shaderball),
];

fn model_label(source: &ModelSource) -> String {
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

pub(super) fn show(ui: &mut Ui, bar: Rect, desk: &mut Desk<'_>) {
    ui.painter().rect_filled(bar, 0.0, ui.visuals().panel_fill);
    let inside = bar.shrink2(vec2(8.0, 0.0));
    let builder = UiBuilder::new()
        .max_rect(inside)
        .layout(Layout::left_to_right(Align::Center));
    let mut ui = ui.new_child(builder);
    ui.set_clip_rect(bar.intersect(ui.clip_rect()));
    // Narrow viewports keep what is looked at and give up the rest.
    let is_wide = bar.width() > WIDE;
    let has_tone_map = bar.width() > WIDE + TONE_MAP;
    models(&mut ui, desk);
    environments(&mut ui, desk);
    if is_wide {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| shown(ui, desk, has_tone_map));
    }
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
        .selected_text(environments::environment_label(&current));
    let shown = combo.show_ui(ui, |ui| {
        for (label, help, source) in &environments::BUILT_IN {
            if ui
                .selectable_label(current == *source, *label)
                .on_hover_text(*help)
                .clicked()
            {
                do_and_close(ui, desk.actions, Action::UseEnvironment(source.clone()));
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

/// Added from the right.
fn shown(ui: &mut Ui, desk: &mut Desk<'_>, has_tone_map: bool) {
    let is_paused = desk.shared.is_paused;
    let (icon, help) = if is_paused {
        (Icon::Play, "Go on (space)")
    } else {
        (Icon::Pause, "Pause (space)")
    };
    if icons::button(ui, icon, Command::Pause.label(), help).clicked() {
        desk.act(Command::Pause);
    }
    sized(ui, 84.0, |ui| {
        let response = widgets::choice(ui, "header shown", &mut desk.shared.shown, &Shown::ALL);
        if response.changed() {
            desk.actions.push(Action::Show(desk.shared.shown));
        }
        response
            .accessible_name("Viewport shows")
            .on_hover_text("Picture, error, samples or precision");
    });
    let compares = ui.selectable_label(desk.shared.compare.is_on, "A | B");
    let compares = compares.on_hover_text("Compare with another material or lobe (C)");
    if compares.clicked() {
        desk.act(Command::Compare);
    }
    compares.accessible_name("Compare");
    sized(ui, 104.0, |ui| {
        let response = widgets::choice(ui, "header size", &mut desk.shared.resolution, &RESOLUTIONS);
        response
            .accessible_name("Resolution")
            .on_hover_text("Size of the picture");
    });
    sized(ui, 76.0, |ui| {
        desk.setting_control(ui, "view.exposure", "Viewport exposure")
    });
    if has_tone_map {
        sized(ui, TONE_MAP, |ui| {
            desk.setting_control(ui, "view.tone_map", "Viewport tone map")
        });
    }
}

pub(super) fn sized(ui: &mut Ui, width: f32, add: impl FnOnce(&mut Ui)) {
    let layout = Layout::left_to_right(Align::Center);
    ui.allocate_ui_with_layout(vec2(width, crate::app::kit::theme::ROW_HEIGHT), layout, add);
}
