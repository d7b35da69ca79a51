//! What the colours of a map over the image mean.

use egui::{Align2, Color32, Rect, TextStyle, Ui, pos2, vec2};

use crate::app::kit::words::percent;
use crate::plot::scale_color;
use crate::render::shown::{CLIPPED, Scale, Shown};

/// Size of the strip of colours, points.
const SIZE: [f32; 2] = [180.0, 10.0];
/// Steps of colour in it.
const STEPS: u32 = 45;
/// From the viewport's edges, points.
const MARGIN: f32 = 14.0;

/// Shows what the colours mean in the lower left corner of the viewport.
pub fn show(ui: &Ui, area: Rect, shown: Shown, scale: Option<Scale>) {
    match (shown, scale) {
        (Shown::Clipping, _) => marks(ui, area),
        (_, Some(scale)) => strip(ui, area, shown, scale),
        _ => {}
    }
}

/// The strip of colours with the values at its ends.
fn strip(ui: &Ui, area: Rect, shown: Shown, scale: Scale) {
    let strip = place(ui, area);
    let painter = ui.painter().with_clip_rect(area);
    let width = SIZE[0] / STEPS as f32;
    for step in 0..STEPS {
        let [red, green, blue] = scale_color(f64::from(step) / f64::from(STEPS - 1));
        let left = strip.left() + width * step as f32;
        let rect = Rect::from_min_max(pos2(left, strip.top()), pos2(left + width, strip.bottom()));
        painter.rect_filled(rect, 0.0, Color32::from_rgb(red, green, blue));
    }
    let font = TextStyle::Small.resolve(ui.style());
    let text = |x: f32, align: Align2, text: String| {
        let at = pos2(x, strip.bottom() + 3.0);
        painter.text(at, align, text, font.clone(), Color32::WHITE);
    };
    text(strip.left(), Align2::LEFT_TOP, value(shown, scale.low));
    text(strip.right(), Align2::RIGHT_TOP, value(shown, scale.high));
    text(strip.center().x, Align2::CENTER_TOP, what(shown).to_owned());
}

/// Where the strip is, on a ground that it can be distinguished from.
fn place(ui: &Ui, area: Rect) -> Rect {
    let at = pos2(area.left() + MARGIN, area.bottom() - MARGIN - 16.0 - SIZE[1]);
    let strip = Rect::from_min_size(at, vec2(SIZE[0], SIZE[1]));
    let ground = strip.expand2(vec2(8.0, 6.0)).with_max_y(strip.bottom() + 20.0);
    let painter = ui.painter().with_clip_rect(area);
    painter.rect_filled(ground, 4.0, Color32::from_black_alpha(150));
    strip
}

fn value(shown: Shown, value: f64) -> String {
    match shown {
        Shown::Error => percent(value),
        Shown::FalseColor => format!("{value:+.0}"),
        Shown::Variance => format!("{value:.1e}"),
        Shown::Depth => format!("{value:.3}"),
        _ => format!("{value:.0}"),
    }
}

fn what(shown: Shown) -> &'static str {
    match shown {
        Shown::Error => "error",
        Shown::FalseColor => "stops from middle grey",
        Shown::Variance => "variance",
        Shown::Depth => "depth",
        _ => "samples",
    }
}

/// What the marks of clipped pixels mean.
fn marks(ui: &Ui, area: Rect) {
    let strip = place(ui, area);
    let painter = ui.painter().with_clip_rect(area);
    let font = TextStyle::Small.resolve(ui.style());
    let middle = strip.center().y + 5.0;
    for ([red, green, blue], label, x) in [(CLIPPED[0], "too bright", 0.0), (CLIPPED[1], "black", 0.55)] {
        let left = strip.left() + x * SIZE[0];
        let square = Rect::from_center_size(pos2(left + 5.0, middle), vec2(10.0, 10.0));
        painter.rect_filled(square, 2.0, Color32::from_rgb(red, green, blue));
        let at = pos2(left + 16.0, middle);
        painter.text(at, Align2::LEFT_CENTER, label, font.clone(), Color32::WHITE);
    }
}
