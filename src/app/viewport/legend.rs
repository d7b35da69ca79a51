//! What the colours of a map over the image mean.

use super::*;
use crate::{
    kit::{widgets::rgb, words::percent},
    plot::scale_color,
    render::shown::{CLIPPED, Scale, Shown},
};

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
        (_, Some(Scale { low, high, .. })) => {
            let below = [value(shown, low), what(shown).to_owned(), value(shown, high)];
            strip(ui, area, scale_color, ["", ""], below);
        }
        _ => {}
    }
}

/// The strip of colours, for shares in [0, 1], with what stands at its ends and in its middle.
pub fn strip(ui: &Ui, area: Rect, color: impl Fn(f64) -> [u8; 3], above: [&str; 2], below: [String; 3]) {
    let strip = place(ui, area);
    let painter = ui.painter_at(area);
    let width = SIZE[0] / STEPS as f32;
    for step in 0..STEPS {
        let left = strip.left() + width * step as f32;
        let rect = Rect::from_x_y_ranges(left..=left + width, strip.y_range());
        painter.rect_filled(rect, 0.0, rgb(color(f64::from(step) / f64::from(STEPS - 1))));
    }
    let font = TextStyle::Small.resolve(ui.style());
    let text = |at: Pos2, align: Align2, text: &str| {
        painter.text(at, align, text, font.clone(), Color32::WHITE);
    };
    let gap = vec2(0.0, 3.0);
    text(strip.left_top() - gap, Align2::LEFT_BOTTOM, above[0]);
    text(strip.right_top() - gap, Align2::RIGHT_BOTTOM, above[1]);
    text(strip.left_bottom() + gap, Align2::LEFT_TOP, &below[0]);
    text(strip.center_bottom() + gap, Align2::CENTER_TOP, &below[1]);
    text(strip.right_bottom() + gap, Align2::RIGHT_TOP, &below[2]);
}

/// Where the strip is, on a ground that it can be distinguished from.
fn place(ui: &Ui, area: Rect) -> Rect {
    let at = pos2(area.left() + MARGIN, area.bottom() - MARGIN - 16.0 - SIZE[1]);
    let strip = Rect::from_min_size(at, vec2(SIZE[0], SIZE[1]));
    let ground = strip.expand2(vec2(8.0, 18.0));
    let painter = ui.painter_at(area);
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
    let painter = ui.painter_at(area);
    let font = TextStyle::Small.resolve(ui.style());
    let middle = strip.center().y + 5.0;
    for (color, label, x) in [(CLIPPED[0], "too bright", 0.0), (CLIPPED[1], "black", 0.55)] {
        let left = strip.left() + x * SIZE[0];
        let square = Rect::from_center_size(pos2(left + 5.0, middle), vec2(10.0, 10.0));
        painter.rect_filled(square, 2.0, rgb(color));
        let at = pos2(left + 16.0, middle);
        painter.text(at, Align2::LEFT_CENTER, label, font.clone(), Color32::WHITE);
    }
}
