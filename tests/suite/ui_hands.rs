//! What hands do in many tests of the window.

use std::path::Path;

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable as _;

use super::ui::{Editor, see};

/// Presses a button.
pub(super) fn press(harness: &mut Editor, label: &str) {
    harness.get_by_role_and_label(Role::Button, label).click();
    harness.run_steps(3);
}

/// Types a path where one is asked for, and presses the button behind it.
pub(super) fn type_path(harness: &mut Editor, path: &Path, button: &str) {
    see(harness, "the path field", |harness| {
        harness.query_by_role_and_label(Role::TextInput, "Path").is_some()
    });
    let field = harness.get_by_role_and_label(Role::TextInput, "Path");
    field.set_text_value_accesskit(&path.display().to_string());
    harness.run_steps(2);
    harness.get_by_role_and_label(Role::Button, button).click_accesskit();
    harness.run_steps(4);
}
