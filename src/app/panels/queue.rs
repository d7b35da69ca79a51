//! Renders that go on beside the window: what waits, how far it is, and what came of it.

use egui::{Align, Layout, RichText, Ui};

use super::Panel;
use crate::app::actions::Command;
use crate::app::desk::Desk;
use crate::app::kit::{theme, widgets};
use crate::render::queue::{Entry, State};

/// The renders beside the window.
#[derive(Default)]
pub struct QueuePanel;

impl Panel for QueuePanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        ui.horizontal_wrapped(|ui| {
            for command in [Command::QueuePicture, Command::Turntable] {
                desk.button(ui, command);
            }
        });
        let queue = &desk.shared.queue;
        let entries = queue.entries();
        ui.horizontal_wrapped(|ui| {
            let mut is_paused = queue.is_paused();
            let help = "What is being rendered stays where it is, until this is switched off.";
            if ui
                .checkbox(&mut is_paused, "Pause the queue")
                .on_hover_text(help)
                .changed()
            {
                queue.pause(is_paused);
            }
            let clear = egui::Button::new("Clear finished");
            if ui.add_enabled(entries.iter().any(Entry::is_over), clear).clicked() {
                queue.remove_over();
            }
        });
        ui.add_space(theme::GAP);
        if entries.is_empty() {
            widgets::note(
                ui,
                "Images and turntables are rendered here one after the other, while you go on editing: what you change \
                 afterwards does not change them.",
            );
        }
        let first = entries.iter().position(|entry| entry.state == State::Waiting);
        for (index, entry) in entries.iter().enumerate() {
            let can_be_first = entry.state == State::Waiting && first.is_some_and(|first| first < index);
            // By its number: those above come to their ends and go.
            let id = egui::Id::unique(("queue", entry.id));
            let apart = egui::UiBuilder::new().scope_id(id);
            ui.scope_builder(apart, |ui| row(ui, desk, entry, can_be_first));
        }
    }
}

/// A task: its name with what can be done with it, and how it stands.
fn row(ui: &mut Ui, desk: &Desk<'_>, entry: &Entry, can_be_first: bool) {
    let queue = &desk.shared.queue;
    let name = &entry.name;
    ui.horizontal(|ui| {
        widgets::at_right(ui, |ui| {
            let word = if entry.is_over() { "Remove" } else { "Cancel" };
            if ui.button(word).accessible_name(format!("{word} {name}")).clicked() {
                queue.remove(entry.id);
            }
            if entry.state == State::Waiting {
                let button = ui.add_enabled(can_be_first, egui::Button::new("Next"));
                let button = button.accessible_name(format!("Next {name}"));
                if button
                    .on_hover_text("Renders it before all others that wait.")
                    .clicked()
                {
                    queue.put_first(entry.id);
                }
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.add(egui::Label::new(RichText::new(name).strong()).truncate());
            });
        });
    });
    match &entry.state {
        State::Waiting => widgets::note(ui, "waiting"),
        State::Rendering(share) => {
            let bar = ui.add(egui::ProgressBar::new(*share as f32).show_percentage());
            bar.accessible_name(format!("Progress of {name}"));
        }
        State::Done(words) | State::Cancelled(words) => widgets::note(ui, words),
        State::Failed(why) => {
            ui.add(egui::Label::new(RichText::new(why).color(ui.visuals().error_fg_color)).wrap());
        }
    }
    ui.add_space(theme::GAP);
}
