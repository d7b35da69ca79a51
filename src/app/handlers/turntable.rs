//! What the window does about turntables.

use std::path::Path;
use std::time::{Duration, Instant};

use crate::app::App;
use crate::app::book::TURNTABLE;
use crate::app::kit::theme;
use crate::app::services::viewing::Resolution;
use crate::app::sheets::book;
use crate::app::sheets::turntable::{Preview, SIZE};
use crate::document::Document;
use crate::document::turntable::turned_by;
use crate::render::queue::Task;

/// How long a turn takes in the viewport.
const PREVIEW_TURN: Duration = Duration::from_secs(12);
/// Between two images of it.
const PREVIEW_STEP: Duration = Duration::from_millis(33);

impl App {
    /// Opens the sheet, with the size of the image as it is.
    pub fn open_turntable(&mut self) {
        let project = self.files.project.as_deref().and_then(Path::parent);
        let beside = project.or(self.dialogs.folder()).unwrap_or(Path::new(""));
        // Nothing but a place to begin with: where there is no working folder a path can be typed.
        let folder = std::path::absolute(beside.join("turntable")).unwrap_or_default();
        let render = self
            .submitted
            .as_ref()
            .map_or(&self.document.render, |submitted| &submitted.render);
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

    /// Begins a turn in the viewport, or ends it.
    pub fn toggle_preview(&mut self) {
        let camera = self.document.camera;
        let since = Instant::now();
        let preview = &mut self.turntable.preview;
        *preview = preview.is_none().then_some(Preview { since, camera });
    }

    /// The document as the viewport shows it, and whether that turns.
    pub fn document_shown(&mut self, ctx: &egui::Context) -> (Document, bool) {
        let is_called_off = !self.is_covered() && ctx.input(|input| input.key_pressed(egui::Key::Escape));
        let is_over = |preview: &Preview| is_called_off || preview.camera != self.document.camera;
        if self.turntable.preview.as_ref().is_some_and(is_over) {
            self.turntable.preview = None;
        }
        let snapshot = self.worker.snapshot();
        let (Some(preview), Some(scene)) = (&self.turntable.preview, &snapshot.scene) else {
            return (self.document.clone(), false);
        };
        ctx.request_repaint_after(PREVIEW_STEP);
        let angle_deg = 360.0 * preview.since.elapsed().as_secs_f64() / PREVIEW_TURN.as_secs_f64();
        let center_world = scene.job.geometry.center_world.to_array();
        let turned = turned_by(&self.document, self.turntable.turn, angle_deg, center_world);
        (turned, true)
    }

    /// Shows the sheet where it is open.
    pub fn show_turntable(&mut self, ctx: &egui::Context) {
        if !self.turntable.is_open {
            return;
        }
        let mut begins = false;
        let speed = self.worker.snapshot().samples_per_second;
        let sheet = &mut self.turntable;
        let modal = egui::Modal::new(egui::Id::unique("turntable")).show(ctx, |ui| {
            ui.set_width(440.0);
            book::heading(ui, "Turntable", TURNTABLE);
            ui.add_space(theme::GAP);
            begins = sheet.settings(ui, speed);
        });
        if modal.should_close() || begins {
            sheet.is_open = false;
        }
        if begins {
            let table = self.turntable.order(&self.document);
            self.enqueue(Task::Turntable(Box::new(table)));
        }
    }
}
