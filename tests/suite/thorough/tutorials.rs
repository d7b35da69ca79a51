//! Tutorials of the book, followed step by step: each gesture in the window through its accessibility tree, each command
//! by the program. A page that names what is not there any more fails.

use std::collections::BTreeSet;
use std::path::Path;

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, Vec2};
use egui_kittest::kittest::Queryable as _;
use glossmith::app::actions::Action;
use glossmith::app::layout::Pane;
use glossmith::app::workspaces::LOOK;
use glossmith::app::{App, Options};
use glossmith::document::{Denoise, Document};
use glossmith::optics::lobe::Lobe;
use glossmith::render::shown::Shown;
use glossmith::scene::environment::EnvironmentSource;
use glossmith::store::examples::still_life;
use serde_json::Value;

use super::cli_support::{Workplace, write_hdr};
use super::docs::{pages, text_of};
use super::docs_commands::{arguments, commands};
use super::gltf_builder::{glb, square};
use super::ui::{Editor, drag, editor, editor_of, options, request, see, settle, wait};
use super::ui_files::{drop_on, wait_for_words};
use super::ui_hands::{press, type_path};
use super::worker::small_document;

fn tutorial(name: &str) -> String {
    text_of(&Path::new("docs/tutorials").join(name))
}

fn window_with(options: Options) -> (Editor, tempfile::TempDir) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut harness = editor_of(Options {
        typed_paths: Some(folder.path().to_owned()),
        ..options
    });
    settle(&mut harness);
    (harness, folder)
}

/// Brings a panel to the front by its tab.
fn tab(harness: &mut Editor, pane: Pane) {
    let tab = harness.query_all_by_role_and_label(Role::Button, pane.title()).next();
    let at = tab.expect("the panel's tab").rect().center();
    super::ui_scene::click_at(harness, at);
    harness.run_steps(3);
}

/// Presses a button, wherever it is scrolled to.
fn tap(harness: &mut Editor, label: &str) {
    harness.get_by_role_and_label(Role::Button, label).click_accesskit();
    harness.run_steps(3);
}

/// The names of the window that a page gives in italics, such as *File › Export…*, in their parts.
fn names(page: &str) -> BTreeSet<String> {
    let text: String = page.split("```").step_by(2).collect();
    let text: String = text.replace("**", "").split('`').step_by(2).collect();
    let italic = text.split('*').skip(1).step_by(2);
    italic
        .flat_map(|name| name.split(" › "))
        .map(|name| name.replace('\n', " "))
        .collect()
}

/// The texts of the program's sources.
fn literals(folder: &Path, found: &mut String) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            literals(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push_str(&std::fs::read_to_string(path).unwrap());
        }
    }
}

/// What tutorials and how-to pages call by an italic name is called so in the window: as a label, a choice or an entry.
#[test]
fn names_of_the_window_that_the_pages_give_exist() {
    let root = Path::new(crate::ROOT);
    let mut sources = String::new();
    for folder in [
        "src/app",
        "src/document",
        "src/render",
        "src/optics",
        "src/scene/environment",
        "src/store",
        "src/study",
    ] {
        literals(&root.join(folder), &mut sources);
    }
    let presets: BTreeSet<_> = glossmith::store::PRESETS
        .iter()
        .map(|preset| preset.name.clone())
        .collect();
    let mut count = 0;
    for page in pages() {
        let path = page.display().to_string().replace('\\', "/");
        if !["docs/tutorials/", "docs/how-to/", "docs/reference/window.md"]
            .iter()
            .any(|start| path.starts_with(start))
        {
            continue;
        }
        for name in names(&text_of(&page)) {
            let is_literal = ["\"", " {", " ({"]
                .iter()
                .any(|end| sources.contains(&format!("\"{name}{end}")));
            let is_there = is_literal || presets.contains(&name);
            assert!(is_there, "{path} names *{name}*, which the window does not have");
            count += 1;
        }
    }
    assert!(count > 60, "{count} names");
}

#[test]
fn your_first_material() {
    // What a newcomer gets: the still life in the workspace Look.
    let still_life = Document {
        render: small_document().render,
        ..still_life()
    };
    let (mut harness, folder) = window_with(Options {
        document: Some(still_life),
        workspace: Some(LOOK.to_owned()),
        ..options()
    });
    let document = |harness: &Editor| harness.state().document().clone();
    // 1. Choose a preset: it goes to the teapot.
    tab(&mut harness, Pane::Presets);
    harness.get_by_role_and_label(Role::TextInput, "Search presets").click();
    harness.run_steps(2);
    harness.event(Event::Text("gold".to_owned()));
    harness.run_steps(3);
    tap(&mut harness, "Gold");
    settle(&mut harness);
    assert_eq!(document(&harness).materials[0].name, "Gold");
    assert_eq!(document(&harness).materials.len(), 4);
    // 2. Change the roughness: by the bar, by its label, and by a search.
    tab(&mut harness, Pane::Material);
    let gold = document(&harness).materials[0].roughness;
    let bar = harness
        .get_by_role_and_label(Role::SpinButton, "Specular roughness")
        .rect();
    drag(
        &mut harness,
        bar.left_center() + Vec2::new(8.0, 0.0),
        Vec2::new(60.0, 0.0),
    );
    assert_ne!(document(&harness).materials[0].roughness, gold);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::K);
    harness.run_steps(2);
    for words in ["spec rough", "0.4"] {
        harness.event(Event::Text(words.to_owned()));
        harness.run_steps(2);
        harness.key_press(Key::Enter);
        harness.run_steps(4);
    }
    settle(&mut harness);
    assert_eq!(document(&harness).materials[0].roughness, 0.4);
    // 3. Turn the light.
    tap(&mut harness, "Sky");
    wait(&mut harness, "the sky", |app| {
        app.document().lighting.environment == EnvironmentSource::Sky
    });
    settle(&mut harness);
    let before = document(&harness);
    let center = harness.get_by_label("Viewport").rect().center();
    harness.event(Event::ModifiersChanged(Modifiers::SHIFT));
    drag(&mut harness, center, Vec2::new(50.0, 0.0));
    harness.event(Event::ModifiersChanged(Modifiers::NONE));
    assert_ne!(document(&harness).lighting.rotation_deg, before.lighting.rotation_deg);
    drag(&mut harness, center, Vec2::new(50.0, 0.0));
    assert_ne!(document(&harness).camera.yaw_deg, before.camera.yaw_deg);
    // 4. Compare with GGX.
    harness.key_press(Key::C);
    harness.run_steps(3);
    harness.get_by_role_and_label(Role::ComboBox, "Compare with").click();
    harness.run_steps(3);
    tap(&mut harness, Lobe::Ggx.label());
    wait(&mut harness, "GGX as B", |app| {
        let rival = app.rival_snapshot().and_then(|rival| rival.picture.clone());
        rival.is_some_and(|picture| picture.document.materials[0].lobe == Lobe::Ggx)
    });
    harness.key_press(Key::C);
    settle(&mut harness);
    // 5. Save: the image has the document inside, and opens as one.
    let saved = document(&harness);
    let path = folder.path().join("gold.png");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::E);
    type_path(&mut harness, &path, "Save");
    wait_for_words(&mut harness, "saved");
    tap(&mut harness, "Satin gold");
    settle(&mut harness);
    drop_on(&mut harness, &[path]);
    let is_back = |app: &App| app.document().materials == saved.materials;
    see(&mut harness, "the image or a question", |harness| {
        is_back(harness.state()) || harness.query_by_label("Discard").is_some()
    });
    if !is_back(harness.state()) {
        press(&mut harness, "Discard");
    }
    wait(&mut harness, "the document of the image", is_back);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    type_path(&mut harness, &folder.path().join("gold.json"), "Save");
    wait_for_words(&mut harness, "gold.json");
}

#[test]
fn the_commands_of_your_model_under_your_light() {
    let place = Workplace::new();
    let (buffer, document) = square();
    place.write("chair.glb", &glb(&document, &buffer.bytes));
    write_hdr(&place.path("loft.hdr"), 8, 4, |_, _| [1.0; 3]);
    follow(
        &place,
        &tutorial("your-model.md"),
        &[("--engine", "cpu"), ("--size", "16x12"), ("--noise", "0.5")],
    );
    for file in ["chair.png", "chair.exr"] {
        assert!(place.path(file).exists(), "{file}");
    }
}

/// Runs the commands of a tutorial with values of options in place of its own, or added: small images, little time. The
/// answers in JSON.
fn follow(place: &Workplace, page: &str, small: &[(&str, &str)]) -> Vec<Value> {
    let mut answers = Vec::new();
    for command in commands(page) {
        let mut words = arguments(&command).split_off(1);
        for (option, value) in small {
            match words.iter().position(|word| word == option) {
                Some(at) => words[at + 1] = (*value).to_owned(),
                None if words[0] == "render" => words.extend([(*option).to_owned(), (*value).to_owned()]),
                None => {}
            }
        }
        let run = place.done(&words.join(" "));
        answers.extend(serde_json::from_str::<Value>(&run.stdout).ok());
    }
    answers
}

#[test]
fn the_commands_of_the_geometric_lobe() {
    let place = Workplace::new();
    follow(&place, &tutorial("geometric-lobe.md"), &[]);
    for file in ["samples.png", "polar.png"] {
        assert!(place.path(file).exists(), "{file}");
    }
}

#[test]
fn automate_it() {
    let page = tutorial("automate.md");
    let place = Workplace::new();
    // The calls of the Python blocks, as arguments.
    let calls = page
        .split("glossmith(\"")
        .skip(1)
        .filter_map(|rest| rest.split(')').next());
    let calls: Vec<String> = calls.map(|call| call.replace("\", \"", " ").replace('"', "")).collect();
    assert!(calls.len() >= 5, "{calls:?}");
    // As the window saves it.
    let mut scene = super::worker::small_document();
    scene.view.denoise = Denoise::Fast;
    glossmith::store::save_document(&place.path("scene.json"), &scene).unwrap();
    place.write(
        "scene.toml",
        b"materials = [\"gold\", \"chrome\"]\n[common]\nsize = \"16x16\"\nsamples = 2\nengine = \"cpu\"\n",
    );
    for call in calls {
        let run = place.done(&call);
        let says_so = run.stderr.contains("a part of the samples is not denoised");
        assert_eq!(says_so, call.contains("--samples-from"), "{call}: {}", run.stderr);
        let answers = call.starts_with("batch") || call.contains("--json");
        if !answers {
            continue;
        }
        let lines: Vec<Value> = match call.starts_with("batch") {
            true => run
                .stdout
                .lines()
                .map(|line| serde_json::from_str(line).unwrap())
                .collect(),
            false => vec![serde_json::from_str(&run.stdout).unwrap()],
        };
        let key = match call.split(' ').next() {
            Some("render") => "noise",
            Some("batch") => "status",
            Some("merge") => "samples_per_pixel",
            Some("plan") => "effects",
            _ => "materials",
        };
        let answer = if lines[0].is_array() { &lines[0][0] } else { &lines[0] };
        assert!(!answer[key].is_null(), "{call}: {answer}");
    }
    // The batch of the page, without the files that are the reader's own.
    let batch = page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next());
    let mut batch = batch.expect("a batch").to_owned();
    for (own, instead) in [
        (r#", { name = "chair", model = "chair.glb", variant = "red" }"#, ""),
        (r#""mine.json", "#, ""),
        (r#", "loft.hdr""#, ""),
        ("frames = 36 ", "frames = 1 "),
        ("samples = 64", "samples = 1"),
        ("640x480", "16x12"),
    ] {
        assert!(batch.contains(own), "{own} in {batch}");
        batch = batch.replace(own, instead);
    }
    place.write("page.toml", batch.as_bytes());
    let run = place.done("batch page.toml --pictures 1-1");
    assert!(run.stdout.contains("rendered"), "{}", run.stdout);
}

/// What the viewport can show is what the tutorial lists.
#[test]
fn the_display_menu_has_what_the_pages_list() {
    let page = text_of(Path::new("docs/reference/window.md"));
    for (_, label, _) in Shown::ALL.iter().filter(|(shown, ..)| *shown != Shown::Picture) {
        assert!(page.contains(label), "docs/reference/window.md lacks {label}");
    }
    let mut harness = editor();
    request(&mut harness, Action::Show(Shown::Error));
    see(&mut harness, "the map", |harness| harness.state().is_settled());
}
