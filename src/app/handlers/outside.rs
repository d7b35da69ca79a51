//! What the window does about files that others name outside of their surroundings.

use std::path::{Path, PathBuf};

use crate::app::App;
use crate::app::sheets::question;
use crate::import::resource;

impl App {
    /// Asks about files that a file names, which is opened again once they are allowed.
    pub fn ask_about(&mut self, path: &Path, files: Vec<PathBuf>) {
        if !files.is_empty() {
            self.unsaved.outside.ask(files);
            self.unsaved.outside.named_by = Some(path.to_owned());
        }
    }

    /// Asks once for all that was refused; what is allowed is remembered, and read.
    pub fn show_outside(&mut self, ctx: &egui::Context) {
        let outside = &mut self.unsaved.outside;
        outside.ask(self.worker.loading().take_refused());
        if outside.files.is_empty() {
            outside.named_by = None;
            return;
        }
        let Some(is_allowed) = question(ctx, "outside", false, |ui| outside.show(ui)) else {
            return;
        };
        let files = std::mem::take(&mut outside.files);
        let named_by = outside.named_by.take();
        if !is_allowed {
            outside.denied.extend(files);
            return;
        }
        resource::allow(&files);
        match named_by {
            Some(path) => {
                self.open(path);
            }
            None => self.worker.reload(),
        }
    }
}
