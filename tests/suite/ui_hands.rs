//! What hands do and eyes see in many tests of the window.

use std::{path::Path, time::Duration, time::Instant};

use egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, Vec2, accesskit::Role};
use egui_kittest::kittest::Queryable as _;
use glossmith::{
    app::{App, actions::Action, actions::Command, layout::Pane},
    document::{Document, MaterialSettings},
};

use super::ui::{Editor, PATIENCE, assert_same_controls, controls};

impl Editor {
    pub fn document(&self) -> &Document {
        self.state().document()
    }

    /// The first one.
    pub fn material(&self) -> &MaterialSettings {
        &self.document().materials[0]
    }

    /// Whether a control or text has this label.
    pub fn has(&self, label: &str) -> bool {
        self.query_by_label(label).is_some()
    }

    /// Whether a text with these words is shown anywhere.
    pub fn tells(&self, part: &str) -> bool {
        self.query_all_by_label_contains(part).next().is_some()
    }

    /// Brings a panel to the front.
    pub fn reveal(&mut self, pane: Pane) {
        self.state_mut().reveal(pane);
        self.run_steps(4);
    }

    /// Clicks with the mouse.
    pub fn click(&mut self, role: Role, label: &str) {
        self.click_on(|harness| harness.get_by_role_and_label(role, label).rect());
    }

    /// Clicks with the mouse where something is.
    pub fn click_on(&mut self, place: impl Fn(&Editor) -> Rect) {
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

    /// Clicks as a screen reader does, also what is covered or scrolled away.
    pub fn tap(&mut self, role: Role, label: &str) {
        self.get_by_role_and_label(role, label).click_accesskit();
        self.run_steps(3);
    }

    pub fn tap_label(&mut self, label: &str) {
        self.get_by_label(label).click_accesskit();
        self.run_steps(3);
    }

    /// Sets a number.
    pub fn set(&mut self, label: &str, value: f64) {
        self.get_by_role_and_label(Role::SpinButton, label)
            .set_value_accesskit(value);
        self.run_steps(2);
    }

    /// Writes into a field.
    pub fn write(&mut self, label: &str, text: &str) {
        let field = self.get_by_role_and_label(Role::TextInput, label);
        field.set_text_value_accesskit(text);
        self.run_steps(2);
    }

    pub fn command(&mut self, command: Command) {
        self.request(Action::Do(command));
    }

    /// Steps until something is seen, while every control stays the one that it was: else a click under way would be lost.
    pub fn see(&mut self, what: &str, until: impl Fn(&Editor) -> bool) {
        let begun = Instant::now();
        while !until(self) {
            let before = controls(self);
            self.step();
            assert_same_controls(&before, &controls(self), what);
            let app = self.state();
            let state = (app.snapshot().activity.clone(), app.messages());
            assert!(begun.elapsed() < PATIENCE, "waited in vain for {what}: {state:?}");
            std::thread::sleep(Duration::from_millis(3));
        }
    }

    /// Steps until a control or text is there.
    pub fn see_label(&mut self, label: &str) {
        self.see(label, |harness| harness.has(label));
    }

    pub fn wait(&mut self, what: &str, until: impl Fn(&App) -> bool) {
        // What was just done is taken note of.
        self.step();
        self.see(what, |harness| until(harness.state()));
    }

    pub fn wait_for_words(&mut self, part: &str) {
        self.wait(part, |app| app.messages().iter().any(|text| text.contains(part)));
    }

    pub fn settle(&mut self) {
        // What was just done reaches the renderer with the next frame.
        self.run_steps(3);
        self.wait("a finished picture", App::is_settled);
        // The panels show what the wait ended with.
        self.step();
        self.check_accessibility();
    }

    pub fn undo(&mut self) {
        self.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        self.settle();
    }

    pub fn request(&mut self, action: Action) {
        self.state_mut().request(action);
        self.run_steps(2);
    }

    pub fn drag(&mut self, from: Pos2, by: Vec2) {
        self.hover_at(from);
        self.step();
        self.drag_at(from);
        for step in 1..=6 {
            self.step();
            self.hover_at(from + by * (step as f32 / 6.0));
        }
        self.step();
        self.drop_at(from + by);
        self.run_steps(2);
    }

    /// Presses a button, in sight or not.
    pub fn press(&mut self, label: &str) {
        self.tap(Role::Button, label);
    }

    /// Types a path where one is asked for, and presses the button behind it.
    pub fn type_path(&mut self, path: &Path, button: &str) {
        self.see("the path field", |harness| {
            harness.query_by_role_and_label(Role::TextInput, "Path").is_some()
        });
        self.check_accessibility();
        self.write("Path", &path.display().to_string());
        self.press(button);
        self.step();
    }
}
