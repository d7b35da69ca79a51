//! A closer look at the pixels that the image has, without moving the camera.

use super::*;
use crate::named::with_defaults;

/// Largest size of one of the image's pixels, points.
const PIXEL_MAX: f32 = 48.0;

with_defaults! {
    /// How much larger than it fits the image is shown, and which part of it.
    pub struct Magnifier {
        /// 1: as large as it fits.
        factor: f32 = 1.0,
        /// What is in the middle of the viewport, as shares of the image.
        center: Vec2 = Vec2::splat(0.5),
    }
}

impl Magnifier {
    /// Whether the image is shown larger than it fits.
    pub fn is_on(&self) -> bool {
        self.factor > 1.0
    }

    /// Where the image is, of which `fitted` is the place at its usual size: it covers the area where it can.
    pub fn place(&mut self, area: Rect, fitted: Rect) -> Rect {
        if !self.is_on() {
            *self = Self::default();
            return fitted;
        }
        let size = self.factor * fitted.size();
        let min = area.center() - self.center * size;
        let within = |min: f32, side: f32, area: Rangef| match side <= area.span() {
            true => area.center() - 0.5 * side,
            false => min.clamp(area.max - side, area.min),
        };
        let min = pos2(
            within(min.x, size.x, area.x_range()),
            within(min.y, size.y, area.y_range()),
        );
        self.center = (area.center() - min) / size;
        Rect::from_min_size(min, size)
    }

    /// Magnifies the image by a factor around a fixed place. `width_px` is the image's width.
    pub fn zoom(&mut self, by: f32, at: Pos2, area: Rect, fitted: Rect, width_px: u32) {
        let before = self.place(area, fitted);
        let share = (at - before.min) / before.size();
        let most = (PIXEL_MAX * width_px as f32 / fitted.width().max(1.0)).max(1.0);
        self.factor = (self.factor * by).clamp(1.0, most);
        self.center = share + (area.center() - at) / (self.factor * fitted.size());
    }

    /// Moves it by a distance in points.
    pub fn pan(&mut self, by: Vec2, fitted: Rect) {
        self.center -= by / (self.factor * fitted.size()).max(vec2(1.0, 1.0));
    }
}
