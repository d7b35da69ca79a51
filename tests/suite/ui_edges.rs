//! Rough edges of the window: endings of saved projects, hard cases that stop.

use egui_kittest::kittest::Queryable as _;
use glossmith::app::{Options, actions::Command, layout::Pane};

use super::ui::{Editor, editor, editor_of, options, see_label, settle, wait};
use super::ui_hands::{Hands as _, type_path};

/// Whether a text is shown anywhere.
fn is_shown(harness: &Editor, part: &str) -> bool {
    harness.query_all_by_label_contains(part).next().is_some()
}

#[test]
fn projects_are_saved_under_the_ending_of_their_kind() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut harness = editor_of(Options {
        typed_paths: Some(folder.path().to_owned()),
        ..options()
    });
    settle(&mut harness);
    harness.command(Command::SaveAs);
    type_path(&mut harness, &folder.path().join("proj"), "Save");
    let named = folder.path().join("proj.glossmith.json");
    wait(&mut harness, "the project", |_| named.is_file());
}

#[test]
fn hard_cases_stop_at_once_and_are_named_in_words() {
    let mut harness = editor();
    harness.reveal(Pane::Check);
    harness.get_by_label("Run the hard cases").click_accesskit();
    see_label(&mut harness, "roughness at its ends");
    assert!(!is_shown(&harness, "roughness-at-its-ends"));
    harness.tap_label("Stop");
    // Whatever is being measured.
    assert!(harness.has("Run the hard cases"));
    assert!(is_shown(&harness, "Stopped."));
    harness.get_by_label("Run the hard cases").click_accesskit();
    see_label(&mut harness, "Stop");
    harness.tap_label("Stop");
}
