//! Icons on buttons, drawn as shapes: no glyph of the fonts looks the same everywhere.

use egui::*;

use super::{theme::ROW_HEIGHT, widgets::show_focus};

/// What is drawn.
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
    let response = ui.add_sized(Vec2::splat(ROW_HEIGHT), Button::new(""));
    show_focus(ui, &response);
    let color = ui.style().interact(&response).fg_stroke.color;
    paint(ui.painter(), icon, response.rect, color);
    response.accessible_name(name).on_hover_text(help)
}

fn paint(painter: &Painter, icon: Icon, rect: Rect, color: Color32) {
    let at = |[x, y]: [f32; 2]| rect.center() + vec2(x, y);
    let line = |width: f32, points: &[[f32; 2]]| {
        let points = points.iter().map(|point| at(*point)).collect();
        painter.add(Shape::line(points, Stroke::new(width, color)));
    };
    let lid = |height: f32| line(1.5, &[[-6.5, 0.0], [-3.0, height], [3.0, height], [6.5, 0.0]]);
    match icon {
        Icon::Pause => [-3.0, 3.0].into_iter().for_each(|x| line(3.0, &[[x, -5.0], [x, 5.0]])),
        Icon::Play => {
            let corners = [[-3.5, -5.5], [5.5, 0.0], [-3.5, 5.5]].map(at);
            painter.add(Shape::convex_polygon(corners.to_vec(), color, Stroke::NONE));
        }
        Icon::More => [-5.0, 0.0, 5.0].into_iter().for_each(|x| {
            painter.circle_filled(at([x, 0.0]), 1.5, color);
        }),
        Icon::Close => [-4.0, 4.0].into_iter().for_each(|y| line(1.5, &[[-4.0, y], [4.0, -y]])),
        Icon::Shown => {
            lid(3.6);
            lid(-3.6);
            painter.circle_filled(rect.center(), 2.0, color);
        }
        Icon::Texture => {
            for [x, y] in [[-4.0, -4.0], [0.0, 0.0], [-4.0, 4.0], [4.0, -4.0], [4.0, 4.0]] {
                line(4.0, &[[x - 2.0, y], [x + 2.0, y]]);
            }
        }
        Icon::Hidden => lid(3.0),
    }
}
