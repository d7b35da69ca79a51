//! What must not stand in the way of who works at the window: charts that can be read, a bar that fits, checks that can be
//! stopped, measurements that say when they are old, the engine that was chosen.

use std::fmt::Write as _;

use eframe::App as _;
use egui::accesskit::{Role, Toggled};
use egui::epaint::{ClippedShape, TextShape};
use egui::{Color32, Rect, Shape, Vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glossmith::app::actions::{Action, Command};
use glossmith::app::layout::Pane;
use glossmith::app::{App, Options};
use glossmith::document::Document;
use glossmith::render::{EngineChoice, EngineKind, RayQueries};
use glossmith::scene::ModelSource;
use glossmith::store::examples::EXAMPLES;

use super::cli_support::passes_alone;
use super::gltf_builder::Folder;
use super::ui::{
    Editor, Memory, editor, editor_of, editor_remembering, options, request, see, see_label, settle, undo, wait,
};
use super::ui_study::race_strategies;
use super::worker::small_document;

#[test]
fn the_engine_chosen_in_the_menu_is_remembered() {
    let mut harness = editor_of(Options {
        engine: EngineChoice::Gpu,
        ..options()
    });
    settle(&mut harness);
    harness.get_by_role_and_label(Role::Button, "Render").click();
    harness.run_steps(3);
    harness.get_by_role_and_label(Role::RadioButton, "Engine: CPU").click();
    harness.run_steps(3);
    settle(&mut harness);
    let mut memory = Memory::default();
    harness.state_mut().save(&mut memory);
    drop(harness);
    // Nothing is said on the command line.
    let mut harness = editor_remembering(
        memory,
        Options {
            engine: EngineChoice::Auto,
            ..options()
        },
    );
    settle(&mut harness);
    let engine = harness.state().snapshot().engine.clone().expect("it renders");
    assert_eq!(
        (engine.kind, engine.reason.as_str()),
        (EngineKind::Cpu, "chosen by you")
    );
    harness.get_by_role_and_label(Role::Button, "Render").click();
    harness.run_steps(3);
    let choice = harness.get_by_role_and_label(Role::RadioButton, "Engine: CPU");
    assert_eq!(choice.accesskit_node().toggled(), Some(Toggled::True));
}

/// Another test's window, whose menu is opened at random, would change the choice meanwhile.
#[test]
fn ray_queries_switched_off_in_the_menu_stay_off() {
    passes_alone("ui_workshop::switching_ray_queries_off");
}

#[test]
#[ignore = "the child of the test above: the choice holds for the whole process"]
fn switching_ray_queries_off() {
    let mut harness = editor();
    settle(&mut harness);
    let toggled = |harness: &mut Editor| {
        harness.get_by_role_and_label(Role::Button, "Render").click();
        harness.run_steps(3);
        let off = harness.get_by_role_and_label(Role::RadioButton, "Ray queries: Off");
        off.accesskit_node().toggled()
    };
    assert_eq!(toggled(&mut harness), Some(Toggled::False));
    harness
        .get_by_role_and_label(Role::RadioButton, "Ray queries: Off")
        .click();
    harness.run_steps(3);
    assert_eq!(RayQueries::chosen(), RayQueries::Off);
    let mut memory = Memory::default();
    harness.state_mut().save(&mut memory);
    drop(harness);
    // As in a new process, to which nothing is said on the command line.
    RayQueries::Auto.choose();
    let mut harness = editor_remembering(memory, options());
    assert_eq!(toggled(&mut harness), Some(Toggled::True));
}

/// Texts as they are painted, with their colours.
fn texts(harness: &Editor) -> Vec<(Rect, String, Color32)> {
    fn add(shape: &Shape, clip: Rect, found: &mut Vec<(Rect, String, Color32)>) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| add(shape, clip, found)),
            Shape::Text(TextShape {
                galley,
                pos,
                fallback_color,
                override_text_color,
                angle,
                ..
            }) if *angle == 0.0 => {
                let rect = galley.rect.translate(pos.to_vec2());
                let section = galley.job.sections.first().map(|section| section.format.color);
                let own = section.filter(|color| *color != Color32::PLACEHOLDER);
                let color = override_text_color.or(own).unwrap_or(*fallback_color);
                if clip.intersects(rect) {
                    found.push((rect, galley.text().to_owned(), color));
                }
            }
            _ => {}
        }
    }
    let mut found = Vec::new();
    for ClippedShape { clip_rect, shape, .. } in &harness.output().shapes {
        add(shape, *clip_rect, &mut found);
    }
    found
}

/// Contrast of a colour on another (WCAG 2.1).
fn contrast(text: Color32, ground: Color32) -> f32 {
    let blended = |i: usize| {
        let [text, ground] = [text.to_array(), ground.to_array()];
        let share = f32::from(text[3]) / 255.0;
        (f32::from(text[i]) + (1.0 - share) * f32::from(ground[i])) / 255.0
    };
    let linear = |x: f32| {
        if x <= 0.04045 {
            x / 12.92
        } else {
            ((x + 0.055) / 1.055).powf(2.4)
        }
    };
    let luminance = |[r, g, b]: [f32; 3]| 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
    let opaque = |color: Color32| [0, 1, 2].map(|i| f32::from(color.to_array()[i]) / 255.0);
    let (a, b) = (luminance([0, 1, 2].map(blended)), luminance(opaque(ground)));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

/// Whether a text is a number with its unit, as at an axis.
fn is_tick(text: &str) -> bool {
    let number = text.trim_end_matches(|c: char| c.is_alphabetic() || " %°µ".contains(c));
    !text.is_empty() && number.trim().parse::<f64>().is_ok()
}

/// The labels at the axes of a chart lie beside it, over nothing else, and can be read.
fn assert_legible(harness: &Editor, chart: &str) {
    let place = harness.get_by_label(chart).rect();
    let ground = harness.ctx.global_style().visuals.panel_fill;
    let around = Rect::from_min_max(place.min - Vec2::new(60.0, 8.0), place.max + Vec2::new(8.0, 22.0));
    let texts = texts(harness);
    let ticks: Vec<_> = texts
        .iter()
        .filter(|(rect, text, _)| is_tick(text) && around.intersects(*rect) && !place.contains(rect.center()))
        .collect();
    assert!(ticks.len() >= 4, "{chart} has labels at its axes: {ticks:?}");
    for (rect, text, color) in ticks {
        let told = contrast(*color, ground);
        assert!(told > 4.5, "{chart}: {text} has a contrast of {told}");
        let beside = rect.max.y <= place.max.y + 0.5 && rect.min.y >= place.min.y - 0.5;
        let below = rect.min.x >= place.min.x - 0.5 && rect.max.x <= place.max.x + 0.5;
        assert!(beside || below, "{chart}: {text} at {rect} lies outside of {place}");
        let over = texts.iter().find(|(other, what, _)| {
            let is_another = (other, what) != (rect, text);
            is_another && other.shrink(1.5).intersects(rect.shrink(1.5))
        });
        assert!(over.is_none(), "{chart}: {text} is drawn over {over:?}");
    }
}

#[test]
fn charts_can_be_read_in_both_themes() {
    let mut harness = editor();
    let charts = [
        (Pane::Curve, "The curve D over ξ"),
        (Pane::Lobe, "Polar slice"),
        (Pane::Samples, "How often each angle is drawn"),
        (Pane::Convergence, "Error against time"),
    ];
    for (pane, chart) in charts {
        harness.state_mut().reveal(pane);
        // Another panel's controls may have the same names.
        harness.run_steps(3);
        if pane == Pane::Samples {
            harness.get_by_role_and_label(Role::Button, "Angle").click();
            harness.run_steps(2);
        }
        see_label(&mut harness, chart);
        for _ in 0..2 {
            request(&mut harness, Action::Do(Command::ToggleTheme));
            see_label(&mut harness, chart);
            harness.run_steps(3);
            assert_legible(&harness, chart);
        }
    }
}

#[test]
fn a_lobes_chart_is_never_shown_under_another_name() {
    let mut harness = editor();
    harness.state_mut().reveal(Pane::Lobe);
    see_label(&mut harness, "Polar slice");
    harness.get_by_role_and_label(Role::ComboBox, "Lobe view").click();
    harness.run_steps(2);
    harness.get_by_role_and_label(Role::Button, "Albedo").click();
    harness.run_steps(2);
    see(&mut harness, "the albedo's chart", |harness| {
        assert!(harness.query_by_label("Polar slice").is_none(), "the old chart stays");
        let shown = |label| harness.query_all_by_label(label).count() > 0;
        !shown("Computing the lobe") && shown("Albedo")
    });
}

/// The rectangles of what the status bar says, as it is painted.
fn of_status_bar(harness: &Editor, size: Vec2) -> Vec<(Rect, String)> {
    let bar = size.y - 30.0;
    let painted = texts(harness).into_iter().filter(|(rect, ..)| rect.top() >= bar);
    painted.map(|(rect, text, _)| (rect, text)).collect()
}

#[test]
fn all_tabs_fit_a_small_screen() {
    let mut harness = editor();
    harness.set_size(Vec2::new(1366.0, 768.0));
    settle(&mut harness);
    let viewport = harness.get_by_label("Viewport").rect();
    for pane in Pane::ALL.into_iter().filter(|pane| *pane != Pane::Viewport) {
        let mut tabs = harness.query_all_by_label(pane.title()).map(|node| node.rect());
        let tab = tabs.find(|tab| tab.height() > 20.0).expect("a tab");
        let docks = [(0.0, viewport.left()), (viewport.right(), 1366.0)];
        let (left, right) = docks[usize::from(tab.left() > viewport.left())];
        // Beside the arrows that would scroll them there would be less room.
        assert!(
            tab.left() >= left && tab.right() <= right,
            "{}: {tab} in {left} to {right}",
            pane.title()
        );
    }
}

#[test]
fn the_status_bar_fits_a_narrow_window() {
    let mut harness = editor();
    for width in [760.0, 800.0, 1024.0, 1366.0, 1920.0] {
        let size = Vec2::new(width, 768.0);
        harness.set_size(size);
        harness.run_steps(4);
        let parts = of_status_bar(&harness, size);
        assert!(parts.iter().any(|(_, text)| text == "done"), "{parts:?}");
        assert!(parts.iter().any(|(_, text)| text.contains("samples")), "{parts:?}");
        for (i, (rect, text)) in parts.iter().enumerate() {
            assert!(
                rect.right() <= width,
                "{width}: {text} lies beyond the window at {rect:?}"
            );
            let over = parts[i + 1..]
                .iter()
                .find(|(other, _)| other.shrink(1.0).intersects(*rect));
            assert!(over.is_none(), "{width}: {text} lies over {over:?}");
        }
    }
    let wide = of_status_bar(&harness, Vec2::new(1920.0, 768.0));
    assert!(wide.iter().any(|(_, text)| text.contains("samples/s")), "{wide:?}");
    assert!(wide.iter().any(|(_, text)| text.starts_with("window")), "{wide:?}");
}

/// A check goes on beside the viewport, which renders meanwhile, and can be stopped.
#[test]
fn a_check_can_be_stopped_and_leaves_the_viewport_its_time() {
    let mut harness = editor();
    harness.state_mut().reveal(Pane::Check);
    harness.run_steps(3);
    harness
        .get_by_role_and_label(Role::CheckBox, "Thorough")
        .click_accesskit();
    harness.run_steps(2);
    harness.get_by_label("Check this machine").click_accesskit();
    see_label(&mut harness, "Checking samples against densities …");
    request(&mut harness, Action::Do(Command::Restart));
    wait(&mut harness, "a picture beside the check", App::is_settled);
    see(&mut harness, "what is left of it", |harness| {
        harness
            .query_all_by_label_contains("against densities … ")
            .next()
            .is_some()
    });
    harness.get_by_label("Stop").click_accesskit();
    see_label(&mut harness, "Stopped.");
    // The word comes a moment before the thread is free.
    see_label(&mut harness, "Check this machine");
    // The hard cases have a button of their own.
    harness.get_by_label("Run the hard cases").click_accesskit();
    see_label(&mut harness, "Stop");
    harness.get_by_label("Stop").click_accesskit();
    see(&mut harness, "the end of the hard cases", |harness| {
        harness.query_by_label("Run the hard cases").is_some()
    });
}

/// Help › Benchmark opens its section; a quick run shows a table of the engines and hands on its result.
#[test]
fn the_benchmark_is_run_from_the_help_menu() {
    let mut harness = editor();
    harness.get_by_label("Help").click_accesskit();
    harness.run_steps(3);
    harness.get_by_label("Benchmark").click_accesskit();
    harness.run_steps(5);
    harness.get_by_role_and_label(Role::CheckBox, "Quick").click_accesskit();
    harness.run_steps(2);
    harness.get_by_label("Run the benchmark").click_accesskit();
    see(&mut harness, "the result", |harness| {
        harness.query_by_label("Copy the result").is_some()
    });
    harness.get_by_label("Run the benchmark");
    for what in ["samples, default", "rays, default"] {
        assert!(
            harness.query_all_by_label(what).count() >= 2,
            "{what}: a CPU and an adapter"
        );
    }
    // The viewport goes on.
    wait(&mut harness, "the picture", App::is_settled);
}

/// A model of so many triangles that reading it takes a while.
fn write_large_model(path: &std::path::Path) {
    let mut text = String::new();
    for i in 0..60_000 {
        let _ = writeln!(text, "v {i} 0 0\nv {i} 1 0\nv {i} 0 1");
        let first = 3 * i + 1;
        let _ = writeln!(text, "f {first} {} {}", first + 1, first + 2);
    }
    std::fs::write(path, text).expect("a temporary file");
}

#[test]
fn the_viewport_says_what_is_being_loaded() {
    let folder = Folder::new();
    let path = folder.path("many.obj");
    write_large_model(&path);
    let mut harness = editor();
    request(&mut harness, Action::Open(path.clone()));
    see(&mut harness, "what is loaded", |harness| {
        harness.query_by_label_contains("Loading").is_some()
    });
    let viewport = harness.get_by_label("Viewport").rect();
    assert!(viewport.contains_rect(harness.get_by_label_contains("Loading").rect()));
    wait(&mut harness, "the model", |app| {
        app.document().model == ModelSource::File(path.clone())
    });
    settle(&mut harness);
    assert!(harness.query_by_label_contains("Loading").is_none());
}

#[test]
fn a_race_of_another_model_says_so_and_offers_nothing() {
    let mut harness = editor_of(Options {
        document: Some(Document {
            model: ModelSource::Sphere,
            ..small_document()
        }),
        ..options()
    });
    settle(&mut harness);
    race_strategies(&mut harness, 0.02);
    let (by_light, by_lobe) = ("Use Light sampling only", "Use BSDF sampling only");
    see_label(&mut harness, by_light);
    let is_live = |harness: &Editor, use_it: &str| !harness.get_by_label(use_it).accesskit_node().is_disabled();
    let old = "Measured before the last changes.";
    assert!(is_live(&harness, by_light) && harness.query_by_label(old).is_none());
    // What the race itself offers does not make it old.
    harness.get_by_label(by_light).click_accesskit();
    settle(&mut harness);
    assert!(is_live(&harness, by_lobe) && harness.query_by_label(old).is_none());
    request(&mut harness, Action::UseModel(ModelSource::Plane));
    wait(&mut harness, "the plane", |app| {
        app.document().model == ModelSource::Plane
    });
    settle(&mut harness);
    assert!(harness.query_by_label(old).is_some(), "nothing says that it is old");
    assert!(!is_live(&harness, by_light) && !is_live(&harness, by_lobe));
    undo(&mut harness);
    assert!(is_live(&harness, by_light) && harness.query_by_label(old).is_none());
}

/// The first start of all opens on a scene, and so does a new document.
#[test]
fn the_first_start_has_a_scene() {
    let options = || Options {
        document: None,
        resolution: Some(glossmith::app::Resolution::Half),
        ..options()
    };
    let mut harness = editor_remembering(Memory::default(), options());
    let document = harness.state().document().clone();
    assert!(
        document.ground && document.materials[0].coat_weight > 0.0,
        "{document:?}"
    );
    let mut memory = Memory::default();
    harness.state_mut().save(&mut memory);
    drop(harness);
    let harness = editor_remembering(memory, options());
    assert_eq!(
        *harness.state().document(),
        document,
        "a new document is the same scene"
    );
}

#[test]
fn examples_are_opened_from_the_help_menu() {
    let mut harness = editor();
    let before = harness.state().document().clone();
    for example in &EXAMPLES {
        harness.get_by_role_and_label(Role::Button, "Help").click();
        harness.run_steps(3);
        harness.get_by_label_contains("Examples").hover();
        harness.run_steps(3);
        harness.get_by_label_contains("Examples").click();
        harness.run_steps(3);
        harness.get_by_role_and_label(Role::Button, example.label).click();
        harness.run_steps(3);
        let document = (example.document)();
        assert_eq!(
            harness.state().document().materials,
            document.materials,
            "{}",
            example.label
        );
        assert_eq!(harness.state().document().model, document.model);
        document.check().expect("every number can be worked with");
        assert!(
            Pane::ALL.iter().any(|pane| pane.title() == example.panel),
            "{}",
            example.panel
        );
        request(&mut harness, Action::Do(Command::Undo));
        assert_eq!(*harness.state().document(), before);
    }
}

#[test]
fn a_lens_is_set_in_a_photographers_terms() {
    let mut harness = editor();
    harness.state_mut().reveal(Pane::Camera);
    settle(&mut harness);
    let set = |harness: &mut Editor, name: &str, value: f64| {
        harness
            .get_by_role_and_label(Role::SpinButton, name)
            .set_value_accesskit(value);
        harness.run_steps(3);
    };
    let camera = |harness: &Editor| harness.state().document().camera;
    let before = harness.state().document().clone();
    set(&mut harness, "Focal length", 50.0);
    assert!(
        (camera(&harness).fov_deg - 26.9915).abs() < 1e-3,
        "{}",
        camera(&harness).fov_deg
    );
    set(&mut harness, "f-number", 0.5);
    let scene = harness.state().snapshot().scene.clone().expect("it renders");
    let radius_mm = 1000.0 * scene.job.geometry.world_units_per_unit;
    // The lens is as wide as twice its focal length.
    let expected = 50.0 / radius_mm;
    assert!(
        (camera(&harness).aperture / expected - 1.0).abs() < 1e-3,
        "{}",
        camera(&harness).aperture
    );
    // The same angle on a smaller sensor is another lens.
    harness.get_by_role_and_label(Role::ComboBox, "Sensor").click();
    harness.run_steps(3);
    harness.get_by_label("APS-C").click();
    harness.run_steps(3);
    assert!((camera(&harness).fov_deg - 26.9915).abs() < 1e-3);
    let focal = harness.get_by_role_and_label(Role::SpinButton, "Focal length");
    assert!((focal.accesskit_node().numeric_value().expect("a number") - 32.5).abs() < 0.1);
    let [width, height] = [
        harness.state().document().render.width,
        harness.state().document().render.height,
    ];
    harness.get_by_role_and_label(Role::ComboBox, "Aspect").scroll_to_me();
    harness.run_steps(3);
    harness.get_by_role_and_label(Role::ComboBox, "Aspect").click();
    harness.run_steps(3);
    harness.get_by_label("2.39 : 1").click();
    harness.run_steps(3);
    let wide = harness.state().document().render;
    assert_eq!(
        (wide.width, wide.height),
        (width, (f64::from(width) / 2.39).round() as u32)
    );
    assert_ne!(wide.height, height);
    for _ in 0..3 {
        undo(&mut harness);
    }
    assert_eq!(*harness.state().document(), before);
}
