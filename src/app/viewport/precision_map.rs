//! The map of what in the image's numbers is not to be trusted, with what its colours mean.

use std::sync::Arc;

use super::header::in_bar;
use super::*;
use crate::{
    job::precision::{Fault, PrecisionMap},
    kit::widgets::rgb,
    render::precision_maps,
    services::beside::Beside,
};

/// Height of the legend, and its distance from the viewport's edges, points.
const HEIGHT: f32 = 26.0;
const MARGIN: f32 = 14.0;
/// Side of a colour's square.
const SQUARE: f32 = 10.0;

/// The map as far as it has come.
#[derive(Default)]
pub struct PrecisionView {
    maps: Beside<Arc<Job>, Arc<PrecisionMap>>,
    /// What the latest map was asked of.
    asked: Option<Arc<Job>>,
    /// What the texture shows; kept so that no other map has its address.
    map: Option<Arc<PrecisionMap>>,
    shown: ShownTexture,
}

impl PrecisionView {
    /// Paints the map of a job over `place` once it is there, and the legend into a corner of `area`.
    pub fn show(&mut self, ui: &mut Ui, area: Rect, place: Rect, job: &Arc<Job>) {
        if !self.asked.as_ref().is_some_and(|asked| Arc::ptr_eq(asked, job)) {
            self.maps
                .ask_again(ui.ctx(), "precision", job.clone(), precision_maps::answer);
            self.asked = Some(job.clone());
        }
        self.map = self.maps.latest();
        if let Some(map) = &self.map {
            let key = [u64::MAX, Arc::as_ptr(map) as u64];
            self.shown.upload(ui, key, || {
                let size = [map.width as usize, map.height as usize];
                ColorImage::from_rgba_premultiplied(size, &map.colors())
            });
            self.shown.show(ui, place, place);
        }
        legend(ui, area, self.map.as_deref(), self.maps.is_busy());
    }
}

fn legend(ui: &mut Ui, area: Rect, map: Option<&PrecisionMap>, is_busy: bool) {
    let corner = pos2(area.left() + MARGIN, area.bottom() - MARGIN - HEIGHT);
    let rect = Rect::from_min_size(corner, vec2(480.0_f32.min(area.width() - 2.0 * MARGIN), HEIGHT));
    ui.painter().rect_filled(rect, 4.0, Color32::from_black_alpha(170));
    let mut ui = in_bar(ui, "precision", rect);
    if let Some(map) = map {
        for &fault in Fault::ALL {
            let (square, _) = ui.allocate_exact_size(vec2(SQUARE, SQUARE), Sense::hover());
            ui.painter().rect_filled(square, 2.0, rgb(fault.color()));
            ui.colored_label(Color32::WHITE, format!("{} {}", map.count(fault), fault.label()))
                .on_hover_text(fault.help());
        }
        ui.colored_label(Color32::LIGHT_GRAY, format!("of {} pixels", map.findings.len()));
    }
    if is_busy {
        ui.add(Spinner::new().size(12.0));
    }
}
