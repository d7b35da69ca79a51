//! The editor as a person uses it, with the real renderer behind it, in few pixels.

use std::{collections::HashMap, ops::Deref, ops::DerefMut, path::PathBuf, time::Duration};

use egui::{Key, Modifiers, Vec2, accesskit, accesskit::NodeId, accesskit::Role};
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

use super::{cli_support::Workplace, manual::manual_pages, worker::small_document};

/// The window without a screen.
pub struct Editor(pub Harness<'static, App>);

impl Deref for Editor {
    type Target = Harness<'static, App>;
    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl DerefMut for Editor {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}

/// Of a window whose size is not what is tested.
const SIZE: Vec2 = Vec2::new(1280.0, 720.0);

pub const PATIENCE: Duration = Duration::from_secs(600);

/// The options of an editor that is tested: nothing of the user's is read or written.
pub fn options() -> Options {
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

pub fn editor_with(document: Document, files: Vec<PathBuf>) -> Editor {
    editor_of(Options {
        files,
        document: Some(document),
        ..options()
    })
}

pub fn editor_of(options: Options) -> Editor {
    editor_sized(SIZE, options)
}

pub fn editor_sized(size: Vec2, options: Options) -> Editor {
    let mut harness = opened(size, None, options);
    // What most tests are about is in front.
    for pane in [Pane::Lighting, Pane::Curve] {
        harness.state_mut().reveal(pane);
    }
    harness
}

fn opened(size: Vec2, memory: Option<&'static dyn eframe::Storage>, options: Options) -> Editor {
    Editor(Harness::builder().with_size(size).build_eframe(move |creation| {
        creation.storage = memory;
        App::new(creation, options).expect("a thread to render on")
    }))
}

/// A window of a size in pixels, as a person has it, whose first picture is finished. Its own files are in `folder`.
#[cfg(feature = "thorough")]
pub fn window_of(document: Document, folder: &std::path::Path, [width, height]: [u32; 2]) -> Editor {
    let made = Options {
        document: Some(document),
        resolution: Some(Resolution::Auto),
        data: Some(folder.join("data")),
        cache: Some(folder.join("cache")),
        typed_paths: Some(folder.to_owned()),
        ..options()
    };
    let mut harness = opened(Vec2::new(width as f32, height as f32), None, made);
    harness.settle();
    harness
}

/// An editor whose first picture is finished.
pub fn editor() -> Editor {
    let mut harness = editor_with(small_document(), Vec::new());
    harness.settle();
    harness
}

/// What eframe keeps from one start to the next.
#[derive(Default)]
pub struct Memory(pub HashMap<String, String>);

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
pub fn editor_remembering(memory: Memory, options: Options) -> Editor {
    // The window borrows it for as long as it lives.
    let memory = Box::leak(Box::new(memory));
    let mut harness = opened(SIZE, Some(memory), options);
    harness.run_steps(3);
    harness
}

/// Controls by role and name; `None` where several have the same.
pub type Controls = HashMap<(Role, String), Option<NodeId>>;

/// The controls whose role and name no other has, with what they are told apart by.
pub fn controls(harness: &Editor) -> Controls {
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
pub fn assert_same_controls(before: &Controls, after: &Controls, what: &str) {
    for (control, id) in after {
        let was = before.get(control).unwrap_or(id);
        assert!(
            was == id || was.is_none() || id.is_none(),
            "{control:?} became another during {what}"
        );
    }
}

pub fn picture(harness: &Editor) -> Vec<[f32; 4]> {
    let snapshot = harness.state().snapshot();
    snapshot
        .picture
        .as_ref()
        .expect("there is a picture")
        .image
        .pixels
        .clone()
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
    harness.settle();
    assert_eq!(harness.material().roughness, 0.85);
    let rough = picture(&harness);
    assert_ne!(rough, before);
    harness.undo();
    assert_eq!(*harness.document(), document);
    assert_eq!(picture(&harness), before);
    harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    harness.settle();
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
        let material = harness.material();
        (material.roughness, material.metalness)
    };
    set(&harness, "Specular roughness", 0.85);
    harness.settle();
    let (_, metalness) = of(&harness);
    set(&harness, "Base metalness", 0.25);
    harness.state_mut().request(Action::Do(Command::Undo));
    harness.settle();
    assert_eq!(of(&harness), (0.85, metalness));
    harness.state_mut().request(Action::Do(Command::Redo));
    harness.settle();
    assert_eq!(of(&harness), (0.85, 0.25));
    // Redo in the frame of an edit has nothing to do.
    harness.undo();
    set(&harness, "Specular roughness", 0.5);
    harness.state_mut().request(Action::Do(Command::Redo));
    harness.settle();
    assert_eq!(of(&harness), (0.5, metalness));
}

#[test]
fn a_lobe_is_chosen_from_its_menu_and_what_does_not_apply_goes() {
    let mut harness = editor();
    assert!(harness.has("Specular curve"));
    harness.click(Role::ComboBox, "Specular lobe");
    let label = Lobe::Ggx.label();
    harness.click(Role::Button, label);
    harness.settle();
    assert_eq!(harness.material().lobe, Lobe::Ggx);
    assert!(!harness.has("Specular curve"), "GGX has no curve");
}

#[test]
fn dragging_in_the_viewport_turns_the_camera_in_one_step() {
    let mut harness = editor();
    let before = harness.document().camera;
    let center = harness.get_by_label("Viewport").rect().center();
    harness.drag(center, Vec2::new(60.0, 20.0));
    harness.settle();
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
    harness.undo();
    assert_eq!(harness.document().camera, before);
}

#[test]
fn shift_and_drag_turns_the_light_and_the_wheel_zooms() {
    let mut harness = editor();
    let center = harness.get_by_label("Viewport").rect().center();
    harness.event(egui::Event::ModifiersChanged(Modifiers::SHIFT));
    harness.drag(center, Vec2::new(50.0, 0.0));
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
    harness.request(Action::Open("not/there.glb".into()));
    harness.wait_for_words("not/there.glb");
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
    harness.see("the manual", manual);
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
    harness.press("Rubber");
    harness.settle();
    let rubber = PRESETS
        .iter()
        .find(|material| material.name == "Rubber")
        .expect("shipped");
    assert_eq!(*harness.material(), *rubber);
    harness.undo();
    assert_eq!(*harness.document(), before);
}

#[test]
fn models_and_environments_are_changed_and_undone() {
    let mut harness = editor();
    let mut document = harness.document().clone();
    harness.set("Specular roughness", 0.6);
    let before = harness.document().clone();
    harness.request(Action::UseModel(ModelSource::Shaderball));
    harness.wait("the model", |app| app.document().model == ModelSource::Shaderball);
    harness.settle();
    let materials = &harness.document().materials;
    assert_eq!(
        (materials.len(), materials[0].roughness),
        (2, 0.6),
        "the edited material stays"
    );
    assert!(harness.has("Slot 2: stand"), "the slots are listed");
    harness.undo();
    assert_eq!(*harness.document(), before);
    harness.request(Action::UseEnvironment(EnvironmentSource::Sky));
    harness.wait("the sky", |app| {
        app.document().lighting.environment == EnvironmentSource::Sky
    });
    document.materials[0].roughness = 0.6;
    document.lighting.environment = EnvironmentSource::Sky;
    assert_eq!(*harness.document(), document);
}

#[test]
fn projects_and_materials_come_back_from_their_files() {
    let folder = Workplace::new();
    let mut document = small_document();
    document.camera.yaw_deg = -70.0;
    document.materials[0] = PRESETS[5].clone();
    let project = folder.path("project.json");
    save_document(&project, &document).expect("a temporary file");
    let material = folder.path("material.json");
    save_material(&material, &PRESETS[3]).expect("a temporary file");
    let mut harness = editor_with(small_document(), vec![project]);
    harness.settle();
    assert_eq!(*harness.document(), document);
    harness.request(Action::Open(material));
    harness.wait("the material", |app| app.document() != &document);
    assert_eq!(*harness.material(), PRESETS[3]);
}

#[test]
fn the_picture_is_saved_as_it_is_shown() {
    let folder = Workplace::new();
    let mut harness = editor();
    harness.command(Command::SavePicture);
    let path = folder.path("shown.png");
    harness.type_path(&path, "Save");
    harness.wait_for_words("shown.png");
    let saved = image::open(&path).expect("a picture").to_rgba8();
    let snapshot = harness.state().snapshot();
    assert_eq!(saved.into_raw(), snapshot.picture.as_ref().expect("there is one").rgba);
}

#[test]
fn the_window_paints_the_renderers_pixels() {
    let mut document = small_document();
    document.lighting.background = glossmith::document::Background::Color([0.9, 0.02, 0.02]);
    let mut harness = editor_with(document, Vec::new());
    harness.settle();
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
