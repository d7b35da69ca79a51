//! How many pixels of the image have which brightness on the screen.

use super::*;
use crate::render::shown::clipped;

/// Columns of the histogram.
const BINS: usize = 64;
/// Roughly how many pixels of a large image are counted.
const PIXELS_MAX: usize = 1 << 18;

/// The counts of the image that is shown.
#[derive(Default)]
pub struct Brightness {
    serial: Option<u64>,
    counts: Counts,
}

/// Shares of the pixels.
#[derive(Default)]
struct Counts {
    /// Red, green and blue in each column, 1 for the fullest of all.
    columns: [Vec<f32>; 3],
    /// Pixels that are clipped to white in a channel, and those that are black.
    clipped: [f64; 2],
}

impl Counts {
    /// The histogram of displayed bytes; of large images only every n-th pixel is counted.
    fn of(rgba: &[u8]) -> Self {
        let stride = (rgba.len() / 4).div_ceil(PIXELS_MAX).max(1);
        let mut counts = [[0_u32; BINS]; 3];
        let (mut kinds, mut total) = ([0_u32; 2], 0_u32);
        for &[r, g, b, a] in rgba.as_chunks().0.iter().step_by(stride) {
            if a == 0 {
                continue;
            }
            for (of, value) in counts.iter_mut().zip([r, g, b]) {
                of[usize::from(value) * BINS / 256] += 1;
            }
            if let Some(kind) = clipped([r, g, b]) {
                kinds[kind] += 1;
            }
            total += 1;
        }
        let fullest = counts.iter().flatten().copied().max().unwrap_or(0).max(1) as f32;
        Self {
            columns: counts.map(|of| of.map(|count| count as f32 / fullest).to_vec()),
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
        let size = vec2(ui.available_width(), 90.0);
        let (place, response) = ui.allocate_exact_size(size, Sense::hover());
        widgets::describe(&response, Role::Label, "Histogram of the image");
        ui.painter().rect_filled(place, 3.0, ui.visuals().extreme_bg_color);
        // Red, green and blue that together are grey.
        let [high, low] = if ui.visuals().dark_mode { [220, 60] } else { [200, 30] };
        for (channel, columns) in self.counts.columns.iter().enumerate() {
            let [r, g, b] = [0, 1, 2].map(|of| if of == channel { high } else { low });
            let color = Color32::from_rgba_unmultiplied(r, g, b, 120);
            let width = place.width() / BINS as f32;
            for (index, share) in columns.iter().enumerate() {
                let left = place.left() + width * index as f32;
                // The square root: what few pixels have is seen, too.
                let top = place.bottom() - share.sqrt() * (place.height() - 2.0);
                let column = Rect::from_min_max(pos2(left, top), pos2(left + width, place.bottom()));
                ui.painter().rect_filled(column, 0.0, color);
            }
        }
        let [bright, dark] = self.counts.clipped.map(percent);
        widgets::note(ui, format!("Too bright for the screen: {bright}. Black: {dark}."));
    }
}
