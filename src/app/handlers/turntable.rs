//! What the window does about turntables.

use std::path::Path;

use crate::app::App;
use crate::app::kit::theme;
use crate::app::services::disk::words;
use crate::app::sheets::turntable::Running;
use crate::render::EngineChoice;
use crate::render::worker::Level;

impl App {
    /// Opens the sheet, with the size of the picture as it is.
    pub(in crate::app) fn open_turntable(&mut self) {
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
        sheet.size = [render.width, render.height];
        sheet.samples = render.samples.min(65536);
        if sheet.folder.is_empty() {
            sheet.folder = folder.display().to_string();
        }
    }

    /// Shows the sheet where it is open, and says how the turntable ended.
    pub(in crate::app) fn show_turntable(&mut self, ctx: &egui::Context) {
        if let Some(done) = self.turntable.running.as_ref().and_then(Running::outcome) {
            self.turntable.running = None;
            let (level, text) = words(done);
            self.say(level, text);
        }
        if !self.turntable.is_open {
            return;
        }
        let mut begins = false;
        let sheet = &mut self.turntable;
        let modal = egui::Modal::new(egui::Id::unique("turntable")).show(ctx, |ui| {
            ui.set_width(440.0);
            ui.heading("Turntable");
            ui.add_space(theme::GAP);
            match &sheet.running {
                Some(running) => running.show(ui),
                None => begins = sheet.settings(ui),
            }
        });
        if modal.should_close() {
            sheet.is_open = false;
        }
        if begins {
            let kind = self.worker.snapshot().engine.as_ref().map(|engine| engine.kind);
            let engine = kind.map_or(EngineChoice::Cpu, EngineChoice::from);
            let table = self.turntable.order(&self.document);
            match Running::begin(ctx, table, engine) {
                Ok(running) => self.turntable.running = Some(running),
                Err(error) => self.say(Level::Error, format!("cannot start a thread to render: {error}")),
            }
        }
    }
}
