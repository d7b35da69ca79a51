//! Rough edges of the window: rows that fit, numbers that are replaced, words that a person would use, keys that go where
//! they are meant for, and failures that are told.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, Pos2, Rect, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glossmith::app::actions::{Action, Command};
use glossmith::app::layout::Pane;
use glossmith::app::{App, Options, Resolution};
use glossmith::document::{AreaLight, Bookmark, Denoise};

use super::ui::{Editor, drag, editor, editor_of, editor_with, options, request, see, see_label, settle, wait};
use super::worker::small_document;

fn rect(harness: &Editor, label: &str) -> Rect {
    harness.get_by_label(label).rect()
}

/// A key as keyboards send it, with its letter.
fn type_letter(harness: &mut Editor, key: Key, letter: &str) {
    harness.event(Event::Text(letter.to_owned()));
    harness.key_press(key);
    harness.run_steps(1);
}

/// Whether a text is shown anywhere.
fn is_shown(harness: &Editor, part: &str) -> bool {
    harness.query_all_by_label_contains(part).next().is_some()
}

/// Asked of the manifest, as no test has a screen: without the feature, copying works within the window, which hides it.
#[test]
fn the_program_is_built_with_the_systems_clipboard() {
    let text = include_str!("../../Cargo.toml");
    let manifest: toml::Table = text.parse().expect("a manifest");
    let features = manifest["dependencies"]["eframe"]["features"]
        .as_array()
        .expect("a list");
    let has = |feature: &str| features.iter().any(|given| given.as_str() == Some(feature));
    assert!(has("clipboard"), "{features:?}");
}

#[test]
fn a_pasted_picture_is_told_what_to_do_with() {
    let mut harness = editor();
    let image = egui::ColorImage::filled([2, 2], egui::Color32::RED);
    harness.event(Event::PasteImage(std::sync::Arc::new(image)));
    harness.run_steps(3);
    assert!(is_shown(&harness, "the clipboard holds an image"));
}

#[test]
fn a_path_can_always_be_typed_and_begins_in_known_folders() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let last = folder.path().join("last");
    std::fs::create_dir(&last).expect("a temporary folder");
    let mut harness = editor_of(Options {
        typed_paths: Some(last.clone()),
        ..options()
    });
    settle(&mut harness);
    request(&mut harness, Action::Do(Command::Save));
    see(&mut harness, "the path field", |harness| {
        harness.query_by_role_and_label(Role::TextInput, "Path").is_some()
    });
    let field = |harness: &Editor| {
        harness
            .get_by_role_and_label(Role::TextInput, "Path")
            .value()
            .unwrap_or_default()
    };
    let save = |harness: &Editor| {
        harness
            .get_by_role_and_label(Role::Button, "Save")
            .accesskit_node()
            .is_disabled()
    };
    // No folder of this name: said, and nothing is tried.
    let missing = folder.path().join("missing/a.glossmith.json").display().to_string();
    harness
        .get_by_role_and_label(Role::TextInput, "Path")
        .set_text_value_accesskit(&missing);
    harness.run_steps(2);
    assert!(is_shown(&harness, "There is no such folder") && save(&harness));
    // A folder to begin with: the file's name stays.
    harness
        .get_by_label(&format!("Begin in {}", last.display()))
        .click_accesskit();
    harness.run_steps(3);
    assert_eq!(field(&harness), last.join("a.glossmith.json").display().to_string());
    harness.get_by_role_and_label(Role::Button, "Save").click();
    wait(&mut harness, "the project", |_| last.join("a.glossmith.json").is_file());
    // Back to the system's dialogs, and to typed paths again.
    for words in ["chosen in the system's dialog", "typing their paths"] {
        request(&mut harness, Action::Do(Command::TypePaths));
        assert!(
            harness.state().messages().iter().any(|text| text.contains(words)),
            "{words}"
        );
    }
}

#[test]
fn projects_are_saved_under_the_ending_of_their_kind() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut harness = editor_of(Options {
        typed_paths: Some(folder.path().to_owned()),
        ..options()
    });
    settle(&mut harness);
    request(&mut harness, Action::Do(Command::SaveAs));
    see(&mut harness, "the path field", |harness| {
        harness.query_by_role_and_label(Role::TextInput, "Path").is_some()
    });
    let path = folder.path().join("proj").display().to_string();
    harness
        .get_by_role_and_label(Role::TextInput, "Path")
        .set_text_value_accesskit(&path);
    harness.run_steps(2);
    harness.get_by_role_and_label(Role::Button, "Save").click();
    let named = folder.path().join("proj.glossmith.json");
    wait(&mut harness, "the project", |_| named.is_file());
}

/// A picture that never ends, however much it has cost, takes the viewport's size; a finished one is kept (see
/// `a_costly_picture_survives_a_comparison_and_panels_that_go`).
#[test]
fn fill_fills_while_the_picture_is_slow() {
    let mut document = small_document();
    document.render.samples = 1 << 24;
    let mut harness = Harness::builder()
        .with_size(Vec2::new(1000.0, 700.0))
        .with_pixels_per_point(0.25)
        .build_eframe(move |creation| {
            let options = Options {
                document: Some(document),
                resolution: Some(Resolution::Native),
                keep_pictures_from: Some(std::time::Duration::ZERO),
                ..options()
            };
            App::new(creation, options).expect("a thread to render on")
        });
    let size = |app: &App| {
        let snapshot = app.snapshot();
        let picture = snapshot.picture.as_ref().filter(|picture| picture.reduction == 1);
        picture.map(|picture| [picture.width, picture.height])
    };
    wait(&mut harness, "a picture", |app| size(app).is_some());
    let before = size(harness.state());
    request(&mut harness, Action::Do(Command::Maximise));
    wait(&mut harness, "a picture that fills", |app| {
        size(app).is_some_and(|now| Some(now) != before)
    });
}

#[test]
fn a_bookmarks_row_stays_within_its_panel() {
    let mut document = small_document();
    document.bookmarks = vec![Bookmark {
        name: "From the left".to_owned(),
        camera: document.camera,
    }];
    let mut harness = editor_with(document, Vec::new());
    settle(&mut harness);
    harness.state_mut().reveal(Pane::Camera);
    harness.run_steps(8);
    let [remove, update, name] =
        ["Remove camera bookmark 1", "Update", "Camera bookmark 1"].map(|of| rect(&harness, of));
    let row = harness.get_by_role_and_label(Role::SpinButton, "Focal length").rect();
    assert!(remove.right() <= row.right() + 0.5, "{remove:?} beside {row:?}");
    assert!(name.right() < update.left() && update.right() < remove.left());
    assert!(name.width() > 40.0, "{name:?}");
    harness.get_by_label("Remove camera bookmark 1").click();
    harness.run_steps(2);
    assert!(harness.state().document().bookmarks.is_empty());
}

/// Lights that are not in the picture, before and behind the camera, end where they are let go.
#[test]
fn a_light_ends_where_the_pointer_lets_go() {
    for (yaw_deg, distance) in [(70.0, 30.0), (0.0, 40.0), (20.0, 1.2)] {
        let mut document = small_document();
        (document.camera.yaw_deg, document.camera.pitch_deg) = (0.0, 0.0);
        document.lighting.area_lights = vec![AreaLight {
            yaw_deg,
            pitch_deg: 15.0,
            distance,
            ..AreaLight::default()
        }];
        let mut harness = editor_with(document, Vec::new());
        settle(&mut harness);
        harness.state_mut().reveal(Pane::Lighting);
        harness.run_steps(4);
        let mark = "Move area light 1";
        let from = rect(&harness, mark).center();
        let viewport = rect(&harness, "Viewport");
        let to = viewport.center() + 0.3 * (from - viewport.center()) + Vec2::new(-20.0, 30.0);
        drag(&mut harness, from, to - from);
        settle(&mut harness);
        let now = rect(&harness, mark).center();
        assert!(now.distance(to) < 1.0, "yaw {yaw_deg}: {now} instead of {to}");
    }
}

/// What is typed from the moment on that a parameter is chosen in the palette replaces its value, however slow the frames.
#[test]
fn a_number_found_in_the_palette_is_replaced_at_once() {
    let mut harness = editor();
    request(&mut harness, Action::Do(Command::Palette));
    harness.run_steps(2);
    harness.event(Event::Text("specular roughness".to_owned()));
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    harness.step();
    for letter in ["0", ".", "2", "5"] {
        harness.event(Event::Text(letter.to_owned()));
        harness.step();
    }
    harness.run_steps(6);
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    let roughness = harness.state().document().materials[0].roughness;
    assert_eq!(roughness, 0.25);
}

#[test]
fn keys_and_mouse_scroll_in_a_low_window() {
    let mut harness = editor();
    harness.set_size(Vec2::new(900.0, 500.0));
    harness.key_press_modifiers(Modifiers::SHIFT, Key::F1);
    harness.run_steps(4);
    let window = Rect::from_min_size(Pos2::ZERO, Vec2::new(900.0, 500.0));
    // The heading; a command among the keys is called the same.
    let named = harness.query_all_by_label("Keys and mouse").map(|label| label.rect());
    let heading = named.min_by(|a, b| a.top().total_cmp(&b.top())).expect("it is open");
    let close = harness.get_by_role_and_label(Role::Button, "Close").rect();
    for place in [heading, close] {
        assert!(window.contains_rect(place), "{place:?}");
    }
    assert!(heading.bottom() < close.top(), "{heading:?} over {close:?}");
}

/// Over a panel with a search letters begin a search; elsewhere they are commands.
#[test]
fn letters_over_a_panel_with_a_search_are_typed_into_it() {
    let mut harness = editor();
    harness.state_mut().reveal(Pane::Presets);
    harness.run_steps(4);
    let before = harness.state().document().view.denoise;
    let search = "Search presets";
    harness.hover_at(rect(&harness, search).center() + Vec2::new(0.0, 120.0));
    harness.run_steps(2);
    for (key, letter) in [(Key::D, "d"), (Key::B, "b")] {
        type_letter(&mut harness, key, letter);
    }
    harness.run_steps(2);
    let typed = harness.get_by_role_and_label(Role::TextInput, search).value();
    assert_eq!(typed.as_deref(), Some("db"));
    assert_eq!(harness.state().document().view.denoise, before);
    // With the keys given up and the pointer over the picture.
    harness.key_press(Key::Escape);
    harness.hover_at(rect(&harness, "Viewport").center());
    harness.run_steps(2);
    type_letter(&mut harness, Key::D, "d");
    harness.run_steps(2);
    assert_ne!(
        harness.state().document().view.denoise == Denoise::Off,
        before == Denoise::Off
    );
}

#[test]
fn a_pinhole_has_no_f_number() {
    let mut harness = editor();
    harness.state_mut().reveal(Pane::Camera);
    harness.run_steps(4);
    let shown = |harness: &Editor| {
        let number = harness.get_by_role_and_label(Role::SpinButton, "f-number");
        number.value().unwrap_or_default()
    };
    assert!(shown(&harness).contains("pinhole"), "{}", shown(&harness));
}

/// The curve's help lies beside the plot, not over it.
#[test]
fn help_does_not_lie_over_the_curve() {
    let mut harness = editor();
    harness.state_mut().reveal(Pane::Curve);
    harness.run_steps(4);
    let plot = rect(&harness, "The curve D over ξ");
    harness.hover_at(plot.center());
    let help = "The share ξ of the samples stays";
    see(&mut harness, "the help", |harness| is_shown(harness, help));
    let shown = harness
        .query_all_by_label_contains(help)
        .next()
        .expect("it is shown")
        .rect();
    assert!(!plot.shrink(2.0).intersects(shown), "{shown:?} over {plot:?}");
}

#[test]
fn hard_cases_stop_at_once_and_are_named_in_words() {
    let mut harness = editor();
    harness.state_mut().reveal(Pane::Check);
    harness.run_steps(4);
    harness.get_by_label("Run the hard cases").click_accesskit();
    see_label(&mut harness, "roughness at its ends");
    assert!(!is_shown(&harness, "roughness-at-its-ends"));
    harness.get_by_label("Stop").click_accesskit();
    harness.run_steps(3);
    // Whatever is being measured.
    assert!(harness.query_by_label("Run the hard cases").is_some());
    assert!(is_shown(&harness, "Stopped."));
    harness.get_by_label("Run the hard cases").click_accesskit();
    see_label(&mut harness, "Stop");
    harness.get_by_label("Stop").click_accesskit();
    harness.run_steps(2);
}

#[test]
fn a_turntable_begins_with_four_seconds_and_tells_its_time() {
    let mut harness = editor();
    request(&mut harness, Action::Do(Command::Turntable));
    harness.run_steps(4);
    let frames = harness.get_by_label("Turntable frames").value().unwrap_or_default();
    assert_eq!(frames, "96");
    assert!(is_shown(&harness, "A turn of 4.0 s, rendered in about"));
}
