//! The presets panel: the user's own materials, and pictures of all of them.

use std::path::Path;

use egui::Key;
use egui::accesskit::Role;
use egui_kittest::kittest::Queryable as _;
use glossmith::app::Options;
use glossmith::app::actions::{Action, Command};
use glossmith::document::MaterialSettings;
use glossmith::render::thumbnails::key;
use glossmith::store::{PRESETS, load_material};

use super::support::is_thorough;
use super::ui::{Editor, editor_of, options, request, see, wait};
use super::ui_hands::press;

/// An editor with the user's folder, its panel showing only what has this in its name.
fn editor_showing(data: &Path, name: &str) -> Editor {
    let mut harness = editor_of(Options {
        data: Some(data.to_owned()),
        ..options()
    });
    harness.run_steps(3);
    let search = harness.get_by_role_and_label(Role::TextInput, "Search presets");
    search.set_text_value_accesskit(name);
    harness.run_steps(2);
    harness
}

fn has_button(harness: &Editor, label: &str) -> bool {
    harness.query_by_role_and_label(Role::Button, label).is_some()
}

fn files(folder: &Path) -> Vec<MaterialSettings> {
    let entries = std::fs::read_dir(folder).map(|entries| entries.flatten().collect::<Vec<_>>());
    let paths = entries.unwrap_or_default().into_iter().map(|entry| entry.path());
    paths.map(|path| load_material(&path).expect("whole").value).collect()
}

#[test]
fn own_presets_are_saved_found_again_used_renamed_and_deleted() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut own = PRESETS[3].clone();
    own.name = "Zebra".to_owned();
    own.roughness = 0.77;
    let mut harness = editor_showing(folder.path(), "Zebra");
    request(&mut harness, Action::UseMaterial(Box::new(own.clone())));
    request(&mut harness, Action::Do(Command::SaveToMyPresets));
    // Its name is asked for, and begins as the material's.
    see(&mut harness, "the name", |harness| {
        harness.query_by_role_and_label(Role::TextInput, "New name").is_some()
    });
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    see(&mut harness, "the preset", |harness| has_button(harness, "Zebra"));
    assert_eq!(files(&folder.path().join("materials")), [own.clone()]);
    // Closed as it should be: nothing unsaved is offered at the next start.
    eframe::App::on_exit(harness.state_mut());
    drop(harness);

    let mut harness = editor_showing(folder.path(), "Z");
    see(&mut harness, "the preset", |harness| has_button(harness, "Zebra"));
    harness.check_accessibility();
    assert_ne!(harness.state().document().materials[0], own);
    press(&mut harness, "Zebra");
    assert_eq!(harness.state().document().materials[0], own);

    press(&mut harness, "Rename, export or delete Zebra");
    press(&mut harness, "Rename");
    let field = harness.get_by_role_and_label(Role::TextInput, "New name");
    field.set_text_value_accesskit("Zinc");
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    see(&mut harness, "the new name", |harness| has_button(harness, "Zinc"));
    assert!(!has_button(&harness, "Zebra"));
    own.name = "Zinc".to_owned();
    assert_eq!(files(&folder.path().join("materials")), [own.clone()]);

    press(&mut harness, "Rename, export or delete Zinc");
    press(&mut harness, "Duplicate");
    see(&mut harness, "the copy", |harness| has_button(harness, "Zinc copy"));
    press(&mut harness, "Rename, export or delete Zinc copy");
    press(&mut harness, "Delete");
    see(&mut harness, "the copy to go", |harness| {
        !has_button(harness, "Zinc copy")
    });

    press(&mut harness, "Rename, export or delete Zinc");
    press(&mut harness, "Delete");
    see(&mut harness, "it to go", |harness| !has_button(harness, "Zinc"));
    assert_eq!(files(&folder.path().join("materials")), []);
    press(&mut harness, "Restore zinc");
    see(&mut harness, "it to come back", |harness| has_button(harness, "Zinc"));
    assert_eq!(files(&folder.path().join("materials")), [own]);
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("file");
    std::fs::write(&file, "no folder").expect("a temporary file");
    let mut harness = editor_showing(&file, "");
    request(&mut harness, Action::Do(Command::SaveToMyPresets));
    wait(&mut harness, "the message", |app| {
        let is_named = |text: &String| text.contains("materials") && text.contains("permissions");
        app.messages().iter().any(is_named)
    });
    let mut harness = editor_of(options());
    request(&mut harness, Action::Do(Command::SaveToMyPresets));
    wait(&mut harness, "the message", |app| {
        app.messages()
            .iter()
            .any(|text| text.contains("no folder for your materials"))
    });
}

/// The colour in the corner of a preset's picture, beside where a dot would be.
fn corner(harness: &mut Editor, name: &str) -> [u8; 4] {
    let rect = harness.get_by_role_and_label(Role::Button, name).rect();
    let window = harness
        .render()
        .expect("a Vulkan driver: apt install mesa-vulkan-drivers");
    let at = rect.left_center() + egui::vec2(7.0, -14.0);
    window.get_pixel(at.x as u32, at.y as u32).0
}

#[test]
fn presets_show_pictures_which_are_kept() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut harness = editor_of(Options {
        cache: Some(folder.path().to_owned()),
        ..options()
    });
    harness.run_steps(3);
    let first = &PRESETS[0];
    let picture = |material| folder.path().join(format!("thumbnails/{:016x}.png", key(material)));
    let before = corner(&mut harness, &first.name);
    let shown = if is_thorough() { PRESETS.len() } else { 6 };
    for material in &PRESETS[..shown] {
        see(&mut harness, "the picture", |_| picture(material).exists());
    }
    harness.run_steps(3);
    let after = corner(&mut harness, &first.name);
    assert_ne!(before, after, "a dot leaves the corner as it is, a picture does not");
}
