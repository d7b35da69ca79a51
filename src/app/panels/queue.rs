//! Renders that go on beside the window: what waits, how far it is, and what came of it.

use super::*;
use crate::kit::words::time_left;
use crate::render::queue::{QueuedTask, TaskState};

/// The renders beside the window.
#[derive(Default)]
pub struct QueuePanel;

impl Panel for QueuePanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk) {
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
            let pause = ui.checkbox(&mut is_paused, "Pause the queue");
            if pause.on_hover_text(help).changed() {
                queue.pause(is_paused);
            }
            if widgets::pressed_if(ui, entries.iter().any(QueuedTask::is_over), "Clear finished", "", "") {
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
        let first = entries.iter().position(|entry| entry.state == TaskState::Waiting);
        for (index, entry) in entries.iter().enumerate() {
            let can_be_first = entry.state == TaskState::Waiting && first.is_some_and(|first| first < index);
            // By its number: those above come to their ends and go.
            widgets::known_by(ui, ("queue", entry.id), |ui| row(ui, desk, entry, can_be_first));
        }
    }
}

/// A task: its name with what can be done with it, and how it stands.
fn row(ui: &mut Ui, desk: &Desk, entry: &QueuedTask, can_be_first: bool) {
    let queue = &desk.shared.queue;
    let name = &entry.name;
    ui.horizontal(|ui| {
        widgets::at_right(ui, |ui| {
            let word = if entry.is_over() { "Remove" } else { "Cancel" };
            if ui.button(word).accessible_name(format!("{word} {name}")).clicked() {
                queue.remove(entry.id);
            }
            if entry.state == TaskState::Waiting {
                let button = ui.add_enabled(can_be_first, Button::new("Next"));
                let button = button.accessible_name(format!("Next {name}"));
                let help = "Renders it before all others that wait.";
                if button.on_hover_text(help).clicked() {
                    queue.put_first(entry.id);
                }
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                widgets::line(ui, RichText::new(name).strong());
            });
        });
    });
    match &entry.state {
        TaskState::Waiting => widgets::note(ui, "waiting"),
        TaskState::Rendering(share) => {
            let bar = ui.add(ProgressBar::new(*share as f32).show_percentage());
            bar.accessible_name(format!("Progress of {name}"));
            let left = time_left(*share, entry.since.elapsed().as_secs_f64());
            left.into_iter().for_each(|left| widgets::note(ui, left));
        }
        TaskState::Done(words) | TaskState::Cancelled(words) => widgets::note(ui, words),
        TaskState::Failed(why) => widgets::failure(ui, why.clone()),
    }
    ui.add_space(theme::GAP);
}
