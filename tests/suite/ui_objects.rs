//! The tree of the scene: objects and materials chosen, hidden, renamed and edited together.

use egui::{Event, Key, Modifiers, PointerButton, Pos2, accesskit::Role};
use egui_kittest::kittest::Queryable as _;
use glossmith::{
    app::actions::{Action, Command},
    app::layout::Pane,
    document::{CameraSettings, Document},
    render::{EngineChoice, Session},
    scene::ModelSource,
    store::{PRESETS, load_document, save_document},
};

use super::{
    cli_support::Workplace,
    ui::{Editor, editor_with, picture},
    worker::small_document,
};

/// Two squares side by side, facing the camera, each an object with a material of its own.
fn two_squares(folder: &Workplace) -> Document {
    let path = folder.path("squares.obj");
    folder.write(
        "squares.mtl",
        "newmtl red\nKd 0.8 0.1 0.1\nnewmtl green\nKd 0.1 0.8 0.1\n",
    );
    let square = |name: &str, material: &str, x: f32, first: u32| {
        let [a, b, c, d] = [first, first + 1, first + 2, first + 3];
        let corners = [[x, -1.0], [x + 1.8, -1.0], [x + 1.8, 1.0], [x, 1.0]];
        let corners: String = corners.iter().map(|[x, y]| format!("v {x} {y} 0\n")).collect();
        format!("o {name}\nusemtl {material}\n{corners}f {a} {b} {c} {d}\n")
    };
    let text = format!(
        "mtllib squares.mtl\n{}{}",
        square("left", "red", -1.9, 1),
        square("right", "green", 0.1, 5)
    );
    std::fs::write(&path, text).expect("a file");
    let mut document = Document {
        model: ModelSource::File(path),
        ..small_document()
    };
    document.camera = CameraSettings {
        yaw_deg: 0.0,
        pitch_deg: 0.0,
        ..CameraSettings::default()
    };
    let names = ["red", "green"];
    document.materials = names
        .map(|name| glossmith::document::MaterialSettings {
            name: name.to_owned(),
            ..Default::default()
        })
        .to_vec();
    document
}

fn opened(document: Document) -> Editor {
    let mut harness = editor_with(document, Vec::new());
    harness.settle();
    harness.reveal(Pane::Scene);
    harness
}

fn button(harness: &Editor, label: &str) -> bool {
    harness.query_by_role_and_label(Role::Button, label).is_some()
}

/// Opens the menu of a line and presses an entry of it.
fn press_in_menu(harness: &mut Editor, line: &str, entry: &str) {
    harness.get_by_role_and_label(Role::Button, line).click_secondary();
    harness.run_steps(3);
    harness.press(entry);
}

fn click_with(harness: &mut Editor, at: Pos2, modifiers: Modifiers) {
    harness.hover_at(at);
    harness.event(Event::ModifiersChanged(modifiers));
    for pressed in [true, false] {
        harness.event(Event::PointerButton {
            pos: at,
            button: PointerButton::Primary,
            pressed,
            modifiers,
        });
    }
    harness.run_steps(2);
    harness.event(Event::ModifiersChanged(Modifiers::NONE));
    harness.run_steps(2);
}

#[test]
fn objects_are_hidden_isolated_and_shown_again() {
    let folder = Workplace::new();
    let document = two_squares(&folder);
    let mut harness = opened(document.clone());
    let whole = picture(&harness);
    harness.press("Hide left");
    harness.settle();
    assert_eq!(harness.document().hidden_objects, [0]);
    let without = picture(&harness);
    // Only what was in the left half has changed.
    let differs = |half: usize| (0..whole.len()).any(|i| i % 40 / 20 == half && whole[i] != without[i]);
    assert!(differs(0), "it is still there");
    let right = (0..24).all(|y| (24..32).all(|x| (whole[y * 40 + x][1] - without[y * 40 + x][1]).abs() < 0.35));
    assert!(right, "the other one stays where it was");
    harness.press("Show left");
    harness.settle();
    assert_eq!(picture(&harness), whole);
    press_in_menu(&mut harness, "Object left", "Isolate");
    harness.settle();
    assert_eq!(harness.document().hidden_objects, [1]);
    harness.command(Command::ShowObjects);
    harness.settle();
    assert_eq!(picture(&harness), whole);
    harness.press("Edit");
    harness.get_by_label_contains("Undo: Show all objects");
    harness.key_press(Key::Escape);
    // Nothing at all is a picture, too.
    harness.press("Hide left");
    harness.press("Hide right");
    harness.settle();
    assert_eq!(harness.document().hidden_objects, [0, 1]);
    for _ in 0..2 {
        harness.undo();
    }
    assert_eq!(picture(&harness), whole);
    harness.press("Show ground");
    harness.settle();
    assert!(harness.document().ground);
}

#[test]
fn what_is_hidden_and_renamed_is_saved_and_the_command_line_hides_it() {
    let folder = Workplace::new();
    let mut harness = opened(two_squares(&folder));
    harness.press("Hide right");
    press_in_menu(&mut harness, "Object left", "Rename");
    harness.get_by_label("New name").type_text("wing");
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    let document = harness.document().clone();
    let name = document.object_names.get(&0).expect("it was renamed").clone();
    assert_eq!(name, "wing", "the old name is replaced");
    assert!(button(&harness, &format!("Object {name}")) && button(&harness, &format!("Hide {name}")));
    let path = folder.path("scene.glossmith.json");
    save_document(&path, &document).expect("a file");
    let loaded = load_document(&path).expect("it was just saved").value;
    assert_eq!(
        (&loaded.object_names, &loaded.hidden_objects),
        (&document.object_names, &document.hidden_objects)
    );
    let mut session = Session::open(EngineChoice::Cpu).expect("the processor");
    session.submit(&loaded).expect("a scene");
    let geometry = session.job().expect("it was submitted").geometry.clone();
    assert_eq!(geometry.model.objects, [0, 0], "the triangles of the left square");
}

#[test]
fn materials_chosen_together_are_edited_together() {
    let folder = Workplace::new();
    let mut harness = opened(two_squares(&folder));
    let before = harness.document().clone();
    harness.click(Role::Button, "Slot 1: red");
    let green = harness
        .get_by_role_and_label(Role::Button, "Slot 2: green")
        .rect()
        .center();
    click_with(&mut harness, green, Modifiers::COMMAND);
    assert!(harness.has("2 materials are edited together."));
    harness.set("Specular roughness", 0.77);
    harness.settle();
    let materials = harness.document().materials.clone();
    assert_eq!([materials[0].roughness, materials[1].roughness], [0.77; 2]);
    assert_eq!(
        [&materials[0].name, &materials[1].name],
        ["red", "green"],
        "names stay their own"
    );
    harness.undo();
    assert_eq!(*harness.document(), before, "in one step");
    // A preset goes to both as well.
    harness.request(Action::UseMaterial(Box::new(PRESETS[3].clone())));
    assert_eq!(harness.document().materials, [PRESETS[3].clone(), PRESETS[3].clone()]);
    harness.undo();
    harness.click(Role::Button, "Slot 2: green");
    assert!(!harness.has("2 materials are edited together."));
}
