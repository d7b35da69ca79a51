//! The window's question about files that others name elsewhere.

use std::path::PathBuf;

use glossmith::{app::actions::Action, document::Document, scene::ModelSource, store::save_document};
use serde_json::Value as Json;

use super::{
    cli_support::Workplace,
    ui::{Editor, editor},
    ui_files::says,
};

const QUESTION: &str = "Read files from elsewhere?";
const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn asks(harness: &mut Editor) -> bool {
    harness.run_steps(3);
    harness.has(QUESTION)
}

/// A model, and a folder two below it.
fn place() -> (Workplace, PathBuf, PathBuf) {
    let folder = Workplace::new();
    let inner = folder.path("a/b");
    std::fs::create_dir_all(&inner).unwrap();
    let model = folder.path("far.obj");
    std::fs::write(&model, TRIANGLE).unwrap();
    (folder, inner, model)
}

#[test]
fn a_project_from_elsewhere_is_asked_about_once_and_ones_own_never() {
    let (_folder, inner, model) = place();
    let document = Document {
        model: ModelSource::File(model.clone()),
        ..super::worker::small_document()
    };
    // Saved on this machine: it opens what its maker opened.
    let own = inner.join("own.json");
    save_document(&own, &document).unwrap();
    let mut harness = editor();
    harness.request(Action::Open(own.clone()));
    harness.wait("one's own project", |app| app.document().model == document.model);
    assert!(!asks(&mut harness));
    drop(harness);
    // As an older version saved it: without the mark.
    let mut text: Json = serde_json::from_str(&std::fs::read_to_string(&own).unwrap()).unwrap();
    assert!(text.as_object_mut().unwrap().remove("saved-by").is_some());
    let old = inner.join("old.json");
    std::fs::write(&old, text.to_string()).unwrap();
    let mut harness = editor();
    let before = harness.document().clone();
    harness.request(Action::Open(old.clone()));
    harness.see_label(QUESTION);
    harness.check_accessibility();
    assert!(harness.tells("far.obj"));
    harness.press("Deny");
    assert_eq!(*harness.document(), before);
    assert!(says(&harness, "--allow-outside"));
    drop(harness);
    let mut harness = editor();
    harness.request(Action::Open(old.clone()));
    harness.see_label(QUESTION);
    harness.press("Allow");
    harness.wait("the old project", |app| app.document().model == document.model);
    // Asked once: not of this window, and not of the next.
    let mut next = editor();
    next.request(Action::Open(old));
    next.wait("the old project", |app| app.document().model == document.model);
    assert!(!asks(&mut next) && !asks(&mut harness));
}
