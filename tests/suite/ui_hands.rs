//! What hands do and eyes see in many tests of the window.

use std::path::Path;

use egui::{Event, Modifiers, PointerButton, Rect, accesskit::Role};
use egui_kittest::kittest::Queryable as _;
use glossmith::{
    app::actions::{Action, Command},
    app::layout::Pane,
    document::Document,
};

use super::ui::{Editor, request, see};

pub(super) trait Hands {
    fn document(&self) -> &Document;
    /// Whether a control or text has this label.
    fn has(&self, label: &str) -> bool;
    /// Brings a panel to the front.
    fn reveal(&mut self, pane: Pane);
    /// Clicks with the mouse.
    fn click(&mut self, role: Role, label: &str);
    /// Clicks with the mouse where something is.
    fn click_on(&mut self, place: impl Fn(&Editor) -> Rect);
    /// Clicks as a screen reader does, also what is covered or scrolled away.
    fn tap(&mut self, role: Role, label: &str);
    fn tap_label(&mut self, label: &str);
    /// Sets a number.
    fn set(&mut self, label: &str, value: f64);
    /// Writes into a field.
    fn write(&mut self, label: &str, text: &str);
    fn command(&mut self, command: Command);
}

impl Hands for Editor {
    fn document(&self) -> &Document {
        self.state().document()
    }

    fn has(&self, label: &str) -> bool {
        self.query_by_label(label).is_some()
    }

    fn reveal(&mut self, pane: Pane) {
        self.state_mut().reveal(pane);
        self.run_steps(4);
    }

    fn click(&mut self, role: Role, label: &str) {
        self.click_on(|harness| harness.get_by_role_and_label(role, label).rect());
    }

    fn click_on(&mut self, place: impl Fn(&Editor) -> Rect) {
        self.hover_at(place(self).center());
        self.step();
        // That frame may have moved it, as a thread's answer does. A button hits what the last frame has there.
        let pos = place(self).center();
        for pressed in [true, false] {
            self.event(Event::PointerButton {
                pos,
                button: PointerButton::Primary,
                pressed,
                modifiers: Modifiers::NONE,
            });
        }
        self.run_steps(3);
    }

    fn tap(&mut self, role: Role, label: &str) {
        self.get_by_role_and_label(role, label).click_accesskit();
        self.run_steps(3);
    }

    fn tap_label(&mut self, label: &str) {
        self.get_by_label(label).click_accesskit();
        self.run_steps(3);
    }

    fn set(&mut self, label: &str, value: f64) {
        self.get_by_role_and_label(Role::SpinButton, label)
            .set_value_accesskit(value);
        self.run_steps(2);
    }

    fn write(&mut self, label: &str, text: &str) {
        let field = self.get_by_role_and_label(Role::TextInput, label);
        field.set_text_value_accesskit(text);
        self.run_steps(2);
    }

    fn command(&mut self, command: Command) {
        request(self, Action::Do(command));
    }
}

/// Presses a button, in sight or not.
pub(super) fn press(harness: &mut Editor, label: &str) {
    harness.tap(Role::Button, label);
}

/// Types a path where one is asked for, and presses the button behind it.
pub(super) fn type_path(harness: &mut Editor, path: &Path, button: &str) {
    see(harness, "the path field", |harness| {
        harness.query_by_role_and_label(Role::TextInput, "Path").is_some()
    });
    harness.check_accessibility();
    harness.write("Path", &path.display().to_string());
    press(harness, button);
    harness.step();
}
