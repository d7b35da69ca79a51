//! What the window does about edits that a crash left.

use crate::app::App;
use crate::app::services::autosave::{self, Leftover};
use crate::app::sheets::recovery::{Choice, name, sheet};
use crate::render::worker::Level;

impl App {
    /// Takes the reports of the thread that saves documents for recovery.
    pub fn take_autosave_reports(&mut self) {
        for text in self.autosave.witness.take_reported() {
            self.report(Level::Error, text);
        }
        for report in self.autosave.take_reports() {
            match report {
                autosave::Report::Found(leftovers) => {
                    let documents = leftovers.iter().filter(|leftover| leftover.contents.is_some());
                    self.report(Level::Info, format!("unsaved documents found: {}", documents.count()));
                    self.leftovers = leftovers;
                }
                autosave::Report::Failed(error) => {
                    self.report(
                        Level::Warning,
                        format!("unsaved edits are not kept for a crash: {error}"),
                    );
                }
            }
        }
    }

    /// Shows the sheet as long as there is something to choose.
    pub fn show_recovery(&mut self, ctx: &egui::Context) {
        if self.leftovers.is_empty() {
            return;
        }
        let mut chosen = None;
        let modal = egui::Modal::new(egui::Id::unique("recovery")).show(ctx, |ui| {
            chosen = sheet(ui, &self.leftovers);
        });
        if let Some((at, choice)) = chosen {
            let leftover = self.leftovers.remove(at);
            match choice {
                Choice::Discard => self.autosave.discard(leftover.index),
                Choice::Restore => self.restore(leftover),
            }
        } else if modal.should_close() {
            self.leave_leftovers();
        }
    }

    fn restore(&mut self, leftover: Leftover) {
        let Some(Ok(recovered)) = leftover.contents else {
            return;
        };
        for warning in &recovered.warnings {
            self.report(Level::Warning, warning.clone());
        }
        let name = name(&recovered);
        self.document = recovered.document;
        self.shared.selection.slot = 0;
        self.files.project = recovered.project;
        self.edits.note(format!("Restore {name}"), "");
        self.edits.record(&self.document, false);
        self.edits.mark_unsaved();
        self.autosave.keep(&self.document, self.files.project.as_deref());
        self.autosave.discard(leftover.index);
        self.report(Level::Info, format!("restored {name}; it has not been saved yet"));
        self.leave_leftovers();
    }

    /// What was not chosen stays for the next start.
    fn leave_leftovers(&mut self) {
        if !self.leftovers.is_empty() {
            let count = self.leftovers.len();
            self.report(
                Level::Info,
                format!("unsaved documents left for the next start: {count}"),
            );
            self.leftovers.clear();
        }
    }
}
