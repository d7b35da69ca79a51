//! What must not stand in the way of who works at the window: charts that can be read, a bar that fits, checks that can be
//! stopped, measurements that say when they are old, the engine that was chosen.

use super::cli_support::passes_alone;
use super::ui::{
    Editor, Memory, editor, editor_of, editor_remembering, options, request, see, see_label, settle, wait,
};
use eframe::App as _;
use egui::accesskit::{Role, Toggled};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glossmith::app::actions::{Action, Command};
use glossmith::app::layout::Pane;
use glossmith::app::{App, Options};
use glossmith::render::{EngineChoice, EngineKind, RayQueries};
use glossmith::store::examples::EXAMPLES;

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
#[cfg_attr(not(feature = "thorough"), ignore = "thorough")]
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
