//! The browser of materials and environments: groups, sizes, favourites, watched folders.

use std::path::Path;

use eframe::App as _;
use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glossmith::{
    app::Options,
    app::actions::{Action, Command},
    scene::environment::EnvironmentSource,
    store::{PRESETS, examples::still_life, save_material},
};

use super::{
    cli_support::{Workplace, write_hdr},
    renders::{adjust, material},
    ui::{Editor, Memory, editor_of, editor_remembering, options},
};

fn has(harness: &Editor, label: &str) -> bool {
    harness.query_by_role_and_label(Role::Button, label).is_some()
}

fn search(harness: &mut Editor, text: &str) {
    harness.write("Search presets", text);
}

/// Where a thing is shown.
fn place(harness: &Editor, label: &str) -> egui::Rect {
    harness.get_by_role_and_label(Role::Button, label).rect()
}

#[test]
fn favourites_come_first_and_are_kept() {
    let mut harness = editor_of(options());
    harness.run_steps(3);
    harness.press("More of Amber");
    harness.press("Add to favourites");
    assert!(place(&harness, "Amber").top() < place(&harness, "Rubber").top());
    search(&mut harness, "metals");
    assert!(has(&harness, "Gold") && has(&harness, "Silver") && !has(&harness, "Porcelain"));
    let mut memory = Memory::default();
    harness.state_mut().save(&mut memory);
    drop(harness);
    let harness = editor_remembering(memory, options());
    assert!(place(&harness, "Amber").top() < place(&harness, "Rubber").top());
}

#[test]
fn presets_are_found_by_their_look() {
    let mut harness = editor_of(options());
    harness.run_steps(3);
    let looks = [
        ("yellow metal", "Gold", "Silver"),
        ("glossy blue", "Plastic blue", "Plastic red"),
        ("red cloth", "Velvet burgundy", "Ruby glass"),
        ("green glass", "Bottle glass", "Celadon glaze"),
        ("white matt", "Chalk", "Porcelain"),
        ("brown lacquered", "Lacquered walnut", "Car paint red"),
    ];
    for (words, found, other) in looks {
        search(&mut harness, words);
        assert!(has(&harness, found) && !has(&harness, other), "{words}");
    }
    assert!(!material("base.metalness=0.5").look_words().contains(&"metal"));
    // Names before groups.
    search(&mut harness, "car paint");
    let first = place(&harness, "Car paint red").min;
    let other = place(&harness, "Lacquered walnut").min;
    assert!((first.y, first.x) < (other.y, other.x));
}

/// A preset chooses the slots that have it, and takes the place of the edited material wherever that is used.
#[test]
fn a_preset_shows_where_it_is_used_and_replaces_a_material_everywhere() {
    let mut document = still_life();
    adjust(&mut document, "render.width=48 render.height=32 render.samples=1");
    document.materials[2] = document.materials[0].clone();
    let name = document.materials[0].name.clone();
    let mut harness = editor_of(Options {
        document: Some(document.clone()),
        ..options()
    });
    harness.settle();
    harness.press("More of Ruby glass");
    assert!(
        harness
            .get_by_label("Show where it is used (0)")
            .accesskit_node()
            .is_disabled()
    );
    harness.press(&format!("Replace on all that use {name} (2)"));
    harness.settle();
    let materials = harness.document().materials.clone();
    for (slot, (now, before)) in std::iter::zip(&materials, &document.materials).enumerate() {
        match slot {
            0 | 2 => assert_eq!(now.name, "Ruby glass"),
            _ => assert_eq!(now, before, "slot {slot}"),
        }
    }
    harness.undo();
    assert_eq!(harness.document().materials, document.materials);
    let redo = Action::Do(Command::Redo);
    harness.request(redo);
    harness.settle();
    let last = materials.len() - 1;
    harness.request(Action::SelectSlot(last));
    harness.press("More of Ruby glass");
    harness.press("Show where it is used (2)");
    assert!(harness.has("2 materials are edited together."));
}

/// Chooses a folder by the path field.
fn watch(harness: &mut Editor, folder: &Path) {
    harness.command(Command::WatchFolder);
    harness.type_path(folder, "Watch");
}

#[test]
fn folders_are_watched_for_materials_and_environments() {
    let place = Workplace::new();
    let folder = place.path("collected");
    std::fs::create_dir_all(folder.join("metals")).expect("made");
    let mut own = PRESETS[3].clone();
    own.name = "Zinc".to_owned();
    save_material(&folder.join("metals/zinc.json"), &own).expect("saved");
    save_material(&folder.join(".tin.json"), &own).expect("saved");
    write_hdr(&folder.join("dusk.hdr"), 128, 64, |x, _| [x as f32 / 128.0, 0.2, 0.1]);
    let mut harness = editor_of(Options {
        typed_paths: Some(place.root().to_owned()),
        ..options()
    });
    harness.run_steps(3);
    watch(&mut harness, &folder);
    let zinc = "Zinc (collected/metals/zinc.json)";
    harness.see("the material", |harness| has(harness, zinc));
    assert!(!has(&harness, "Zinc (collected/.tin.json)"), "what is hidden stays so");
    harness.press(zinc);
    assert_eq!(*harness.material(), own);
    let dusk = "dusk.hdr (collected/dusk.hdr)";
    search(&mut harness, "dusk");
    assert!(has(&harness, dusk) && !has(&harness, zinc));
    harness.press(dusk);
    let source = EnvironmentSource::File(folder.join("dusk.hdr"));
    harness.wait("the environment", |app| app.document().lighting.environment == source);
    // What comes later is found.
    search(&mut harness, "");
    own.name = "Tin".to_owned();
    save_material(&folder.join("tin.json"), &own).expect("saved");
    harness.see("the new one", |harness| has(harness, "Tin (collected/tin.json)"));
    harness.press("Stop watching collected");
    assert!(!has(&harness, zinc));
    // And one that goes is told of.
    watch(&mut harness, &folder);
    harness.see("the material", |harness| has(harness, zinc));
    std::fs::remove_dir_all(&folder).expect("removed");
    harness.see("what is wrong", |harness| harness.tells("can't be read"));
}
