//! What the window does about renders beside it.

use std::path::PathBuf;

use egui::ViewportCommand;

use crate::app::App;
use crate::app::kit::{theme, widgets};
use crate::app::layout::Pane;
use crate::app::services::messages::Success;
use crate::render::EngineChoice;
use crate::render::queue::Task;

impl App {
    /// Has a task rendered by the engine that renders the viewport, and shows the queue.
    pub fn enqueue(&mut self, task: Task) {
        let kind = self.worker.snapshot().engine.as_ref().map(|engine| engine.kind);
        let engine = kind.map_or(EngineChoice::Cpu, EngineChoice::from);
        self.shared.queue.add(task, engine);
        self.reveal(Pane::Queue);
    }

    /// Has the document rendered as it is, with its own image size.
    pub fn enqueue_picture(&mut self, path: PathBuf) {
        let document = Box::new(self.document.clone());
        self.enqueue(Task::Picture { document, path });
    }

    /// Says how tasks ended.
    pub fn take_queue_news(&mut self) {
        for ended in self.shared.queue.take_news() {
            self.report_outcome(ended.map(Success::new));
        }
    }

    /// Asks before the window is closed over renders that are not done.
    pub fn show_queue_question(&mut self, ctx: &egui::Context) {
        if !self.unsaved.asks_about_queue {
            return;
        }
        let modal = egui::Modal::new(egui::Id::unique("queue question")).show(ctx, |ui| {
            ui.set_width(380.0);
            ui.heading("Renders are still queued");
            widgets::note(ui, "Closing cancels them. Esc keeps rendering.");
            ui.add_space(theme::GAP);
            ui.horizontal(|ui| {
                if ui.button("Keep rendering").clicked() {
                    ui.close();
                }
                if ui.button("Close anyway").clicked() {
                    self.unsaved.gives_queue_up = true;
                    ui.ctx().send_viewport_cmd(ViewportCommand::Close);
                    ui.close();
                }
            });
        });
        if modal.should_close() {
            self.unsaved.asks_about_queue = false;
        }
    }
}
