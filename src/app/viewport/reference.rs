//! The reference image under, over or beside the render.

use super::*;
use crate::document::Reference;

/// The reference image that is shown at a place of its own or the render's.
fn shown_at(desk: &Desk, place: ReferencePlace) -> Option<Reference> {
    let reference = desk.document.view.reference.as_ref();
    reference.filter(|reference| reference.place == place).cloned()
}

/// The parts of the viewport for the render and for what stands beside it.
pub fn split(area: Rect, desk: &Desk) -> (Rect, Option<Rect>) {
    if desk.shared.compare.is_on || shown_at(desk, ReferencePlace::Beside).is_none() {
        return (area, None);
    }
    let (left, right) = area.split_left_right_at_fraction(0.5);
    let right = right.with_min_x(right.left() + 3.0);
    (left, Some(right))
}

/// Shows it beside the render.
pub fn beside(ui: &Ui, area: Rect, desk: &mut Desk) {
    paint(ui, (area, area), ReferencePlace::Beside, desk);
}

/// Shows it in the frame of the render, behind or over that; true where it is behind and there.
pub fn within(ui: &Ui, clip: Rect, frame: Rect, place: ReferencePlace, desk: &mut Desk) -> bool {
    paint(ui, (clip.intersect(frame), frame), place, desk)
}

/// Paints it into a frame, as large as fits with its own shape; false where it is not there.
fn paint(ui: &Ui, (clip, frame): (Rect, Rect), place: ReferencePlace, desk: &mut Desk) -> bool {
    let Some(reference) = shown_at(desk, place) else {
        return false;
    };
    let Some(texture) = desk.shared.reference.texture(ui.ctx(), &reference.file) else {
        return false;
    };
    let at = fitted(frame, texture.size_vec2());
    let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
    let tint = Color32::WHITE.gamma_multiply(reference.opacity.clamp(0.0, 1.0));
    ui.painter_at(clip).image(texture.id(), at, whole, tint);
    let seen = ui.interact(at.intersect(clip), Id::unique("reference image"), Sense::hover());
    let name = format!("Reference image {}", place.label().to_lowercase());
    widgets::describe(&seen, Role::Image, &name);
    true
}
