//! What the window does about files for other programs.

use std::path::PathBuf;

use crate::app::App;
use crate::app::services::disk::Done;
use crate::app::services::export::{Ready, ready};
use crate::app::services::messages::Success;
use crate::app::sheets::dialogs::Purpose;
use crate::app::sheets::export::Answer;
use crate::document::MaterialSettings;
use crate::render::worker::Level;
use crate::store::exchange::report::Outcome;
use crate::store::exchange::{self, Registered, Subject};
use crate::store::preset;

impl App {
    /// Asks for the file that a preset is exported to, or the selected material.
    pub fn ask_export(&mut self, ctx: &egui::Context, preset: Option<MaterialSettings>) {
        let material = preset.clone().unwrap_or_else(|| self.desk_material());
        let name = format!("{}.mtlx", preset::command_line_name(&material.name));
        self.files.exported = preset;
        self.dialogs.ask(Purpose::Export, name, ctx);
    }

    /// Makes the file beside the window, to be shown before it is written: of a format that takes a model all of it, else
    /// the selected material; or the preset that was chosen.
    pub fn prepare_export(&mut self, path: PathBuf) {
        let format = match exchange::by_ending(&path) {
            Ok(format) => format,
            Err(error) => return self.report(Level::Error, error.to_string()),
        };
        let preset = self.files.exported.take();
        let takes_model = format.format.takes_models() && preset.is_none();
        let material = preset.unwrap_or_else(|| self.desk_material());
        let name = material.name.clone();
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        self.report(Level::Info, format!("{file}: rendering balls to show what it loses …"));
        let subject = if takes_model {
            Subject {
                materials: self.document.materials.clone(),
                document: Some(Box::new(self.document.clone())),
                losses: Vec::new(),
            }
        } else {
            Subject::of(material)
        };
        self.files
            .disk
            .open_beside(move || Done::Prepared(Box::new(ready(&subject, &name, &path, format))));
    }

    /// Makes the text of a material in a format beside the window, for the clipboard.
    pub fn copy_as(&mut self, material: MaterialSettings, format: &str) {
        let Some(format) = exchange::by_name(format) else {
            return;
        };
        self.files
            .disk
            .open_beside(move || Done::Copied(as_text(material, format)));
    }

    /// Puts a text that is ready on the clipboard.
    pub fn take_copied(&mut self, ctx: &egui::Context, copied: Result<(String, Success), String>) {
        match copied {
            Ok((text, done)) => {
                ctx.copy_text(text);
                self.report_success(Some(done));
            }
            Err(error) => self.report(Level::Error, error),
        }
    }

    /// Shows what is lost, and writes where that was agreed to.
    pub fn show_export(&mut self, ctx: &egui::Context) {
        let Some(answer) = self.export.show(ctx) else { return };
        let prepared = self.export.take();
        let Some(prepared) = prepared.filter(|_| answer == Answer::Write) else {
            return;
        };
        self.files.disk.write(move || {
            let saved = prepared.save().map_err(crate::in_words);
            Done::Wrote(saved.map(|()| Success::with_file("Exported", &prepared.report.output, "")))
        });
    }

    /// Takes a file that is ready.
    pub fn take_prepared(&mut self, ctx: &egui::Context, ready: Result<Ready, String>) {
        match ready {
            Ok(ready) => self.export.ask(ctx, ready),
            Err(error) => self.report(Level::Error, error),
        }
    }
}

/// A material as a format's text, and what to say about it.
fn as_text(material: MaterialSettings, format: &Registered) -> Result<(String, Success), String> {
    let name = material.name.clone();
    let path = PathBuf::from(&name).with_extension(format.extensions[0]);
    let prepared = exchange::prepare(&Subject::of(material), &name, &path, format).map_err(crate::in_words)?;
    let count = |outcome: Outcome| prepared.report.count(outcome);
    let words = match [count(Outcome::Approximated), count(Outcome::Dropped)] {
        [0, 0] => format!("Copied {name}: {}, nothing is lost", format.label),
        [near, gone] => format!("Copied {name}: {}, {near} approximated, {gone} dropped", format.label),
    };
    let text = prepared.text().ok_or("this format is no text; export it to a file")?;
    Ok((text.to_owned(), Success::new(words)))
}
