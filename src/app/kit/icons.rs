//! Icons on buttons, drawn as shapes: no glyph of the fonts looks the same everywhere.

use egui::{Painter, Rect, Response, Sense, Shape, Stroke, Ui, Vec2, vec2};

use crate::app::kit::theme::ROW_HEIGHT;

/// What is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    Pause,
    Play,
    More,
    Close,
    /// An eye.
    Shown,
    /// A closed one.
    Hidden,
    /// The squares of a texture.
    Texture,
}

/// A square button with an icon, which has a name and explains itself.
pub fn button(ui: &mut Ui, icon: Icon, name: &str, help: &str) -> Response {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(ROW_HEIGHT), Sense::click());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, ui.is_enabled(), name));
    let visuals = ui.style().interact(&response);
    ui.painter()
        .rect_filled(rect, visuals.corner_radius, visuals.weak_bg_fill);
    if response.has_focus() {
        ui.painter().rect_stroke(
            rect,
            visuals.corner_radius,
            ui.visuals().selection.stroke,
            egui::StrokeKind::Inside,
        );
    }
    paint(ui.painter(), icon, rect, visuals.fg_stroke.color);
    response.on_hover_text(help)
}

fn paint(painter: &Painter, icon: Icon, rect: Rect, color: egui::Color32) {
    let at = |x: f32, y: f32| rect.center() + vec2(x, y);
    let stroke = Stroke::new(1.5, color);
    let bar = |left: f32| Rect::from_min_max(at(left, -5.0), at(left + 3.0, 5.0));
    match icon {
        Icon::Pause => {
            painter.rect_filled(bar(-4.5), 0.5, color);
            painter.rect_filled(bar(1.5), 0.5, color);
        }
        Icon::Play => {
            let corners = vec![at(-3.5, -5.5), at(5.5, 0.0), at(-3.5, 5.5)];
            painter.add(Shape::convex_polygon(corners, color, Stroke::NONE));
        }
        Icon::More => [-5.0, 0.0, 5.0].into_iter().for_each(|x| {
            painter.circle_filled(at(x, 0.0), 1.5, color);
        }),
        Icon::Close => {
            painter.line_segment([at(-4.0, -4.0), at(4.0, 4.0)], stroke);
            painter.line_segment([at(-4.0, 4.0), at(4.0, -4.0)], stroke);
        }
        Icon::Shown => {
            let lid = |side: f32| vec![at(-6.5, 0.0), at(-3.0, side * 3.6), at(3.0, side * 3.6), at(6.5, 0.0)];
            [1.0, -1.0].into_iter().for_each(|side| {
                painter.add(Shape::line(lid(side), stroke));
            });
            painter.circle_filled(at(0.0, 0.0), 2.0, color);
        }
        Icon::Texture => {
            for (row, column) in [(0, 0), (1, 1), (2, 0), (0, 2), (2, 2)] {
                let corner = at(4.0 * column as f32 - 6.0, 4.0 * row as f32 - 6.0);
                painter.rect_filled(Rect::from_min_size(corner, Vec2::splat(4.0)), 0.0, color);
            }
        }
        Icon::Hidden => {
            let lid = vec![at(-6.5, 0.0), at(-3.0, 3.0), at(3.0, 3.0), at(6.5, 0.0)];
            painter.add(Shape::line(lid, stroke));
        }
    }
}
