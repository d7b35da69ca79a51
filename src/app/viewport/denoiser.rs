//! A way to the denoiser where it is missing: why the image is noisy at first, and a button that fetches it.

use super::*;
use crate::{
    document::Denoise,
    render::denoise::Library,
    render::denoise::fetch::{DOWNLOAD, can_fetch, fetch},
    services::beside::Beside,
};

/// Width of the offer, points.
const WIDTH: f32 = 250.0;
/// Height of the offer while it has a message, points.
const HEIGHT: f32 = 76.0;

/// Fetches the denoiser beside the window.
#[derive(Default)]
pub struct DenoiserOffer {
    /// The share that is there.
    worker: Beside<(), Result<f32, String>>,
    /// By the user, or because it was taken.
    is_declined: bool,
}

impl DenoiserOffer {
    /// Shows the offer over the image where the denoiser is missing; once it is there, images are denoised.
    pub fn show(&mut self, ui: &mut Ui, area: Rect, desk: &mut Desk) {
        if self.is_declined
            || !desk.shared.offers_downloads
            || !can_fetch()
            || (!self.worker.is_busy() && self.worker.latest().is_none() && !Library::is_missing())
        {
            return;
        }
        let is_busy = self.worker.is_busy();
        let outcome = self.worker.latest().filter(|_| !is_busy);
        if let Some(Ok(_)) = outcome {
            self.is_declined = true;
            let is_saved = desk.edits.is_saved(desk.document);
            desk.document.view.denoise = Denoise::Auto;
            desk.edits.note("Denoise", "view.denoise");
            if is_saved {
                // No work that could be lost.
                desk.edits.record(desk.document, false);
                desk.edits.history.mark_saved();
            }
            return;
        }
        let up = LOADING_MARGIN + 2.0 * theme::ROW_HEIGHT + HEIGHT;
        let corner = area.left_bottom() + vec2(LOADING_MARGIN, -up);
        let place = Rect::from_min_size(corner, vec2(WIDTH, HEIGHT));
        let mut inside = laid_over(ui, "denoiser offer", place, Layout::bottom_up(Align::Min));
        Frame::popup(inside.style()).show(&mut inside, |ui| {
            ui.set_width(WIDTH);
            ui.horizontal(|ui| self.buttons(ui, is_busy));
            let text = match outcome {
                Some(Err(why)) => why,
                _ if is_busy => {
                    let share = self.worker.latest().and_then(Result::ok).unwrap_or_default();
                    format!("Downloading, {:.0} %; you can go on meanwhile.", 100.0 * share)
                }
                _ => "Images are noisy at first: the denoiser is not installed.".to_owned(),
            };
            ui.add(Label::new(text).wrap());
        });
    }

    fn buttons(&mut self, ui: &mut Ui, is_busy: bool) {
        let label = format!("Get the denoiser ({DOWNLOAD})");
        let help = "Downloads Open Image Denoise, by the Python package pyoidn, for you alone.";
        let gets = widgets::pressed_if(ui, !is_busy, label, help, "");
        let label = if is_busy { "Stop" } else { "No" };
        if ui.button(label).clicked() {
            self.is_declined = !is_busy;
            self.worker = Beside::default();
        }
        if gets {
            self.worker.ask_again(ui.ctx(), "denoiser", (), |(), responder| {
                let done = fetch(&|share| {
                    responder.publish(Ok(share));
                    !responder.is_superseded()
                });
                responder.publish(done.map(|()| 1.0));
            });
        }
    }
}
