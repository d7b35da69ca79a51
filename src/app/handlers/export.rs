//! What the window does about files for other programs.

use std::path::PathBuf;

use crate::app::App;
use crate::app::services::disk::Done;
use crate::app::services::export::{Ready, ready};
use crate::app::sheets::export::Answer;
use crate::render::worker::Level;
use crate::store::exchange::{self, Subject};

impl App {
    /// Makes the file beside the window, to be shown before it is written: of a format that takes a model all of it, else
    /// the selected material.
    pub(in crate::app) fn prepare_export(&mut self, path: PathBuf) {
        let format = match exchange::by_ending(&path) {
            Ok(format) => format,
            Err(error) => return self.say(Level::Error, error.to_string()),
        };
        let takes_model = exchange::takes_models(format);
        let subject = if takes_model {
            Subject {
                materials: self.document.materials.clone(),
                document: Some(Box::new(self.document.clone())),
                losses: Vec::new(),
            }
        } else {
            Subject::of(self.desk_material())
        };
        let name = self.desk_material().name;
        self.files
            .disk
            .open_beside(move || Done::Prepared(Box::new(ready(&subject, &name, &path, format))));
    }

    /// Shows what is lost, and writes where that was agreed to.
    pub(in crate::app) fn show_export(&mut self, ctx: &egui::Context) {
        let Some(answer) = self.export.show(ctx) else { return };
        let prepared = self.export.take();
        let Some(prepared) = prepared.filter(|_| answer == Answer::Write) else {
            return;
        };
        self.files.disk.write(move || {
            let saved = prepared.save().map_err(|error| error.to_string());
            Done::Wrote(saved.map(|()| format!("exported {}", prepared.report.output.display())))
        });
    }

    /// Takes a file that is ready.
    pub(in crate::app) fn take_prepared(&mut self, ctx: &egui::Context, ready: Result<Ready, String>) {
        match ready {
            Ok(ready) => self.export.ask(ctx, ready),
            Err(error) => self.say(Level::Error, error),
        }
    }
}
