//! The image as a file or on the clipboard: as soon as there is one of the document as it is, at its full size.

use std::path::PathBuf;

use crate::app::App;
use crate::app::services::messages::Success;
use crate::render::Progress;
use crate::render::output::{self, Layers};
use crate::render::worker::{Activity, Level};

/// Where an image goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Destination {
    File(PathBuf),
    Clipboard,
}

impl App {
    /// Hands the image over as soon as it is whole.
    pub fn want_picture(&mut self, to: Destination) {
        if self.worker.snapshot().picture.is_none() {
            self.report(Level::Warning, "there is no image yet");
        } else {
            self.files.wanted_pictures.push(to);
        }
    }

    /// Delivers the image if one was requested. While something is being changed there are only small previews, which
    /// do not count, unless rendering was stopped and nothing better will come.
    pub fn hand_over_pictures(&mut self, ctx: &egui::Context) {
        if self.files.wanted_pictures.is_empty() {
            return;
        }
        let snapshot = self.worker.snapshot();
        let Some(picture) = snapshot.picture.clone() else {
            return;
        };
        let is_whole = picture.reduction == 1 && picture.revision == self.revision;
        let is_stopped = matches!(snapshot.activity, Activity::Paused | Activity::Idle);
        if !is_whole && !is_stopped {
            return;
        }
        let [count, wanted] = [picture.samples_per_pixel, picture.document.render.samples];
        let is_finished = is_whole && (snapshot.activity == Activity::Done || count >= wanted);
        let size = match picture.reduction {
            1 => String::new(),
            reduction => format!("1/{reduction} of the size, "),
        };
        let details = size + &samples([count, wanted], is_finished);
        for to in std::mem::take(&mut self.files.wanted_pictures) {
            match to {
                Destination::File(path) => {
                    let (picture, details) = (picture.clone(), details.clone());
                    self.files.disk.write_beside(move || {
                        output::write(&path, picture.rendered(), &picture.document).map_err(crate::in_words)?;
                        Ok(Success::with_file("Saved", &path, &details).finished(is_finished))
                    });
                }
                Destination::Clipboard => {
                    let size = [picture.width as usize, picture.height as usize];
                    ctx.copy_image(egui::ColorImage::from_rgba_premultiplied(size, &picture.rgba));
                    let done = Success::new(format!("Copied the image: {details}")).finished(is_finished);
                    self.report_success(Some(done));
                }
            }
        }
    }

    /// Writes the layers that the renderer made.
    pub fn write_layers(&mut self, path: PathBuf, layers: Box<Layers>, progress: &Progress) {
        let is_finished = progress.is_done;
        let samples = samples([progress.samples_per_pixel, progress.samples_wanted], is_finished);
        self.files.disk.write_beside(move || {
            output::write_layers(&path, &layers).map_err(crate::in_words)?;
            let details = format!("layers, {samples}");
            Ok(Success::with_file("Saved", &path, &details).finished(is_finished))
        });
    }
}

/// How many samples an image has, of those wanted if it is not finished.
fn samples([count, wanted]: [u32; 2], is_finished: bool) -> String {
    let (of, last) = match is_finished {
        true => (String::new(), count),
        false => (format!("{count} of "), wanted),
    };
    format!("{of}{last} sample{}", if last == 1 { "" } else { "s" })
}
