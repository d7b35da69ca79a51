//! What lies over the window: questions before edits or renders are lost, what a crash left, turntables, the manual.

use std::{path::Path, time::Duration};

use egui::{Context, Order, Pos2, ViewportCommand};

use crate::{
    App,
    book::{CONTENTS, EXPLAIN, EXPORT, KEYS, MODEL_FILE, TURNTABLE, UNSAVED},
    document::{Document, turntable::turned_by},
    kit::{theme, widgets},
    layout,
    layout::Pane,
    render::{EngineChoice, queue::Task},
    services::{autosave::Leftover, viewing::Resolution},
    sheets::{
        self, answers, book,
        menu::Sheet,
        recovery::{Choice, name, sheet},
        turntable::{Preview, SIZE},
        unsaved::{Answer, Question, Then},
    },
};

/// How long a turn takes in the viewport.
const PREVIEW_TURN: Duration = Duration::from_secs(12);
/// Between two images of it.
const PREVIEW_STEP: Duration = Duration::from_millis(33);

impl App {
    /// Does what replaces the document or closes the window; asks first where that would lose edits.
    pub fn unless_unsaved(&mut self, ctx: &Context, then: Then) {
        if self.edits.is_saved(&self.document) {
            self.go_on(ctx, then);
        } else {
            self.unsaved.question = Some(Question { then, is_new: true });
        }
    }

    fn go_on(&mut self, ctx: &Context, then: Then) {
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
    pub fn guard_close(&mut self, ctx: &Context) {
        let is_asked = ctx.input(|input| input.viewport().close_requested());
        if !is_asked || self.unsaved.may_close {
            return;
        }
        if self.shared.queue.is_busy() && !self.unsaved.gives_queue_up {
            self.unsaved.asks_about_queue = true;
        } else if self.files.is_saving() {
            self.unsaved.after_save = Some(Then::Close);
        } else if !self.edits.is_saved(&self.document) {
            self.unless_unsaved(ctx, Then::Close);
        } else {
            return;
        }
        ctx.send_viewport_cmd(ViewportCommand::CancelClose);
    }

    /// Goes on with what waits for a file, once it is written; not where that failed or was cancelled.
    pub fn go_on_after_save(&mut self, ctx: &Context, has_failed: bool) {
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
    pub fn show_question(&mut self, ctx: &Context) {
        self.show_outside(ctx);
        let name = self.files.project_name();
        let Some(question) = &mut self.unsaved.question else {
            return;
        };
        let answer = sheets::question(ctx, "unsaved", Answer::Cancel, |ui| question.show(ui, &name));
        let asked = self.unsaved.question.take_if(|_| answer.is_some());
        match (answer, asked) {
            (Some(Answer::Discard), Some(Question { then, .. })) => self.go_on(ctx, then),
            (Some(Answer::Save), _) if self.dialogs.is_asking() => {
                self.warn("a file is being chosen already: choose or cancel it first");
            }
            (Some(Answer::Save), Some(Question { then, .. })) => {
                self.unsaved.after_save = Some(then);
                self.save_or_ask(ctx);
            }
            _ => {}
        }
    }

    /// Takes the reports of the thread that saves documents for recovery.
    pub fn take_autosave_reports(&mut self) {
        let reported = std::mem::take(&mut self.autosave.witness.known().reported);
        reported.into_iter().for_each(|text| self.fail(text));
        for report in self.autosave.take_reports() {
            match report {
                Ok(leftovers) => {
                    let documents = leftovers.iter().filter(|leftover| leftover.contents.is_some());
                    self.note(format!("unsaved documents found: {}", documents.count()));
                    self.leftovers.extend(leftovers);
                }
                Err(error) => self.warn(format!("unsaved edits are not kept for a crash: {error}")),
            }
        }
    }

    /// Shows the sheet as long as there is something to choose.
    pub fn show_recovery(&mut self, ctx: &Context) {
        if self.leftovers.is_empty() {
            return;
        }
        match sheets::question(ctx, "recovery", Choice::Later, |ui| sheet(ui, &self.leftovers)) {
            Some(Choice::Discard(at)) => self.autosave.discard(self.leftovers.remove(at).index),
            Some(Choice::Restore(at)) => {
                let leftover = self.leftovers.remove(at);
                self.restore(leftover);
            }
            Some(Choice::Later) => self.leave_leftovers(),
            None => {}
        }
    }

    fn restore(&mut self, leftover: Leftover) {
        let Some(Ok(recovered)) = leftover.contents else {
            return;
        };
        let name = name(&recovered);
        self.report_all(recovered.warnings);
        self.files.project = recovered.project;
        self.replace_document(recovered.document, format!("Restore {name}"));
        self.edits.record(&self.document, false);
        self.edits.history.mark_unsaved();
        self.autosave.keep(&self.document, self.files.project.as_deref());
        self.autosave.discard(leftover.index);
        self.note(format!("restored {name}; it has not been saved yet"));
        self.leave_leftovers();
    }

    /// What was not chosen stays for the next start.
    fn leave_leftovers(&mut self) {
        if !self.leftovers.is_empty() {
            let count = self.leftovers.len();
            self.note(format!("unsaved documents left for the next start: {count}"));
            self.leftovers.clear();
        }
    }

    /// Has a task rendered by the engine that renders the viewport, and shows the queue.
    pub fn enqueue(&mut self, task: Task) {
        let kind = self.worker.snapshot().engine.as_ref().map(|engine| engine.kind);
        let engine = kind.map_or(EngineChoice::Cpu, EngineChoice::from);
        self.shared.queue.add(task, engine);
        self.reveal(Pane::Queue);
    }

    /// Asks before the window is closed over renders that are not done.
    pub fn show_queue_question(&mut self, ctx: &Context) {
        if !self.unsaved.asks_about_queue {
            return;
        }
        let closes = sheets::question(ctx, "queue question", false, |ui| {
            ui.set_width(380.0);
            ui.heading("Renders are still queued");
            widgets::note(ui, "Closing cancels them. Esc keeps rendering.");
            ui.add_space(theme::GAP);
            answers(ui, [("Keep rendering", false), ("Close anyway", true)])
        });
        self.unsaved.asks_about_queue = closes.is_none();
        if closes == Some(true) {
            self.unsaved.gives_queue_up = true;
            ctx.send_viewport_cmd(ViewportCommand::Close);
        }
    }

    /// Opens the sheet, with the size of the image as it is.
    pub fn open_turntable(&mut self) {
        let project = self.files.project.as_deref().and_then(Path::parent);
        let beside = project.or(self.dialogs.folder()).unwrap_or(Path::new(""));
        // Nothing but a place to begin with: where there is no working folder a path can be typed.
        let folder = std::path::absolute(beside.join("turntable")).unwrap_or_default();
        let render = &self.submitted.as_ref().unwrap_or(&self.document).render;
        let sheet = &mut self.turntable;
        sheet.is_open = true;
        // What fills the viewport has no size of its own.
        sheet.size = match self.shared.viewing.resolution {
            Resolution::Document => [render.width, render.height],
            _ => SIZE,
        };
        sheet.samples = render.samples.min(65536);
        if sheet.output.is_empty() {
            sheet.output = folder.display().to_string();
        }
    }

    /// The document as the viewport shows it, and whether that turns.
    pub fn document_shown(&mut self, ctx: &Context) -> (Document, bool) {
        let is_called_off = !self.is_covered() && ctx.input(|input| input.key_pressed(egui::Key::Escape));
        let is_over = |preview: &Preview| is_called_off || preview.camera != self.document.camera;
        if self.turntable.preview.as_ref().is_some_and(is_over) {
            self.turntable.preview = None;
        }
        let (Some(preview), Some(scene)) = (&self.turntable.preview, self.scene()) else {
            return (self.document.clone(), false);
        };
        ctx.request_repaint_after(PREVIEW_STEP);
        let angle_deg = 360.0 * preview.since.elapsed().as_secs_f64() / PREVIEW_TURN.as_secs_f64();
        let center_world = scene.job.geometry.center_world.to_array();
        let turned = turned_by(&self.document, self.turntable.turn, angle_deg, center_world);
        (turned, true)
    }

    /// Shows the sheet where it is open.
    pub fn show_turntable(&mut self, ctx: &Context) {
        if !self.turntable.is_open {
            return;
        }
        let snapshot = self.worker.snapshot();
        let sheet = &mut self.turntable;
        let begins = sheets::question(ctx, "turntable", false, |ui| {
            ui.set_width(440.0);
            book::heading(ui, "Turntable", TURNTABLE);
            ui.add_space(theme::GAP);
            sheet.settings(ui, &snapshot.progress)
        });
        sheet.is_open = begins.is_none();
        if begins == Some(true) {
            let table = self.turntable.order(&self.document);
            self.enqueue(Task::Turntable(Box::new(table)));
        }
    }

    /// The address in the book of what the user is at: the sheet that is open, the panel of the focused control, or the
    /// panel under the pointer.
    pub fn topic(&self, ctx: &Context) -> &'static str {
        let is_asked = self.unsaved.is_open() || !self.leftovers.is_empty();
        let is_searching = matches!(self.sheet, Sheet::Palette { .. } | Sheet::Shortcuts);
        let sheets = [
            (self.sheet == Sheet::ModelFile, MODEL_FILE),
            (matches!(self.sheet, Sheet::Path { .. }), EXPLAIN),
            (is_searching || self.dialogs.is_open(), KEYS),
            (self.export.is_open(), EXPORT),
            (self.turntable.is_open, TURNTABLE),
            (is_asked, UNSAVED),
        ];
        let open = sheets.into_iter().find(|(is_open, _)| *is_open);
        let pane = || layout::pane_at(&self.layout, self.looked_at(ctx)?);
        open.map_or_else(|| pane().map_or(CONTENTS, Pane::manual), |(_, address)| address)
    }

    /// The middle of the focused control, else the pointer; `None` over menus, which are no part of the panels below.
    fn looked_at(&self, ctx: &Context) -> Option<Pos2> {
        let focused = ctx.memory(|memory| memory.focused());
        let control = focused.filter(|id| Some(*id) != self.viewport.id());
        let control = control.and_then(|id| Some(ctx.read_response(id)?.rect.center()));
        let at = control.or(ctx.pointer_latest_pos())?;
        let is_panel = ctx.layer_id_at(at).is_none_or(|layer| layer.order == Order::Background);
        is_panel.then_some(at)
    }
}
