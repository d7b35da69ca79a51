//! The sheet about the model's file: which of its images is shown, and what became of its parts.

use egui::{RichText, Ui};

use crate::app::actions::Action;
use crate::app::book::MODEL_FILE;
use crate::app::kit::{theme, widgets};
use crate::app::sheets::{book, scrolled};
use crate::document::of_model::import_report;
use crate::document::{Document, ImportLobe};
use crate::scene::{Fate, ImportReport, Model, ModelOptions};

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
        let shown = options.scene.and_then(|scene| model.scenes.get(scene));
        let combo = egui::ComboBox::from_label("Scene").selected_text(shown.map_or("the file's own", String::as_str));
        combo.show_ui(ui, |ui| {
            ui.selectable_value(&mut options.scene, None, "the file's own");
            for (index, name) in model.scenes.iter().enumerate() {
                ui.selectable_value(&mut options.scene, Some(index), name);
            }
        });
    }
    if !model.variants.is_empty() {
        let shown = options.variant.clone().unwrap_or_else(|| "the file's own".to_owned());
        egui::ComboBox::from_label("Variant")
            .selected_text(shown)
            .show_ui(ui, |ui| {
                ui.selectable_value(&mut options.variant, None, "the file's own");
                for name in &model.variants {
                    ui.selectable_value(&mut options.variant, Some(name.clone()), name);
                }
            });
    }
    if model.duration_s > 0.0 {
        let mut is_posed = options.time_s.is_some();
        ui.horizontal(|ui| {
            ui.checkbox(&mut is_posed, "Pose of the animation at");
            let mut time_s = options.time_s.unwrap_or(0.0);
            let slider = egui::Slider::new(&mut time_s, 0.0..=model.duration_s).suffix(" s");
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
            ui.label(RichText::new(capital(fate.label())).strong());
            egui::Grid::new(fate.label())
                .num_columns(2)
                .spacing([12.0, 3.0])
                .show(ui, |ui| {
                    for entry in entries {
                        ui.label(format!("{} ×", entry.count));
                        let names = entry.names.join(", ");
                        let text = if names.is_empty() {
                            entry.what.clone()
                        } else {
                            format!("{}: {names}", entry.what)
                        };
                        ui.add(egui::Label::new(text).wrap());
                        ui.end_row();
                    }
                });
        }
    });
}

/// With a capital first letter.
fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
