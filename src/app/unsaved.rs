//! The question before unsaved edits would be lost: save, discard, or cancel, which leaves everything as it is.

use std::path::PathBuf;

use egui::{Ui, ViewportCommand};

use super::App;
use super::actions::Command;
use super::{theme, widgets};
use crate::document::Document;
use crate::render::worker::Level;
use crate::store::Loaded;

/// What would lose the edits.
pub(super) enum Then {
    /// The window is closed.
    Close,
    /// A new document.
    New,
    /// A project that has been read from a file.
    Adopt(Box<Loaded<Document>>, PathBuf),
}

impl Then {
    fn verb(&self) -> &'static str {
        match self {
            Self::Close => "closing",
            Self::New => "starting anew",
            Self::Adopt(..) => "opening another project",
        }
    }
}

/// The question that is open, and what waits for a file to be saved.
#[derive(Default)]
pub(super) struct Unsaved {
    question: Option<Question>,
    after_save: Option<Then>,
    /// Asked and answered: the window may go.
    may_close: bool,
}

struct Question {
    then: Then,
    is_new: bool,
}

enum Answer {
    Save,
    Discard,
    Cancel,
}

impl Unsaved {
    /// Whether an answer is waited for.
    pub(super) fn is_open(&self) -> bool {
        self.question.is_some()
    }
}

impl App {
    /// Does what replaces the document or closes the window; asks first where that would lose edits.
    pub(super) fn unless_unsaved(&mut self, ctx: &egui::Context, then: Then) {
        if self.edits.is_saved(&self.document) {
            self.go_on(ctx, then);
        } else {
            self.unsaved.question = Some(Question { then, is_new: true });
        }
    }

    fn go_on(&mut self, ctx: &egui::Context, then: Then) {
        match then {
            Then::Close => {
                self.unsaved.may_close = true;
                ctx.send_viewport_cmd(ViewportCommand::Close);
            }
            Then::New => self.start_anew(),
            Then::Adopt(loaded, path) => self.adopt_project(*loaded, path),
        }
    }

    /// Keeps the window open where edits or files being written would be lost with it.
    pub(super) fn guard_close(&mut self, ctx: &egui::Context) {
        let is_asked = ctx.input(|input| input.viewport().close_requested());
        if !is_asked || self.unsaved.may_close {
            return;
        }
        if self.files.is_saving() {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.unsaved.after_save = Some(Then::Close);
        } else if !self.edits.is_saved(&self.document) {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.unless_unsaved(ctx, Then::Close);
        }
    }

    /// Goes on with what waits for a file, once it is written; not where that failed or was cancelled.
    pub(super) fn go_on_after_save(&mut self, ctx: &egui::Context, has_failed: bool) {
        if has_failed {
            self.unsaved.after_save = None;
        }
        if self.files.is_saving() || self.dialogs.is_asking() {
            return;
        }
        // A dialog that was cancelled leaves the edits unsaved: cancel means cancel.
        if let Some(then) = self.unsaved.after_save.take()
            && self.edits.is_saved(&self.document)
        {
            self.go_on(ctx, then);
        }
    }

    /// Shows the question where there is one.
    pub(super) fn show_question(&mut self, ctx: &egui::Context) {
        let name = self.files.project_name();
        let Some(question) = &mut self.unsaved.question else {
            return;
        };
        let mut answer = None;
        let modal = egui::Modal::new(egui::Id::unique("unsaved")).show(ctx, |ui| {
            answer = question.show(ui, &name);
        });
        if modal.should_close() {
            answer = Some(Answer::Cancel);
        }
        let Some(answer) = answer else {
            return;
        };
        let Some(Question { then, .. }) = self.unsaved.question.take() else {
            return;
        };
        match answer {
            Answer::Cancel => {}
            Answer::Discard => self.go_on(ctx, then),
            Answer::Save => {
                if self.dialogs.is_asking() {
                    self.say(
                        Level::Warning,
                        "a file is being chosen already: choose or cancel it first",
                    );
                } else {
                    self.unsaved.after_save = Some(then);
                    self.file_command(ctx, Command::Save);
                }
            }
        }
    }
}

impl Question {
    fn show(&mut self, ui: &mut Ui, name: &str) -> Option<Answer> {
        ui.set_width(380.0);
        ui.heading(format!("Save the changes to {name}?"));
        widgets::note(
            ui,
            format!("They would be lost by {}. Escape cancels.", self.then.verb()),
        );
        ui.add_space(theme::GAP);
        let mut answer = None;
        ui.horizontal(|ui| {
            let save = ui.button("Save");
            // The focus lasts only once the sheet has been laid out.
            if save.has_focus() {
                self.is_new = false;
            } else if self.is_new {
                save.request_focus();
            }
            if save.clicked() {
                answer = Some(Answer::Save);
            }
            if ui.button("Discard").clicked() {
                answer = Some(Answer::Discard);
            }
            if ui.button("Cancel").clicked() {
                answer = Some(Answer::Cancel);
            }
        });
        answer
    }
}
