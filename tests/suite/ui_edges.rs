//! Rough edges of the window: endings of saved projects, hard cases that stop.

use glossmith::app::{Options, actions::Command, layout::Pane};

use super::{
    cli_support::Workplace,
    ui::{editor, editor_of, options},
};

#[test]
fn projects_are_saved_under_the_ending_of_their_kind() {
    let folder = Workplace::new();
    let mut harness = editor_of(Options {
        typed_paths: Some(folder.root().to_owned()),
        ..options()
    });
    harness.settle();
    harness.command(Command::SaveAs);
    harness.type_path(&folder.path("proj"), "Save");
    let named = folder.path("proj.glossmith.json");
    harness.wait("the project", |_| named.is_file());
}

#[test]
fn hard_cases_stop_at_once_and_are_named_in_words() {
    let mut harness = editor();
    harness.reveal(Pane::Check);
    harness.tap_label("Run the hard cases");
    harness.see_label("roughness at its ends");
    assert!(!harness.tells("roughness-at-its-ends"));
    harness.tap_label("Stop");
    // Whatever is being measured.
    assert!(harness.has("Run the hard cases"));
    assert!(harness.tells("Stopped."));
    harness.tap_label("Run the hard cases");
    harness.see_label("Stop");
    harness.tap_label("Stop");
}
