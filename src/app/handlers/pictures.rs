//! The image, the window and materials as files or on the clipboard.

use std::{path::PathBuf, sync::Arc, sync::mpsc::channel, time::Duration};

use egui::ColorImage;

use crate::{
    App,
    document::MaterialSettings,
    handlers::files::finish,
    render::{output, worker::Activity, worker::Picture},
    services::{disk::Task, export::ready, messages::LogEntry},
    sheets::{dialogs::Purpose, export::Answer},
    store::{
        exchange::{self, Registered, Subject, report::Outcome},
        picture::png_bytes,
        replace::save_atomically,
    },
};

/// How long an image of the window may take to come.
const PATIENCE: Duration = Duration::from_secs(20);

/// An image that was asked for: as it was shown then, or as it has become since with nothing edited.
pub struct Asked {
    picture: Arc<Picture>,
    revision: u64,
}

impl Asked {
    fn is_whole(&self) -> bool {
        self.picture.revision == self.revision && self.picture.reduction == 1
    }
}

/// Where an image goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Destination {
    File(PathBuf),
    Clipboard,
}

impl App {
    /// The image that is shown, to be saved.
    pub fn asked(&self) -> Option<Asked> {
        let picture = self.worker.snapshot().picture.clone()?;
        let revision = self.revision;
        Some(Asked { picture, revision })
    }

    /// Hands the image over as soon as it is whole: that which was asked for before, else that which is shown.
    pub fn want_picture(&mut self, asked: Option<Asked>, to: Destination) {
        let Some(asked) = asked.or_else(|| self.asked()) else {
            return self.warn("there is no image yet");
        };
        if !asked.is_whole() && self.worker.snapshot().activity == Activity::Rendering {
            self.say(LogEntry::done(
                "The image follows once every pixel has a sample.".to_owned(),
            ));
        }
        self.files.wanted_pictures.push((asked, to));
    }

    /// Delivers the images that were requested. While something is being changed there are only small previews, which
    /// do not count, unless nothing better will come: rendering was stopped, or something else is rendered.
    pub fn hand_over_pictures(&mut self, ctx: &egui::Context) {
        if !self.dialogs.is_asking() {
            (self.files.asked, self.files.asked_layers) = (None, None);
        }
        let snapshot = self.worker.snapshot();
        let Some(latest) = &snapshot.picture else { return };
        let wanted = self.files.wanted_pictures.iter_mut().map(|(asked, _)| asked);
        for asked in wanted.chain(&mut self.files.asked) {
            if asked.revision == latest.revision {
                asked.picture = latest.clone();
            }
        }
        let is_stopped = matches!(snapshot.activity, Activity::Paused | Activity::Idle);
        let revision = self.revision;
        let is_ready = |(asked, _): &mut (Asked, _)| is_stopped || asked.is_whole() || asked.revision != revision;
        let ready: Vec<_> = self.files.wanted_pictures.extract_if(.., is_ready).collect();
        for (asked, to) in ready {
            let is_done = snapshot.activity == Activity::Done && asked.revision == revision;
            let (is_whole, picture) = (asked.is_whole(), asked.picture);
            let [count, wanted] = [picture.samples_per_pixel, picture.document.render.samples];
            let is_finished = is_whole && (is_done || count >= wanted);
            let details = details(picture.reduction, [count, wanted], is_finished);
            match to {
                Destination::File(path) => {
                    self.write_beside(move || {
                        output::write(&path, picture.rendered(), &picture.document).map_err(crate::in_words)?;
                        Ok(LogEntry::done_with("Saved", &path, &details).finished(is_finished))
                    });
                }
                Destination::Clipboard => {
                    let size = [picture.width as usize, picture.height as usize];
                    ctx.copy_image(egui::ColorImage::from_rgba_premultiplied(size, &picture.rgba));
                    self.say(LogEntry::done(format!("Copied the image: {details}")).finished(is_finished));
                }
            }
        }
    }

    /// Writes the layers that the renderer makes.
    pub fn write_layers(&mut self, path: PathBuf) {
        let asked = self.files.asked_layers.take();
        // With the samples that have come since, where nothing was edited.
        let is_past = |(revision, _): &(u64, _)| *revision != self.revision;
        let made = asked
            .filter(is_past)
            .map_or_else(|| self.worker.make_layers(), |(_, made)| made);
        self.write_beside(move || {
            let (layers, progress, reduction) = made.recv().map_err(|_| "there is no image yet")?;
            output::write_layers(&path, &layers).map_err(crate::in_words)?;
            let samples = [progress.samples_per_pixel, progress.samples_wanted];
            let is_finished = progress.is_done && reduction == 1;
            let details = format!("layers, {}", details(reduction, samples, is_finished));
            Ok(LogEntry::done_with("Saved", &path, &details).finished(is_finished))
        });
    }
}

/// The size of an image where that is reduced, and how many samples it has, of those wanted if it is not finished.
fn details(reduction: u32, [count, wanted]: [u32; 2], is_finished: bool) -> String {
    let size = match reduction {
        1 => String::new(),
        reduction => format!("1/{reduction} of the size, "),
    };
    let (of, last) = match is_finished {
        true => (String::new(), count),
        false => (format!("{count} of "), wanted),
    };
    format!("{size}{of}{last} sample{}", if last == 1 { "" } else { "s" })
}

impl App {
    /// Asks for the image that was wanted in the frame before, when a sheet may have lain over the window.
    pub fn picture_window(&mut self, ctx: &egui::Context) {
        let Some(path) = self.window_picture.take() else {
            return;
        };
        let (sender, taken) = channel();
        ctx.request_screenshot(move |image| {
            // Nobody listens where it took too long.
            let _ = sender.send(image);
        });
        ctx.request_repaint();
        self.write_beside(move || {
            let image: Arc<ColorImage> = taken
                .recv_timeout(PATIENCE)
                .map_err(|_| format!("{}: the screenshot can't be read back from the GPU", path.display()))?;
            let [width, height] = image.size.map(|side| side as u32);
            // The window is opaque, even if its surface has an alpha.
            let opaque = |pixel: &egui::Color32| [pixel.r(), pixel.g(), pixel.b(), 255];
            let rgba: Vec<u8> = image.pixels.iter().flat_map(opaque).collect();
            save_atomically(&path, &png_bytes([width, height], &rgba, None)?).map_err(crate::in_words)?;
            Ok(LogEntry::done_with(
                "Saved",
                &path,
                &format!("{width} × {height} pixels"),
            ))
        });
    }

    /// Asks for the file that a preset is exported to, or the selected material.
    pub fn ask_export(&mut self, ctx: &egui::Context, preset: Option<MaterialSettings>) {
        self.files.exported = preset;
        self.ask(ctx, Purpose::Export);
    }

    /// Makes the file beside the window, to be shown before it is written: of a format that takes a model all of it, else
    /// the selected material; or the preset that was chosen.
    pub fn prepare_export(&mut self, path: PathBuf) {
        let Some(format) = self.taken(exchange::by_ending(&path)) else {
            return;
        };
        let preset = self.files.exported.clone();
        let takes_model = format.takes_models() && preset.is_none();
        let material = preset.unwrap_or_else(|| self.desk_material());
        let name = material.name.clone();
        self.export.begin(Some(path.clone()));
        let subject = if takes_model {
            Subject {
                materials: self.document.materials.clone(),
                document: Some(Box::new(self.document.clone())),
                losses: Vec::new(),
            }
        } else {
            Subject::of(material)
        };
        let asked = path.clone();
        self.files.disk.beside(Task::List, move || {
            let ready = ready(&subject, &name, &path, format);
            finish(move |app, ctx| {
                if app.export.path.as_ref() == Some(&asked) {
                    match app.taken(ready) {
                        Some(ready) => app.export.ask(ctx, ready),
                        None => drop(app.export.begin(None)),
                    }
                }
                true
            })
        });
    }

    /// Makes the text of a material in a format beside the window, for the clipboard.
    pub fn copy_as(&mut self, material: MaterialSettings, format: &str) {
        let Some(format) = exchange::by_name(format) else {
            return;
        };
        self.files.disk.beside(Task::List, move || {
            let copied = as_text(material, format);
            finish(move |app, ctx| {
                let copied = copied.map(|(text, done)| {
                    ctx.copy_text(text);
                    done
                });
                app.report_outcome(copied)
            })
        });
    }

    /// Shows what is lost, and writes where that was agreed to.
    pub fn show_export(&mut self, ctx: &egui::Context) {
        let Some(answer) = self.export.show(ctx) else { return };
        if let Answer::Other(path) = answer {
            return self.prepare_export(path);
        }
        let prepared = self.export.begin(None);
        let Some(prepared) = prepared.filter(|_| answer == Answer::Write) else {
            return;
        };
        self.write(move || {
            prepared.save().map_err(crate::in_words)?;
            Ok(LogEntry::done_with("Exported", &prepared.report.output, ""))
        });
    }
}

/// A material as a format's text, and what to say about it.
fn as_text(material: MaterialSettings, format: &Registered) -> Result<(String, LogEntry), String> {
    let name = material.name.clone();
    let path = PathBuf::from(&name).with_extension(format.extensions[0]);
    let prepared = exchange::prepare(&Subject::of(material), &name, &path, format).map_err(crate::in_words)?;
    let count = |outcome: Outcome| prepared.report.count(outcome);
    let words = match [count(Outcome::Approximated), count(Outcome::Dropped)] {
        [0, 0] => format!("Copied {name}: {}, nothing is lost", format.label),
        [near, gone] => format!("Copied {name}: {}, {near} approximated, {gone} dropped", format.label),
    };
    let text = prepared.text().ok_or("this format is no text; export it to a file")?;
    Ok((text.to_owned(), LogEntry::done(words)))
}
