//! What the window does before unsaved edits would be lost.

use egui::ViewportCommand;

use crate::app::App;
use crate::app::actions::Command;
use crate::app::sheets;
use crate::app::sheets::unsaved::{Answer, Question, Then};
use crate::render::worker::Level;

impl App {
    /// Does what replaces the document or closes the window; asks first where that would lose edits.
    pub fn unless_unsaved(&mut self, ctx: &egui::Context, then: Then) {
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

    /// Keeps the window open where edits, files being written or renders would be lost with it.
    pub fn guard_close(&mut self, ctx: &egui::Context) {
        let is_asked = ctx.input(|input| input.viewport().close_requested());
        if !is_asked || self.unsaved.may_close {
            return;
        }
        if self.shared.queue.is_busy() && !self.unsaved.gives_queue_up {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.unsaved.asks_about_queue = true;
        } else if self.files.is_saving() {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.unsaved.after_save = Some(Then::Close);
        } else if !self.edits.is_saved(&self.document) {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.unless_unsaved(ctx, Then::Close);
        }
    }

    /// Goes on with what waits for a file, once it is written; not where that failed or was cancelled.
    pub fn go_on_after_save(&mut self, ctx: &egui::Context, has_failed: bool) {
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

    /// Shows the questions where there are any.
    pub fn show_question(&mut self, ctx: &egui::Context) {
        self.show_outside(ctx);
        let name = self.files.project_name();
        let Some(question) = &mut self.unsaved.question else {
            return;
        };
        let answer = sheets::question(ctx, "unsaved", Answer::Cancel, |ui| question.show(ui, &name));
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
                    self.report(
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
