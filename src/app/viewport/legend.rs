//! What the colours of a map over the picture mean.

use egui::{Align2, Color32, Rect, TextStyle, Ui, pos2, vec2};

use crate::app::kit::words::percent;
use crate::plot::scale_color;
use crate::render::display::{Scale, Shown};

/// Size of the strip of colours, points.
const SIZE: [f32; 2] = [180.0, 10.0];
/// Steps of colour in it.
const STEPS: u32 = 45;
/// From the viewport's edges, points.
const MARGIN: f32 = 14.0;

/// Shows the strip in the lower left corner of the viewport.
pub(super) fn show(ui: &Ui, area: Rect, shown: Shown, scale: Scale) {
    let painter = ui.painter().with_clip_rect(area);
    let strip = Rect::from_min_size(
        pos2(area.left() + MARGIN, area.bottom() - MARGIN - 16.0 - SIZE[1]),
        vec2(SIZE[0], SIZE[1]),
    );
    painter.rect_filled(
        strip.expand2(vec2(8.0, 6.0)).with_max_y(strip.bottom() + 20.0),
        4.0,
        Color32::from_black_alpha(150),
    );
    let width = SIZE[0] / STEPS as f32;
    for step in 0..STEPS {
        let [red, green, blue] = scale_color(f64::from(step) / f64::from(STEPS - 1));
        let left = strip.left() + width * step as f32;
        let rect = Rect::from_min_max(pos2(left, strip.top()), pos2(left + width, strip.bottom()));
        painter.rect_filled(rect, 0.0, Color32::from_rgb(red, green, blue));
    }
    let text = |value: f64| match shown {
        Shown::Error => percent(value),
        _ => format!("{value:.0}"),
    };
    let font = TextStyle::Small.resolve(ui.style());
    let ends = [
        (strip.left(), Align2::LEFT_TOP, scale.low),
        (strip.right(), Align2::RIGHT_TOP, scale.high),
    ];
    for (x, align, value) in ends {
        painter.text(
            pos2(x, strip.bottom() + 3.0),
            align,
            text(value),
            font.clone(),
            Color32::WHITE,
        );
    }
    let what = match shown {
        Shown::Error => "error",
        _ => "samples",
    };
    let place = pos2(strip.center().x, strip.bottom() + 3.0);
    painter.text(place, Align2::CENTER_TOP, what, font, Color32::WHITE);
}
