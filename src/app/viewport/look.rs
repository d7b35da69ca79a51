//! The pixel that the inspector describes, in the viewport.

use super::seen::hit_at;
use super::*;

/// Least side of the mark around the pixel, points.
const MARK_MIN: f32 = 9.0;

/// Follows the pointer unless the pixel is pinned, says what is seen there, and marks a pinned pixel.
pub fn follow(
    ui: &Ui,
    response: &Response,
    area: Rect,
    place: Rect,
    scene: &Scene,
    picture: &Picture,
    desk: &mut Desk,
) {
    let look = &mut desk.shared.look;
    let follows = !look.is_pinned || look.at.is_none();
    if let Some(at) = response.hover_pos().filter(|at| follows && place.contains(*at)) {
        let share = (at - place.min) / place.size();
        look.at = Some([share.x, share.y].map(f64::from));
    }
    let Some(at) = look.at else { return };
    let [width, height] = scene.job.settings.image_size.map(f64::from);
    look.seen = hit_at([at[0] * width, at[1] * height], scene);
    if look.is_pinned
        && let Some([x, y]) = look.pixel([picture.width, picture.height])
    {
        let side = place.size() / vec2(picture.width as f32, picture.height as f32);
        let pixel = Rect::from_min_size(place.min + vec2(x as f32, y as f32) * side, side);
        let room = (MARK_MIN - pixel.width().min(pixel.height())).max(0.0);
        let painter = ui.painter_at(area);
        for (expanded, color) in [(1.0, Color32::BLACK), (0.0, Color32::WHITE)] {
            let mark = pixel.expand(0.5 * room + expanded);
            painter.rect_stroke(mark, 0.0, Stroke::new(1.0, color), StrokeKind::Outside);
        }
    }
}
