//! Drags that escape takes back, and steps by the arrow keys.

use egui::*;

use super::keys::hold_arrows;

/// Share of the pointer's way that counts with shift.
const FINE: f32 = 0.1;

/// A drag of something that has a state.
pub struct Drag<S> {
    id: Id,
    start: S,
    from: Pos2,
}

/// Where a drag began and where it is, and whether it goes in steps.
pub struct Pulled {
    pub from: Pos2,
    pub to: Pos2,
    pub snaps: bool,
}

impl<S: Copy> Drag<S> {
    /// The state that a drag of the control makes of the present one, and whether a drag began or ended with it.
    pub fn follow(
        held: &mut Option<Self>,
        ui: &Ui,
        response: &Response,
        now: S,
        pulled: impl FnOnce(&S, Pulled) -> S,
    ) -> (S, bool) {
        let mut begins = false;
        let id = response.id;
        if response.drag_started_by(PointerButton::Primary)
            && let Some(from) = ui.input(|input| input.pointer.press_origin())
        {
            begins = true;
            *held = Some(Self { id, start: now, from });
        }
        let Some(Self { start, from, .. }) = held.take_if(|held| held.id == id) else {
            return (now, false);
        };
        // It ends the drag for the interface, too.
        if ui.input(|input| input.key_pressed(Key::Escape)) {
            return (start, false);
        }
        if !response.dragged() {
            return (now, true);
        }
        *held = Some(Self { id, start, from });
        let to = response.interact_pointer_pos().unwrap_or(from);
        if to == from {
            return (start, begins);
        }
        let modifiers = ui.input(|input| input.modifiers);
        let share = if modifiers.shift { FINE } else { 1.0 };
        let pull = Pulled {
            from,
            to: from + share * (to - from),
            snaps: modifiers.command,
        };
        (pulled(&start, pull), begins)
    }
}

/// The size of a step with ctrl.
pub const LARGE_STEP: f32 = 15.0;

/// How often the arrow keys were pressed for this frame, to the right and up.
pub fn arrows(ui: &Ui, modifiers: Modifiers) -> Vec2 {
    let count = |key| ui.input_mut(|input| input.count_and_consume_key(modifiers, key)) as f32;
    let across = count(Key::ArrowRight) - count(Key::ArrowLeft);
    vec2(across, count(Key::ArrowUp) - count(Key::ArrowDown))
}

/// Steps by the arrow keys, where the control has the focus: with shift small ones, with ctrl large ones.
pub fn steps(ui: &Ui, response: &Response, upwards: bool) -> Vec2 {
    if !response.has_focus() {
        return Vec2::ZERO;
    }
    hold_arrows(ui, response, true, upwards);
    LARGE_STEP * arrows(ui, Modifiers::COMMAND) + 0.1 * arrows(ui, Modifiers::SHIFT) + arrows(ui, Modifiers::NONE)
}

/// In [−180, 180).
pub fn wrapped_deg(angle: f32) -> f32 {
    (angle + 180.0).rem_euclid(360.0) - 180.0
}
