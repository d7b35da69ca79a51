//! The sheet about the model's file: which of its images is shown, and what became of its parts.

use super::*;
use crate::{
    book::MODEL_FILE,
    document::{ImportLobe, of_model::import_report},
    scene::{Fate, ImportReport, Model, ModelOptions},
    sheets::{book, scrolled},
};

/// Shows the sheet of a model. What is chosen is asked for as an action; true where the sheet is done with.
pub fn show(
    ui: &mut Ui,
    document: &Document,
    (model, lobe): (Option<&Model>, ImportLobe),
    actions: &mut Vec<Action>,
) -> bool {
    ui.set_width(560.0);
    let mut is_done = false;
    ui.horizontal(|ui| {
        book::heading(ui, "Model file", MODEL_FILE);
        // Above what comes and goes, so that it stays where it is.
        widgets::at_right(ui, |ui| is_done = ui.button("Close").clicked());
    });
    ui.label(document.model.to_string());
    let Some(model) = model else {
        widgets::note(ui, "The model is being loaded.");
        return is_done;
    };
    ui.add_space(theme::GAP);
    let mut options = document.import.clone();
    choices(ui, model, &mut options);
    if options != document.import {
        actions.push(Action::ImportModel(document.model.clone(), options));
    }
    ui.add_space(theme::GAP);
    entries(ui, &import_report(model, lobe));
    is_done
}

/// Scene, variant and pose, where the file has more than one.
fn choices(ui: &mut Ui, model: &Model, options: &mut ModelOptions) {
    if model.scenes.len() > 1 {
        let scenes = model.scenes.iter().enumerate();
        choice(
            ui,
            "Scene",
            &mut options.scene,
            scenes.map(|(index, name)| (index, name.as_str())),
        );
    }
    if !model.variants.is_empty() {
        let variants = model.variants.iter().map(|name| (name.clone(), name.as_str()));
        choice(ui, "Variant", &mut options.variant, variants);
    }
    if model.duration_s > 0.0 {
        let mut is_posed = options.time_s.is_some();
        ui.horizontal(|ui| {
            ui.checkbox(&mut is_posed, "Pose of the animation at");
            let mut time_s = options.time_s.unwrap_or(0.0);
            let slider = Slider::new(&mut time_s, 0.0..=model.duration_s).suffix(" s");
            // Loading takes a moment: the pose follows when the slider is let go of.
            let response = ui.add_enabled(is_posed, slider);
            let response = response.accessible_name("Time of the pose");
            let draft = response.id.with("draft");
            if response.dragged() {
                ui.data_mut(|data| data.insert_temp(draft, time_s));
            } else if response.drag_stopped() || response.changed() {
                let drafted = ui.data_mut(|data| data.remove_temp::<f32>(draft));
                options.time_s = Some(drafted.unwrap_or(time_s));
            }
        });
        if is_posed != options.time_s.is_some() {
            options.time_s = is_posed.then_some(0.0);
        }
    }
}

/// One of several by name, or what the file chooses.
fn choice<'a, T: PartialEq + Clone>(
    ui: &mut Ui,
    label: &str,
    chosen: &mut Option<T>,
    all: impl Iterator<Item = (T, &'a str)>,
) {
    let own = (None, "the file's own", "");
    let all = all.map(|(value, name)| (Some(value), name, ""));
    let all: Vec<_> = std::iter::once(own).chain(all).collect();
    widgets::row(ui, [label, label, ""], |ui| widgets::choice(ui, label, chosen, &all));
}

/// What became of the parts of the file, what is amiss first.
fn entries(ui: &mut Ui, report: &ImportReport) {
    if report.entries.is_empty() {
        widgets::note(ui, "Built-in model: no import report.");
        return;
    }
    scrolled(ui, |ui| {
        for &fate in Fate::ALL.iter().rev() {
            let mut entries = report.of(fate).peekable();
            if entries.peek().is_none() {
                continue;
            }
            ui.add_space(4.0);
            ui.label(RichText::new(fate.label()).strong());
            for entry in entries {
                let mut text = format!("{}: {}", entry.what, entry.count);
                if !entry.names.is_empty() {
                    text += &format!(" ({})", entry.names.join(", "));
                }
                ui.add(Label::new(text).wrap());
            }
        }
    });
}
