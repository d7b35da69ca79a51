//! The image as a file or on the clipboard: as soon as there is one of the document as it is, at its full size.

use std::path::PathBuf;
use std::sync::Arc;

use crate::app::App;
use crate::render::output::{self, Layers};
use crate::render::worker::{Activity, Level, Picture};

/// Where an image goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::app) enum Destination {
    File(PathBuf),
    Clipboard,
}

impl App {
    /// Hands the image over as soon as it is whole.
    pub(in crate::app) fn want_picture(&mut self, to: Destination) {
        if self.worker.snapshot().picture.is_none() {
            self.report(Level::Warning, "there is no image yet");
        } else {
            self.files.wanted_pictures.push(to);
        }
    }

    /// Delivers the image if one was requested. While something is being changed there are only small previews, which
    /// do not count, unless rendering was stopped and nothing better will come.
    pub(in crate::app) fn hand_over_pictures(&mut self, ctx: &egui::Context) {
        if self.files.wanted_pictures.is_empty() {
            return;
        }
        let snapshot = self.worker.snapshot();
        let Some(picture) = &snapshot.picture else {
            return;
        };
        let is_whole = picture.reduction == 1 && picture.revision == self.revision;
        let is_stopped = matches!(snapshot.activity, Activity::Paused | Activity::Idle);
        if !is_whole && !is_stopped {
            return;
        }
        for to in std::mem::take(&mut self.files.wanted_pictures) {
            match to {
                Destination::File(path) => self.save_picture(path, picture.clone()),
                Destination::Clipboard => self.copy_picture(ctx, picture),
            }
        }
    }

    fn save_picture(&mut self, path: PathBuf, picture: Arc<Picture>) {
        self.files.disk.write_beside(move || {
            output::write(&path, picture.rendered(), &picture.document).map_err(|error| error.to_string())?;
            let size = format!("{} × {}", picture.width, picture.height);
            Ok(format!(
                "saved {} ({size}, {} samples per pixel)",
                path.display(),
                picture.samples_per_pixel
            ))
        });
    }

    fn copy_picture(&mut self, ctx: &egui::Context, picture: &Picture) {
        let size = [picture.width as usize, picture.height as usize];
        ctx.copy_image(egui::ColorImage::from_rgba_premultiplied(size, &picture.rgba));
        let words = format!("copied the image ({} × {})", picture.width, picture.height);
        self.report(Level::Info, words);
    }

    /// Writes the layers that the renderer made.
    pub(in crate::app) fn write_layers(&mut self, path: PathBuf, layers: Box<Layers>) {
        self.files.disk.write_beside(move || {
            output::write_layers(&path, &layers).map_err(|error| error.to_string())?;
            Ok(format!("saved {} with layers", path.display()))
        });
    }
}
