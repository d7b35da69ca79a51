//! How many pixels of the image have which brightness on the screen.

use egui::{Color32, Rect, Sense, Ui, pos2, vec2};

use crate::app::kit::widgets;
use crate::app::kit::words::percent;
use crate::render::shown::clipped;
use crate::render::worker::Picture;

/// Columns of the histogram.
const BINS: usize = 64;
/// Roughly how many pixels of a large image are counted.
const PIXELS_MAX: usize = 1 << 18;
/// Height of the chart, points.
const HEIGHT: f32 = 90.0;

/// The counts of the image that is shown.
#[derive(Default)]
pub struct Brightness {
    serial: Option<u64>,
    counts: Counts,
}

/// Shares of the pixels.
#[derive(Clone, Debug, PartialEq)]
struct Counts {
    /// Red, green and blue in each column, 1 for the fullest of all.
    columns: [[f32; BINS]; 3],
    /// Pixels that are clipped to white in a channel, and those that are black.
    clipped: [f64; 2],
}

impl Default for Counts {
    fn default() -> Self {
        Self {
            columns: [[0.0; BINS]; 3],
            clipped: [0.0; 2],
        }
    }
}

impl Counts {
    /// The histogram of displayed bytes; of large images only every n-th pixel is counted.
    fn of(rgba: &[u8]) -> Self {
        let stride = (rgba.len() / 4).div_ceil(PIXELS_MAX).max(1);
        let mut counts = [[0_u32; BINS]; 3];
        let (mut kinds, mut total) = ([0_u32; 2], 0_u32);
        for pixel in rgba.chunks_exact(4).step_by(stride).filter(|pixel| pixel[3] > 0) {
            let color = [pixel[0], pixel[1], pixel[2]];
            for (of, value) in counts.iter_mut().zip(color) {
                of[usize::from(value) * BINS / 256] += 1;
            }
            if let Some(kind) = clipped(color) {
                kinds[kind] += 1;
            }
            total += 1;
        }
        let fullest = counts.iter().flatten().copied().max().unwrap_or(0).max(1) as f32;
        Self {
            columns: counts.map(|of| of.map(|count| count as f32 / fullest)),
            clipped: kinds.map(|count| f64::from(count) / f64::from(total.max(1))),
        }
    }
}

impl Brightness {
    /// Shows the image's own, unless the viewport shows a map of it.
    pub fn show(&mut self, ui: &mut Ui, picture: &Picture) {
        if picture.map.is_none() && self.serial != Some(picture.serial) {
            self.counts = Counts::of(&picture.rgba);
            self.serial = Some(picture.serial);
        }
        let size = vec2(ui.available_width(), HEIGHT);
        let (place, response) = ui.allocate_exact_size(size, Sense::hover());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, "Histogram of the image"));
        ui.painter().rect_filled(place, 3.0, ui.visuals().extreme_bg_color);
        for (columns, color) in self.counts.columns.iter().zip(colors(ui.visuals().dark_mode)) {
            self.columns(ui, place, columns, color);
        }
        let [bright, dark] = self.counts.clipped.map(percent);
        widgets::note(ui, format!("Too bright for the screen: {bright}. Black: {dark}."));
    }

    fn columns(&self, ui: &Ui, place: Rect, columns: &[f32; BINS], color: Color32) {
        let width = place.width() / BINS as f32;
        for (index, share) in columns.iter().enumerate().filter(|(_, share)| **share > 0.0) {
            let left = place.left() + width * index as f32;
            // The square root: what few pixels have is seen, too.
            let top = place.bottom() - share.sqrt() * (place.height() - 2.0);
            let column = Rect::from_min_max(pos2(left, top), pos2(left + width, place.bottom()));
            ui.painter().rect_filled(column, 0.0, color);
        }
    }
}

/// Red, green and blue that together are grey.
fn colors(is_dark: bool) -> [Color32; 3] {
    let [high, low] = if is_dark { [220, 60] } else { [200, 30] };
    [
        Color32::from_rgba_unmultiplied(high, low, low, 120),
        Color32::from_rgba_unmultiplied(low, high, low, 120),
        Color32::from_rgba_unmultiplied(low, low, high, 120),
    ]
}
