//! The two workspaces and the user's own, the calm status bar, the first minute, and what the palette finds.

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable as _;
use glossmith::{
    app::{
        Options, Resolution,
        actions::{Action, Command},
        layout::Pane,
        workspaces::{Change, LOOK, MEASURE},
    },
    render::EngineChoice,
    scene::ModelSource,
    store::{PRESETS, examples::still_life, load_document, save_document},
};

use super::{
    cli_support::Workplace,
    renders::adjust,
    ui::{Editor, Memory, editor_of, editor_remembering, options},
};

/// An editor as a user starts it.
fn at_first() -> Editor {
    let mut harness = editor_remembering(
        Memory::default(),
        Options {
            workspace: None,
            ..options()
        },
    );
    harness.settle();
    harness
}

fn use_workspace(harness: &mut Editor, name: &str) {
    harness.tap_label(&format!("Workspace {name}"));
}

/// Nothing of errors and costs is in sight at the start; one click brings all of it, and one takes it away.
#[test]
fn the_window_begins_with_looks_and_measures_where_that_is_asked_for() {
    let mut harness = at_first();
    let before = harness.document().clone();
    for pane in [Pane::Convergence, Pane::Race, Pane::Effects, Pane::Check, Pane::Samples] {
        assert!(
            harness.query_all_by_label(pane.title()).next().is_none(),
            "{pane:?} at the start"
        );
    }
    for told in ["samples/s", "error ", " %", "window "] {
        assert!(!harness.tells(told), "{told:?} at the start");
    }
    assert!(harness.has("Specular roughness"), "the material");
    assert!(
        !harness.has("Specular below horizon"),
        "what the paper needs is in Measure"
    );
    use_workspace(&mut harness, MEASURE);
    assert!(harness.tells("samples/s"), "the status bar tells numbers");
    for pane in [Pane::Convergence, Pane::Race, Pane::Effects] {
        assert!(harness.query_all_by_label(pane.title()).next().is_some(), "{pane:?}");
    }
    use_workspace(&mut harness, LOOK);
    assert!(!harness.tells("samples/s"));
    assert_eq!(*harness.document(), before, "workspaces are no edit");
}

/// A workspace of the user's is saved under a name from the menu, shown again, and removed.
#[test]
fn a_workspace_of_ones_own_is_saved_and_removed() {
    let mut harness = at_first();
    harness.reveal(Pane::Log);
    harness.tap_label("Workspaces");
    harness.get_by_role_and_label(Role::TextInput, "Workspace name").focus();
    harness.run_steps(2);
    harness
        .get_by_role_and_label(Role::TextInput, "Workspace name")
        .type_text("Shots");
    harness.run_steps(2);
    harness.tap_label("Save workspace");
    assert!(harness.has("Workspace Shots"), "it is shown");
    use_workspace(&mut harness, LOOK);
    assert!(harness.query_all_by_label(Pane::Log.title()).next().is_none());
    harness.request(Action::ChangeWorkspaces(Change::Use("Shots".to_owned())));
    assert!(harness.query_all_by_label(Pane::Log.title()).next().is_some());
    harness.request(Action::ChangeWorkspaces(Change::Remove("Shots".to_owned())));
    assert!(!harness.has("Workspace Shots"));
    assert!(harness.has("Workspace Look"));
}

/// The start and *New* show the still life; it is a project like any other, and its parts are objects.
#[test]
fn the_start_and_new_show_the_still_life() {
    let folder = Workplace::new();
    let mut first = still_life();
    adjust(&mut first, "render.width=48 render.height=32 render.samples=2");
    let mut harness = editor_of(Options {
        engine: EngineChoice::Cpu,
        document: Some(first.clone()),
        resolution: Some(Resolution::Document),
        ..Options::default()
    });
    harness.settle();
    let scene = harness.state().snapshot().scene.clone().expect("it was waited for");
    let names: Vec<&str> = scene.model.objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["teapot", "bowl", "ball", "bead"]);
    assert_eq!(first.materials.len(), scene.model.slots.len());
    let path = folder.path("still.json");
    save_document(&path, &first).expect("a temporary file");
    assert_eq!(load_document(&path).expect("a project").value, first);
    // A way to one's own model is in sight, until there is one.
    assert!(harness.has("Open your model…"));
    harness.request(Action::UseModel(ModelSource::Sphere));
    harness.wait("another model", |app| app.document().model == ModelSource::Sphere);
    harness.request(Action::UseModel(ModelSource::StillLife));
    harness.wait("the still life", |app| app.document().model == ModelSource::StillLife);
    assert_eq!(harness.document().materials, first.materials);
}

/// C shows what the material was before the last change, until something else is chosen to compare with.
#[test]
fn comparing_begins_with_what_one_had() {
    let mut harness = at_first();
    let before = harness.document().materials.clone();
    harness.request(Action::UseMaterial(Box::new(PRESETS[5].clone())));
    harness.settle();
    harness.command(Command::Compare);
    harness.wait("B", |app| {
        app.rival_snapshot().is_some_and(|rival| rival.picture.is_some())
    });
    let rival = harness.state().rival_snapshot().and_then(|rival| rival.picture.clone());
    assert_eq!(rival.map(|picture| picture.document.materials.clone()), Some(before));
}

/// A measured metal becomes one of two colours and back, each in one edit.
#[test]
fn a_metal_is_edited_by_colours_or_as_measured() {
    let mut harness = at_first();
    let gold = PRESETS
        .iter()
        .find(|preset| preset.name == "Gold")
        .expect("it is shipped");
    harness.request(Action::UseMaterial(Box::new(gold.clone())));
    harness.run_steps(3);
    let material = |harness: &Editor| harness.material().clone();
    let before = material(&harness);
    harness.tap_label("Edit as colours");
    harness.settle();
    let colored = material(&harness);
    assert_eq!(colored, before.by_colors());
    assert!(
        colored.base_color[0] > 2.0 * colored.base_color[2],
        "{:?}",
        colored.base_color
    );
    assert!(harness.has("Specular edge tint"), "the second colour");
    harness.tap_label("Measured metal…");
    harness.press("copper");
    harness.settle();
    assert_ne!(material(&harness), colored);
    harness.undo();
    assert_eq!(material(&harness), colored);
    harness.undo();
    assert_eq!(material(&harness), before);
}
