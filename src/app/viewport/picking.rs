//! What of the scene the pointer is over in the viewport, what a click chooses, and materials that are dropped there.

use super::seen::{hit_at, pixel_at};
use super::*;
use crate::{
    document::MaterialSettings,
    services::{look::SeenSurface, selection::Thing, viewing::Pick},
};

/// Lights up what the pointer is over while the tree of the scene is shown, and what a material would be dropped on; gives
/// it the material where that is dropped.
pub fn hover(ui: &Ui, response: &Response, place: Rect, scene: &Scene, desk: &mut Desk) {
    let is_dropping = DragAndDrop::has_payload_of_type::<MaterialSettings>(ui.ctx());
    if !(is_dropping || desk.shared.selection.was_shown) || !response.contains_pointer() {
        return;
    }
    let pointer = ui.input(|input| input.pointer.latest_pos());
    let seen = pointer.and_then(|at| hit_at(pixel_at(at, place, scene)?, scene));
    let thing = seen.and_then(|seen| match is_dropping {
        true => seen.slot.map(Thing::Slot),
        false => seen.object.map(Thing::Object),
    });
    if let Some(thing) = thing {
        desk.shared.selection.hovered = Some(thing);
    }
    if let Some((slot, at)) = seen.and_then(|seen| seen.slot).zip(pointer).filter(|_| is_dropping) {
        let name = format!("Drop on {}", desk.document.material(slot).name);
        let below = at + vec2(70.0, 24.0);
        let colors = [Color32::from_black_alpha(170), Color32::WHITE];
        plate(ui.painter(), Align2::LEFT_TOP, below, &name, colors);
        let told = ui.interact(
            Rect::from_min_size(below, Vec2::ZERO),
            Id::unique("drop target"),
            Sense::hover(),
        );
        widgets::describe(&told, Role::Label, &name);
    }
    if let Some(material) = response.dnd_release_payload::<MaterialSettings>()
        && let Some(slot) = seen.and_then(|seen| seen.slot)
    {
        desk.drop_on(slot, &material);
    }
}

/// Whether a click was for more than choosing: ctrl stands for the focus.
pub fn is_picked(seen: &SeenSurface, is_focus: bool, desk: &mut Desk) -> bool {
    let focus = is_focus.then_some(Pick::Focus);
    match focus.or(desk.shared.viewing.picks) {
        Some(Pick::Focus) if desk.document.camera.aperture > 0.0 => {
            desk.document.camera.focus_distance = Some(seen.depth);
            desk.edits.did("Focus");
        }
        Some(Pick::Angle) => desk.shared.view_angle_deg = seen.view_angle_deg,
        Some(Pick::Highlight(number)) => {
            let Some(light) = desk.document.lighting.area_lights.get_mut(number) else {
                desk.shared.viewing.picks = None;
                return false;
            };
            light.put_highlight(seen.place, seen.mirrored);
            desk.edits.did("Place highlight");
        }
        _ => return false,
    }
    desk.shared.viewing.picks = None;
    true
}

/// Chooses what was clicked: its material, and while the tree of the scene is shown the object.
pub fn choose(seen: &SeenSurface, beside_others: bool, desk: &mut Desk) {
    let selection = &mut desk.shared.selection;
    if let Some(object) = seen.object.filter(|_| selection.was_shown) {
        selection.choose_object(object, beside_others);
    }
    let Some(slot) = seen.slot else { return };
    if beside_others && slot != selection.slot {
        selection.choose_also(slot);
    } else if !beside_others {
        desk.actions.push(Action::SelectSlot(slot));
    }
}
