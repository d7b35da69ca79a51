//! Notes over the viewport about what was saved, in the workspace *Look*, which has no log.

use std::path::Path;

use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glossmith::{
    app::{App, Options, actions::Action, actions::Command, library::Change, workspaces::LOOK},
    store::PRESETS,
};

use super::{
    cli_support::{Workplace, read_exr},
    ui::{Editor, editor_of, options, picture},
    worker::small_document,
};

/// A window of so many samples whose own files are in `folder`.
fn editor(folder: &Path, samples: u32) -> Editor {
    let mut document = small_document();
    document.render.samples = samples;
    editor_of(Options {
        document: Some(document),
        workspace: Some(LOOK.to_owned()),
        data: Some(folder.join("data")),
        typed_paths: Some(folder.to_owned()),
        ..options()
    })
}

/// The name of the button of a note about an image that is not finished.
const RENDER: &str = "Render to a file… of message";

fn save(harness: &mut Editor, command: Command, path: &Path, note: &str) {
    harness.command(command);
    harness.type_path(path, "Save");
    harness.see_label(note);
}

/// Closes the note that is shown last.
fn close(harness: &mut Editor) {
    let is_close = |label: &str| label.starts_with("Close message");
    let mut labels = harness
        .query_all_by_role(Role::Button)
        .filter_map(|node| node.accesskit_node().label());
    let label = labels.find(|label| is_close(label)).expect("a note");
    drop(labels);
    harness.press(&label);
}

#[test]
fn each_save_is_reported_over_the_viewport() {
    let folder = Workplace::new();
    let path = |name: &str| folder.path(name);
    let mut harness = editor(folder.root(), 3);
    harness.settle();
    for (command, name, note) in [
        (Command::SavePicture, "shown.png", "Saved shown.png: 3 samples"),
        (Command::SaveLayers, "deep.exr", "Saved deep.exr: layers, 3 samples"),
        (Command::SaveMaterial, "mine.json", "Saved mine.json"),
        (Command::SaveAs, "scene.json", "Saved scene.json"),
        (Command::SaveAs, "scene.png", "Saved scene.png: 3 samples"),
    ] {
        save(&mut harness, command, &path(name), note);
        assert!(path(name).is_file() && !harness.tells("Render to a file"));
        close(&mut harness);
        assert!(!harness.tells(note));
    }
    // Saved again without being asked for a name.
    harness.command(Command::Save);
    harness.see_label("Saved scene.json");
    close(&mut harness);
    harness.command(Command::CopyPicture);
    harness.see_label("Copied the image: 3 samples");
    close(&mut harness);
    harness.request(Action::ChangeSnapshots(Change::Add));
    harness.see("the snapshot", |harness| harness.tells("Pinned "));
    close(&mut harness);
    harness.request(Action::ChangeLibrary(Change::Add));
    harness.see("the preset", |harness| {
        harness.tells(".json: one of your presets") && harness.has("New name")
    });
    harness.key_press(egui::Key::Escape);
    harness.run_steps(2);
    close(&mut harness);
    harness.command(Command::Export);
    harness.type_path(&path("out.mtlx"), "Save");
    harness.see_label("Write the file");
    harness.run_steps(3);
    harness.press("Write the file");
    harness.see_label("Exported out.mtlx");
    close(&mut harness);
    harness.command(Command::QueuePicture);
    harness.type_path(&path("queued.png"), "Save");
    harness.see("the render", |harness| harness.tells("queued.png: 3 samples"));
    harness.check_accessibility();
}

/// What is written was shown when it was asked for, whatever is edited while its path is chosen.
#[test]
fn a_save_is_of_what_was_shown() {
    let folder = Workplace::new();
    let mut harness = editor(folder.root(), 3);
    for (command, name) in [(Command::SavePicture, "shown.exr"), (Command::SaveLayers, "deep.exr")] {
        harness.request(Action::UseMaterial(Box::default()));
        harness.settle();
        let shown = picture(&harness);
        harness.command(command);
        harness.request(Action::UseMaterial(Box::new(PRESETS[5].clone())));
        harness.wait("the edit", App::is_settled);
        assert_ne!(picture(&harness), shown);
        harness.type_path(&folder.path(name), "Save");
        harness.see("the note", |harness| harness.tells(&format!("Saved {name}")));
        assert_eq!(read_exr(&folder.path(name)).pixels, shown, "{name}");
    }
}

/// The screenshot comes from the GPU that paints the window.
#[test]
fn a_screenshot_is_reported() {
    let folder = Workplace::new();
    let mut harness = editor(folder.root(), 3);
    harness.settle();
    save(
        &mut harness,
        Command::SaveWindow,
        &folder.path("window.png"),
        "Saved window.png: 1280 × 720 pixels",
    );
}

/// An image that is not finished is reported as such, with a way to finish it.
#[test]
fn a_save_of_an_unfinished_image_offers_to_render_it() {
    let folder = Workplace::new();
    let mut harness = editor(folder.root(), 60_000);
    harness.command(Command::Pause);
    harness.see("the first image", |harness| {
        let snapshot = harness.state().snapshot();
        snapshot.activity == glossmith::render::worker::Activity::Paused && snapshot.picture.is_some()
    });
    for (command, name, saved) in [
        (Command::SavePicture, "tut1.png", "Saved tut1.png: "),
        (Command::SaveLayers, "tut1.exr", "Saved tut1.exr: layers, "),
    ] {
        let snapshot = harness.state().snapshot();
        // Layers are made of the newest samples.
        let count = match command {
            Command::SaveLayers => snapshot.progress.samples_per_pixel,
            _ => snapshot.picture.as_ref().expect("it was waited for").samples_per_pixel,
        };
        let note = format!("{saved}{count} of 60000 samples");
        save(&mut harness, command, &folder.path(name), &note);
        assert!(harness.tells(RENDER));
        close(&mut harness);
        assert!(!harness.tells(RENDER));
    }
    harness.command(Command::CopyPicture);
    harness.see("the copy", |harness| harness.tells(RENDER));
    harness.click_on(|harness| harness.get_by_label_contains(RENDER).rect());
    harness.type_path(&folder.path("whole.png"), "Save");
    harness.see("the queue", |harness| harness.tells("whole.png"));
}
