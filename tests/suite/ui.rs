//! The editor as a person uses it, with the real renderer behind it, in few pixels.

use std::{collections::HashMap, path::PathBuf, time::Duration, time::Instant};

use egui::{Key, Modifiers, Pos2, Vec2, accesskit, accesskit::NodeId, accesskit::Role};
use egui_kittest::{Harness, kittest::NodeT as _, kittest::Queryable as _};
use glossmith::{
    app::{App, Options, Resolution, actions::Action, actions::Command, layout::Pane, workspaces::MEASURE},
    document::Document,
    optics::lobe::Lobe,
    render::EngineChoice,
    scene::ModelSource,
    scene::environment::EnvironmentSource,
    store::{PRESETS, save_document, save_material},
};

use super::{
    manual::manual_pages,
    ui_files::wait_for_words,
    ui_hands::{Hands as _, press, type_path},
    worker::small_document,
};

/// The window without a screen.
pub(super) type Editor = Harness<'static, App>;

/// Of a window whose size is not what is tested.
const SIZE: Vec2 = Vec2::new(1280.0, 720.0);

pub const PATIENCE: Duration = Duration::from_secs(600);

/// The options of an editor that is tested: nothing of the user's is read or written.
pub(super) fn options() -> Options {
    Options {
        engine: EngineChoice::Cpu,
        document: Some(small_document()),
        resolution: Some(Resolution::Document),
        // With every panel in it.
        workspace: Some(MEASURE.to_owned()),
        // The system's dialogs can't be used by a test, and some systems have none.
        typed_paths: Some(std::env::temp_dir()),
        pages: manual_pages(),
        ..Options::default()
    }
}

pub(super) fn editor_with(document: Document, files: Vec<PathBuf>) -> Editor {
    editor_of(Options {
        files,
        document: Some(document),
        ..options()
    })
}

pub(super) fn editor_of(options: Options) -> Editor {
    let mut harness = Harness::builder()
        .with_size(SIZE)
        .build_eframe(move |creation| App::new(creation, options).expect("a thread to render on"));
    // What most tests are about is in front.
    for pane in [Pane::Lighting, Pane::Curve] {
        harness.state_mut().reveal(pane);
    }
    harness
}

/// A window of a size in pixels, as a person has it, whose first picture is finished. Its own files are in `folder`.
#[cfg(feature = "thorough")]
pub(super) fn window_of(document: Document, folder: &std::path::Path, [width, height]: [u32; 2]) -> Editor {
    let made = Options {
        document: Some(document),
        resolution: Some(Resolution::Auto),
        data: Some(folder.join("data")),
        cache: Some(folder.join("cache")),
        typed_paths: Some(folder.to_owned()),
        ..options()
    };
    let mut harness: Editor = Harness::builder()
        .with_size(Vec2::new(width as f32, height as f32))
        .build_eframe(move |creation| App::new(creation, made).expect("a thread to render on"));
    settle(&mut harness);
    harness
}

/// An editor whose first picture is finished.
pub(super) fn editor() -> Editor {
    let mut harness = editor_with(small_document(), Vec::new());
    settle(&mut harness);
    harness
}

/// What eframe keeps from one start to the next.
#[derive(Default)]
pub(super) struct Memory(pub(super) HashMap<String, String>);

impl eframe::Storage for Memory {
    fn get_string(&self, key: &str) -> Option<String> {
        self.0.get(key).cloned()
    }
    fn set_string(&mut self, key: &str, value: String) {
        self.0.insert(key.to_owned(), value);
    }
    fn remove_string(&mut self, key: &str) {
        self.0.remove(key);
    }
    fn flush(&mut self) {}
}

/// A window that finds what another one left.
pub(super) fn editor_remembering(memory: Memory, options: Options) -> Editor {
    // The window borrows it for as long as it lives.
    let memory: &'static Memory = Box::leak(Box::new(memory));
    let mut harness = Harness::builder().with_size(SIZE).build_eframe(move |creation| {
        creation.storage = Some(memory);
        App::new(creation, options).expect("a thread to render on")
    });
    harness.run_steps(3);
    harness
}

/// Controls by role and name; `None` where several have the same.
pub(super) type Controls = HashMap<(Role, String), Option<NodeId>>;

/// The controls whose role and name no other has, with what they are told apart by.
pub(super) fn controls(harness: &Editor) -> Controls {
    let mut found = HashMap::new();
    for node in harness.root().children_recursive() {
        let node = node.accesskit_node();
        // Links and code of the manual are there as far as they are scrolled into view.
        let of_manual = |name: &String| node.role() == Role::Link || name == "🗐";
        let Some(name) = node
            .label()
            .filter(|name| !of_manual(name))
            .filter(|_| node.data().supports_action(accesskit::Action::Click))
        else {
            continue;
        };
        let id = node.locate().0;
        let known = found.entry((node.role(), name));
        known.and_modify(|known| *known = None).or_insert(Some(id));
    }
    found
}

/// Fails where a control that both have is another one.
pub(super) fn assert_same_controls(before: &Controls, after: &Controls, what: &str) {
    for (control, id) in after {
        let was = before.get(control).unwrap_or(id);
        assert!(
            was == id || was.is_none() || id.is_none(),
            "{control:?} became another during {what}"
        );
    }
}

/// Steps until something is seen, while every control stays the one that it was: else a click under way would be lost.
pub(super) fn see(harness: &mut Editor, what: &str, until: impl Fn(&Editor) -> bool) {
    let begun = Instant::now();
    while !until(harness) {
        let before = controls(harness);
        harness.step();
        assert_same_controls(&before, &controls(harness), what);
        let app = harness.state();
        let state = (app.snapshot().activity.clone(), app.messages());
        assert!(begun.elapsed() < PATIENCE, "waited in vain for {what}: {state:?}");
        std::thread::sleep(Duration::from_millis(3));
    }
}

/// Steps until a control or text is there.
pub(super) fn see_label(harness: &mut Editor, label: &str) {
    see(harness, label, |harness| harness.has(label));
}

pub(super) fn wait(harness: &mut Editor, what: &str, until: impl Fn(&App) -> bool) {
    // What was just done is taken note of.
    harness.step();
    see(harness, what, |harness| until(harness.state()));
}

pub(super) fn settle(harness: &mut Editor) {
    // What was just done reaches the renderer with the next frame.
    harness.run_steps(3);
    wait(harness, "a finished picture", App::is_settled);
    // The panels show what the wait ended with.
    harness.step();
    harness.check_accessibility();
}

pub(super) fn picture(harness: &Editor) -> Vec<[f32; 4]> {
    let snapshot = harness.state().snapshot();
    snapshot
        .picture
        .as_ref()
        .expect("there is a picture")
        .image
        .pixels
        .clone()
}

pub(super) fn undo(harness: &mut Editor) {
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(harness);
}

pub(super) fn request(harness: &mut Editor, action: Action) {
    harness.state_mut().request(action);
    harness.run_steps(2);
}

#[test]
fn the_editor_opens_and_renders() {
    let harness = editor();
    let snapshot = harness.state().snapshot();
    let picture = snapshot.picture.as_ref().expect("it was waited for");
    assert_eq!((picture.width, picture.height, picture.samples_per_pixel), (40, 24, 3));
    let bright = picture.rgba.iter().filter(|byte| **byte > 40).count();
    assert!(bright > picture.rgba.len() / 3, "the picture is almost black");
    assert!(!harness.has("rendering"));
    assert!(harness.has("done"));
}

#[test]
fn a_slider_changes_the_document_and_the_picture_and_undo_brings_both_back() {
    let mut harness = editor();
    let (document, before) = (harness.document().clone(), picture(&harness));
    harness.set("Specular roughness", 0.85);
    settle(&mut harness);
    assert_eq!(harness.document().materials[0].roughness, 0.85);
    let rough = picture(&harness);
    assert_ne!(rough, before);
    undo(&mut harness);
    assert_eq!(*harness.document(), document);
    assert_eq!(picture(&harness), before);
    harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    settle(&mut harness);
    assert_eq!(picture(&harness), rough);
}

/// Undo comes in the frame of an edit where keys are fast: it takes back that edit, not the one before.
#[test]
fn undo_takes_back_what_was_edited_in_the_same_frame() {
    let mut harness = editor();
    let set = |harness: &Editor, label: &str, value: f64| {
        harness
            .get_by_role_and_label(Role::SpinButton, label)
            .set_value_accesskit(value);
    };
    let of = |harness: &Editor| {
        let material = &harness.document().materials[0];
        (material.roughness, material.metalness)
    };
    set(&harness, "Specular roughness", 0.85);
    settle(&mut harness);
    let (_, metalness) = of(&harness);
    set(&harness, "Base metalness", 0.25);
    harness.state_mut().request(Action::Do(Command::Undo));
    settle(&mut harness);
    assert_eq!(of(&harness), (0.85, metalness));
    harness.state_mut().request(Action::Do(Command::Redo));
    settle(&mut harness);
    assert_eq!(of(&harness), (0.85, 0.25));
    // Redo in the frame of an edit has nothing to do.
    undo(&mut harness);
    set(&harness, "Specular roughness", 0.5);
    harness.state_mut().request(Action::Do(Command::Redo));
    settle(&mut harness);
    assert_eq!(of(&harness), (0.5, metalness));
}

#[test]
fn a_lobe_is_chosen_from_its_menu_and_what_does_not_apply_goes() {
    let mut harness = editor();
    assert!(harness.has("Specular curve"));
    harness.click(Role::ComboBox, "Specular lobe");
    let label = Lobe::Ggx.label();
    harness.click(Role::Button, label);
    settle(&mut harness);
    assert_eq!(harness.document().materials[0].lobe, Lobe::Ggx);
    assert!(!harness.has("Specular curve"), "GGX has no curve");
}

#[test]
fn dragging_in_the_viewport_turns_the_camera_in_one_step() {
    let mut harness = editor();
    let before = harness.document().camera;
    let center = harness.get_by_label("Viewport").rect().center();
    drag(&mut harness, center, Vec2::new(60.0, 20.0));
    settle(&mut harness);
    let after = harness.document().camera;
    assert!(
        after.yaw_deg < before.yaw_deg - 5.0 && after.pitch_deg > before.pitch_deg + 2.0,
        "{after:?}"
    );
    assert_eq!(
        (after.target, after.distance),
        (None, None),
        "a turn leaves the framing alone"
    );
    undo(&mut harness);
    assert_eq!(harness.document().camera, before);
}

pub(super) fn drag(harness: &mut Editor, from: Pos2, by: Vec2) {
    harness.hover_at(from);
    harness.step();
    harness.drag_at(from);
    for step in 1..=6 {
        harness.step();
        harness.hover_at(from + by * (step as f32 / 6.0));
    }
    harness.step();
    harness.drop_at(from + by);
    harness.run_steps(2);
}

#[test]
fn shift_and_drag_turns_the_light_and_the_wheel_zooms() {
    let mut harness = editor();
    let center = harness.get_by_label("Viewport").rect().center();
    harness.event(egui::Event::ModifiersChanged(Modifiers::SHIFT));
    drag(&mut harness, center, Vec2::new(50.0, 0.0));
    harness.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    assert!(harness.document().lighting.rotation_deg > 10.0);
    assert_eq!(harness.document().camera, Document::default().camera);
    harness.hover_at(center);
    harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: Vec2::new(0.0, 120.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    harness.run_steps(4);
    let distance = harness.document().camera.distance.expect("zooming sets a distance");
    harness.key_press(Key::F);
    harness.run_steps(2);
    assert_eq!(harness.document().camera.distance, None, "it was {distance}");
}

#[test]
fn every_panel_and_sheet_has_named_inputs() {
    let mut harness = editor();
    request(&mut harness, Action::Open("not/there.glb".into()));
    wait_for_words(&mut harness, "not/there.glb");
    for pane in Pane::ALL {
        harness.reveal(pane);
        harness.check_accessibility();
    }
    for command in [Command::Palette, Command::Shortcuts, Command::About] {
        harness.command(command);
        harness.run_steps(2);
        harness.check_accessibility();
        harness.key_press(Key::Escape);
        harness.run_steps(2);
    }
    let manual = |harness: &Editor| harness.query_by_role_and_label(Role::Button, "Contents").is_some();
    harness.command(Command::Manual);
    see(&mut harness, "the manual", manual);
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert!(!manual(&harness), "escape closes it");
    for theme in 0..2 {
        harness.command(Command::ToggleTheme);
        harness.check_accessibility();
        assert_eq!(harness.ctx.theme() == egui::Theme::Dark, theme == 1);
    }
}

#[test]
fn a_preset_is_one_click_and_one_undo() {
    let mut harness = editor();
    let before = harness.document().clone();
    press(&mut harness, "Rubber");
    settle(&mut harness);
    let rubber = PRESETS
        .iter()
        .find(|material| material.name == "Rubber")
        .expect("shipped");
    assert_eq!(harness.document().materials[0], *rubber);
    undo(&mut harness);
    assert_eq!(*harness.document(), before);
}

#[test]
fn models_and_environments_are_changed_and_undone() {
    let mut harness = editor();
    let mut document = harness.document().clone();
    harness.set("Specular roughness", 0.6);
    let before = harness.document().clone();
    request(&mut harness, Action::UseModel(ModelSource::Shaderball));
    wait(&mut harness, "the model", |app| {
        app.document().model == ModelSource::Shaderball
    });
    settle(&mut harness);
    let materials = &harness.document().materials;
    assert_eq!(
        (materials.len(), materials[0].roughness),
        (2, 0.6),
        "the edited material stays"
    );
    assert!(harness.has("Slot 2: stand"), "the slots are listed");
    undo(&mut harness);
    assert_eq!(*harness.document(), before);
    request(&mut harness, Action::UseEnvironment(EnvironmentSource::Sky));
    wait(&mut harness, "the sky", |app| {
        app.document().lighting.environment == EnvironmentSource::Sky
    });
    document.materials[0].roughness = 0.6;
    document.lighting.environment = EnvironmentSource::Sky;
    assert_eq!(*harness.document(), document);
}

#[test]
fn projects_and_materials_come_back_from_their_files() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut document = small_document();
    document.camera.yaw_deg = -70.0;
    document.materials[0] = PRESETS[5].clone();
    let project = folder.path().join("project.json");
    save_document(&project, &document).expect("a temporary file");
    let material = folder.path().join("material.json");
    save_material(&material, &PRESETS[3]).expect("a temporary file");
    let mut harness = editor_with(small_document(), vec![project]);
    settle(&mut harness);
    assert_eq!(*harness.document(), document);
    request(&mut harness, Action::Open(material));
    wait(&mut harness, "the material", |app| app.document() != &document);
    assert_eq!(harness.document().materials[0], PRESETS[3]);
}

#[test]
fn the_picture_is_saved_as_it_is_shown() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut harness = editor();
    harness.command(Command::SavePicture);
    let path = folder.path().join("shown.png");
    type_path(&mut harness, &path, "Save");
    wait_for_words(&mut harness, "shown.png");
    let saved = image::open(&path).expect("a picture").to_rgba8();
    let snapshot = harness.state().snapshot();
    assert_eq!(saved.into_raw(), snapshot.picture.as_ref().expect("there is one").rgba);
}

#[test]
fn the_window_paints_the_renderers_pixels() {
    let mut document = small_document();
    document.lighting.background = glossmith::document::Background::Color([0.9, 0.02, 0.02]);
    let mut harness = editor_with(document, Vec::new());
    settle(&mut harness);
    harness.step();
    let viewport = harness.get_by_label("Viewport").rect();
    let window = harness
        .render()
        .expect("a Vulkan driver: apt install mesa-vulkan-drivers");
    let shown = harness.state().snapshot().picture.clone().expect("there is one");
    // The picture fills the viewport's width; its left edge is background.
    let at = [viewport.left() + 20.0, viewport.center().y].map(|x| x as u32);
    let painted = window.get_pixel(at[0], at[1]).0;
    let expected = &shown.rgba[4 * 40 * 12..][..4];
    let difference = painted.iter().zip(expected).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(difference <= Some(3), "painted {painted:?}, rendered {expected:?}");
    assert!(expected[0] > 2 * expected[1], "the background is red");
}
