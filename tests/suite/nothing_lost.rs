//! Unsaved edits: put aside, offered after a crash, asked about before they go; and the files opened last.

use std::{path::Path, time::Duration};

use egui::{Key, ViewportCommand, ViewportEvent, ViewportId, accesskit::Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glossmith::{
    app::{App, Options, actions::Action, actions::Command},
    document::Document,
    scene::ModelSource,
    store::{PRESETS, examples::still_life, load_document, save_document},
};

use super::{
    cli_support::Workplace,
    ui::{Editor, editor_of, options},
};

/// An editor that keeps unsaved edits in a folder.
pub fn keeping_editor(data: &Path) -> Editor {
    editor_of(Options {
        data: Some(data.to_owned()),
        autosave_interval: Some(Duration::from_millis(20)),
        ..options()
    })
}

pub fn edit(harness: &mut Editor, roughness: f32) {
    harness.run_steps(3);
    harness.set("Specular roughness", f64::from(roughness));
    assert_eq!(harness.material().roughness, roughness);
}

/// Documents put aside in a data folder.
fn kept(data: &Path) -> Vec<Document> {
    let Ok(entries) = std::fs::read_dir(data.join("recovery")) else {
        return Vec::new();
    };
    let paths = entries.map(|entry| entry.expect("an entry").path());
    paths
        .filter(|path| path.extension().is_some_and(|ending| ending == "json"))
        .filter_map(|path| Some(load_document(&path).ok()?.value))
        .collect()
}

fn edit_until_kept(harness: &mut Editor, data: &Path, roughness: f32) {
    edit(harness, roughness);
    let is_kept = |document: &Document| document.materials[0].roughness == roughness;
    harness.see("the copy", |_| kept(data).iter().any(is_kept));
}

/// Asks the window to close, as its button does; whether it does.
fn closes(harness: &mut Editor) -> bool {
    let viewport = harness.input_mut().viewports.get_mut(&ViewportId::ROOT);
    viewport.expect("the window").events.push(ViewportEvent::Close);
    harness.step();
    let does_close = !commands(harness).contains(&ViewportCommand::CancelClose);
    // The window says it once.
    let viewport = harness.input_mut().viewports.get_mut(&ViewportId::ROOT);
    viewport.expect("the window").events.clear();
    harness.run_steps(2);
    does_close
}

fn commands(harness: &Editor) -> Vec<ViewportCommand> {
    harness.output().viewport_output[&ViewportId::ROOT].commands.clone()
}

/// Frames until the program closes the window itself.
fn closes_by_itself(harness: &mut Editor) {
    harness.see("the window to close", |harness| {
        commands(harness).contains(&ViewportCommand::Close)
    });
    assert!(closes(harness));
}

fn asks(harness: &Editor) -> bool {
    harness.query_by_role_and_label(Role::Button, "Discard").is_some()
}

#[test]
fn what_a_crash_left_is_offered_and_restored() {
    let folder = Workplace::new();
    let mut crashed = keeping_editor(folder.root());
    edit_until_kept(&mut crashed, folder.root(), 0.71);
    let document = crashed.state().document().clone();
    let mut harness = keeping_editor(folder.root());
    harness.wait("the start", |app| app.snapshot().engine.is_some());
    // A process that is killed holds its file for a while.
    drop(crashed);
    harness.see("the offer", |harness| harness.has("Unsaved work was found"));
    harness.check_accessibility();
    assert_ne!(*harness.document(), document);
    // The button has the focus.
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    assert!(!harness.has("Unsaved work was found"));
    assert_eq!(*harness.document(), document);
    assert!(!closes(&mut harness), "it is still unsaved");
    harness.see("one file, of this window", |_| kept(folder.root()).len() == 1);
    harness.press("Discard");
    harness.step();
    eframe::App::on_exit(harness.state_mut());
    drop(harness);
    assert_eq!(
        kept(folder.root()).len(),
        0,
        "closed as it should be, it leaves nothing"
    );
}

/// Models are read in C, whose faults end the program: what was edited last is in the file by then.
#[test]
fn edits_are_put_aside_before_a_model_is_read() {
    for (roughness, action) in [
        (
            0.31,
            Action::UseModel(ModelSource::File(
                Path::new(crate::ROOT).join("fuzz/corpus/obj/plate.obj"),
            )),
        ),
        (0.32, Action::Do(Command::Reload)),
    ] {
        let folder = Workplace::new();
        let mut harness = editor_of(Options {
            data: Some(folder.root().to_owned()),
            autosave_interval: Some(Duration::from_secs(3600)),
            ..options()
        });
        harness.wait("the start", App::is_settled);
        // The first edit is put aside at once, the second one an hour later.
        edit_until_kept(&mut harness, folder.root(), 0.9);
        edit(&mut harness, roughness);
        harness.request(action);
        harness.wait("the model", |app| !app.is_opening());
        let left: Vec<f32> = kept(folder.root()).iter().map(|d| d.materials[0].roughness).collect();
        assert_eq!(left, [roughness]);
    }
}

#[test]
fn a_leftover_stays_until_it_is_decided_about() {
    let folder = Workplace::new();
    let mut crashed = keeping_editor(folder.root());
    edit_until_kept(&mut crashed, folder.root(), 0.37);
    drop(crashed);
    let offers = |harness: &Editor| harness.has("Unsaved work was found");
    for is_discarded in [false, true] {
        let mut harness = keeping_editor(folder.root());
        harness.see("the offer", offers);
        if is_discarded {
            harness.press("Discard untitled");
        } else {
            harness.key_press(Key::Escape);
        }
        harness.run_steps(2);
        assert!(!offers(&harness));
        eframe::App::on_exit(harness.state_mut());
        drop(harness);
        assert_eq!(kept(folder.root()).len(), usize::from(!is_discarded));
    }
}

#[test]
fn two_windows_keep_their_edits_apart() {
    let folder = Workplace::new();
    let mut first = keeping_editor(folder.root());
    edit_until_kept(&mut first, folder.root(), 0.21);
    let mut second = keeping_editor(folder.root());
    edit_until_kept(&mut second, folder.root(), 0.84);
    assert!(
        second.query_by_label("Unsaved work was found").is_none(),
        "the first window's edits are not lost"
    );
    eframe::App::on_exit(second.state_mut());
    drop(second);
    let left: Vec<f32> = kept(folder.root()).iter().map(|d| d.materials[0].roughness).collect();
    assert_eq!(left, [0.21]);
    drop(first);
}

#[test]
fn closing_asks_about_unsaved_edits_and_cancel_means_cancel() {
    let mut harness = editor_of(options());
    harness.run_steps(3);
    assert!(closes(&mut harness), "there is nothing to lose");
    let mut harness = editor_of(options());
    edit(&mut harness, 0.5);
    let document = harness.document().clone();
    assert!(!closes(&mut harness));
    harness.run_steps(2);
    assert!(asks(&harness));
    harness.check_accessibility();
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert!(!asks(&harness) && *harness.document() == document);
    assert!(!closes(&mut harness));
    harness.press("Cancel");
    assert!(!commands(&harness).contains(&ViewportCommand::Close));
    assert!(!closes(&mut harness));
    // By keyboard: past "Save" to "Discard".
    for focused in ["Save", "Discard"] {
        harness.run_steps(2);
        let button = harness.get_by_role_and_label(Role::Button, focused);
        assert!(button.accesskit_node().is_focused(), "{focused}");
        if focused == "Save" {
            harness.key_press(Key::Tab);
        }
    }
    // Only down: the frame of letting go would hide what this one asked for.
    harness.key_down(Key::Enter);
    harness.step();
    closes_by_itself(&mut harness);
}

#[test]
fn closing_saves_first_where_that_was_chosen() {
    let folder = Workplace::new();
    let project = folder.path("project.json");
    save_document(&project, &options().document.expect("given")).expect("a temporary file");
    let mut harness = editor_of(Options {
        files: vec![project.clone()],
        ..options()
    });
    harness.wait("the start", App::is_settled);
    edit(&mut harness, 0.5);
    assert!(!closes(&mut harness));
    // No frame goes by unseen: one of the next says that the window closes.
    harness.get_by_role_and_label(Role::Button, "Save").click_accesskit();
    closes_by_itself(&mut harness);
    let saved = load_document(&project).expect("a project").value;
    assert_eq!(saved, *harness.document());
    assert_eq!(saved.materials[0].roughness, 0.5);
}

#[test]
fn new_and_open_ask_and_what_can_be_undone_does_not() {
    let folder = Workplace::new();
    let project = folder.path("project.json");
    let other = Document {
        ground: true,
        ..options().document.expect("given")
    };
    save_document(&project, &other).expect("a temporary file");
    let mut harness = editor_of(options());
    edit(&mut harness, 0.5);
    let document = harness.document().clone();
    harness.command(Command::New);
    harness.see("the question", asks);
    harness.press("Cancel");
    assert_eq!(*harness.document(), document);
    harness.request(Action::Open(project.clone()));
    harness.see("the question", asks);
    assert_eq!(*harness.document(), document);
    harness.press("Discard");
    harness.run_steps(2);
    assert_eq!(*harness.document(), other);
    harness.request(Action::UseMaterial(Box::new(PRESETS[2].clone())));
    harness.run_steps(3);
    assert!(!asks(&harness));
    harness.command(Command::New);
    harness.see("the question", asks);
    harness.press("Discard");
    harness.run_steps(2);
    // The document of the start, whose noise is taken out as before.
    let mut first = still_life();
    first.view.denoise = other.view.denoise;
    assert_eq!(*harness.document(), first);
    harness.command(Command::New);
    harness.run_steps(3);
    assert!(!asks(&harness), "a new document holds nothing to lose");
}
