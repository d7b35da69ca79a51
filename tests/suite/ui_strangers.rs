//! The window's question about files that others name elsewhere.

use std::path::PathBuf;

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable as _;
use glossmith::app::actions::Action;
use glossmith::document::Document;
use glossmith::scene::ModelSource;
use glossmith::store::save_document;
use serde_json::Value as Json;

use super::gltf_builder::Folder;
use super::ui::{Editor, editor, request, see_label, wait};
use super::ui_files::says;

const QUESTION: &str = "Read files from elsewhere?";
const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn press(harness: &mut Editor, label: &str) {
    harness.get_by_role_and_label(Role::Button, label).click_accesskit();
    harness.run_steps(3);
}

fn asks(harness: &mut Editor) -> bool {
    harness.run_steps(3);
    harness.query_by_label(QUESTION).is_some()
}

/// A model, and a folder two below it.
fn place() -> (Folder, PathBuf, PathBuf) {
    let folder = Folder::new();
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
    request(&mut harness, Action::Open(own.clone()));
    wait(&mut harness, "one's own project", |app| {
        app.document().model == document.model
    });
    assert!(!asks(&mut harness));
    drop(harness);
    // As an older version saved it: without the mark.
    let mut text: Json = serde_json::from_str(&std::fs::read_to_string(&own).unwrap()).unwrap();
    assert!(text.as_object_mut().unwrap().remove("saved-by").is_some());
    let old = inner.join("old.json");
    std::fs::write(&old, text.to_string()).unwrap();
    let mut harness = editor();
    let before = harness.state().document().clone();
    request(&mut harness, Action::Open(old.clone()));
    see_label(&mut harness, QUESTION);
    harness.check_accessibility();
    assert!(harness.query_all_by_label_contains("far.obj").count() > 0);
    press(&mut harness, "Deny");
    assert_eq!(*harness.state().document(), before);
    assert!(says(&harness, "--allow-outside"));
    drop(harness);
    let mut harness = editor();
    request(&mut harness, Action::Open(old.clone()));
    see_label(&mut harness, QUESTION);
    press(&mut harness, "Allow");
    wait(&mut harness, "the old project", |app| {
        app.document().model == document.model
    });
    // Asked once: not of this window, and not of the next.
    let mut next = editor();
    request(&mut next, Action::Open(old));
    wait(&mut next, "the old project", |app| {
        app.document().model == document.model
    });
    assert!(!asks(&mut next) && !asks(&mut harness));
}

/// A window asks about what its own files name, and about nothing that others load beside it.
#[test]
fn a_window_asks_about_its_own_files_alone() {
    let (folder, inner, _) = place();
    std::fs::write(folder.path("far.mtl"), "newmtl m\n").unwrap();
    let model = inner.join("m.obj");
    std::fs::write(&model, format!("mtllib ../../far.mtl\n{TRIANGLE}")).unwrap();
    let (mut harness, mut other) = (editor(), editor());
    request(&mut harness, Action::Open(model.clone()));
    let is_told = |app: &glossmith::app::App| app.messages().iter().any(|text| text.contains("far.mtl"));
    // The frames of the other window come first.
    for _ in 0..50 {
        assert!(!asks(&mut other));
    }
    see_label(&mut harness, QUESTION);
    assert!(is_told(harness.state()) && !is_told(other.state()));
    press(&mut harness, "Deny");
    // A graph that names a picture elsewhere is asked about as well.
    std::fs::write(folder.path("far.png"), super::gltf_builder::png()).unwrap();
    let graph = inner.join("m.mtlx");
    let image = r#"<image name="i" type="color3"><input name="file" type="filename" value="../../far.png"/></image>"#;
    let text = format!(
        r#"<materialx version="1.39">{image}<standard_surface name="s" type="surfaceshader"><input name="base_color" type="color3" nodename="i"/></standard_surface></materialx>"#
    );
    std::fs::write(&graph, text).unwrap();
    request(&mut harness, Action::Open(graph));
    see_label(&mut harness, QUESTION);
    assert!(harness.query_all_by_label_contains("far.png").count() > 0);
    assert!(!asks(&mut other));
}
