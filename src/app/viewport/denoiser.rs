//! A way to the denoiser where it is missing: why the image is noisy at first, and a button that fetches it.

use egui::{Rect, Ui, vec2};

use super::LOADING_MARGIN;
use crate::app::desk::Desk;
use crate::app::kit::theme;
use crate::app::services::beside::started;
use crate::document::Denoise;
use crate::render::background::Background;
use crate::render::denoise::Library;
use crate::render::denoise::fetch::{DOWNLOAD, can_fetch, fetch};

/// Width of the offer, points; and what is below it in the viewport.
const WIDTH: f32 = 250.0;
const ABOVE: f32 = 2.0 * theme::ROW_HEIGHT;
/// Height of the offer while it has a message, points.
const HEIGHT: f32 = 76.0;

/// Fetches the denoiser beside the window.
#[derive(Default)]
pub struct DenoiserOffer {
    worker: Option<Background<(), Result<(), String>>>,
    is_declined: bool,
    /// The outcome was taken note of.
    is_taken: bool,
}

impl DenoiserOffer {
    /// Shows the offer over the image where the denoiser is missing; once it is there, images are denoised.
    pub fn show(&mut self, ui: &mut Ui, area: Rect, desk: &mut Desk<'_>) {
        if self.is_declined
            || !desk.shared.offers_downloads
            || !can_fetch()
            || (self.worker.is_none() && !Library::is_missing())
        {
            return;
        }
        let is_busy = self.worker.as_ref().is_some_and(Background::is_busy);
        let outcome = self.worker.as_ref().and_then(Background::latest).filter(|_| !is_busy);
        if let Some(Ok(())) = outcome {
            if !std::mem::replace(&mut self.is_taken, true) {
                desk.document.view.denoise = Denoise::Auto;
                desk.edits.note("Denoise", "view.denoise");
            }
            return;
        }
        let up = LOADING_MARGIN + ABOVE + HEIGHT;
        let corner = area.left_bottom() + vec2(LOADING_MARGIN, -up);
        let builder = egui::UiBuilder::new()
            .scope_id(egui::Id::unique("denoiser offer"))
            .max_rect(Rect::from_min_size(corner, vec2(WIDTH, HEIGHT)))
            .layout(egui::Layout::bottom_up(egui::Align::Min));
        let mut inside = ui.new_child(builder);
        egui::Frame::popup(inside.style()).show(&mut inside, |ui| {
            ui.set_width(WIDTH);
            ui.horizontal(|ui| self.buttons(ui, is_busy));
            let text = match outcome {
                Some(Err(why)) => why,
                _ if is_busy => "Downloading; you can go on meanwhile.".to_owned(),
                _ => "Images are noisy at first: the denoiser is not installed.".to_owned(),
            };
            ui.add(egui::Label::new(text).wrap());
        });
    }

    fn buttons(&mut self, ui: &mut Ui, is_busy: bool) {
        let label = format!("Get the denoiser ({DOWNLOAD})");
        let get = ui.add_enabled(!is_busy, egui::Button::new(label));
        let get = get.on_hover_text("Downloads Open Image Denoise, by the Python package pyoidn, for you alone.");
        if is_busy {
            ui.add(egui::Spinner::new().size(12.0));
        }
        if ui.add_enabled(!is_busy, egui::Button::new("No")).clicked() {
            self.is_declined = true;
        }
        if !get.clicked() {
            return;
        }
        let worker = started(&mut self.worker, ui.ctx(), |repaint| {
            Background::spawn("denoiser", repaint, |(), responder| {
                responder.publish(fetch().map_err(crate::in_words));
            })
        });
        if let Some(worker) = worker {
            worker.ask(());
        }
    }
}
