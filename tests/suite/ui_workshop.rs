//! What must not stand in the way of who works at the window: charts that can be read, a bar that fits, checks that can be
//! stopped, measurements that say when they are old, the engine that was chosen.

use super::ui::{Memory, editor, editor_of, editor_remembering, options};
use eframe::App as _;
use egui::accesskit::{Role, Toggled};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glossmith::{
    app::{App, Options, actions::Command, layout::Pane},
    render::{EngineChoice, EngineKind},
    store::examples::EXAMPLES,
};

#[test]
fn the_engine_chosen_in_the_menu_is_remembered() {
    let mut harness = editor_of(Options {
        engine: EngineChoice::Gpu,
        ..options()
    });
    harness.settle();
    harness.click(Role::Button, "Render");
    harness.click(Role::RadioButton, "Engine: CPU");
    harness.settle();
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
    harness.settle();
    let engine = harness.state().snapshot().engine.clone().expect("it renders");
    assert_eq!(
        (engine.kind, engine.reason.as_str()),
        (EngineKind::Cpu, "chosen by you")
    );
    harness.click(Role::Button, "Render");
    let choice = harness.get_by_role_and_label(Role::RadioButton, "Engine: CPU");
    assert_eq!(choice.accesskit_node().toggled(), Some(Toggled::True));
}

/// A check goes on beside the viewport, which renders meanwhile, and can be stopped.
#[test]
fn a_check_can_be_stopped_and_leaves_the_viewport_its_time() {
    let mut harness = editor();
    harness.reveal(Pane::Check);
    harness.tap_label("Check this machine");
    harness.see_label("Checking samples against densities …");
    harness.command(Command::Restart);
    harness.wait("a picture beside the check", App::is_settled);
    harness.see("what is left of it", |harness| harness.tells("against densities … "));
    harness.tap_label("Stop");
    harness.see_label("Stopped.");
    // The word comes a moment before the thread is free.
    harness.see_label("Check this machine");
}

/// The benchmark's section of *Check*: a quick run shows a table of the engines and hands on its result.
#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "thorough")]
fn the_benchmark_is_run_in_its_section() {
    let mut harness = editor();
    harness.reveal(Pane::Check);
    harness.tap(Role::CheckBox, "Quick");
    harness.tap_label("Run the benchmark");
    harness.see("the result", |harness| harness.has("Copy the result"));
    harness.get_by_label("Run the benchmark");
    for what in ["samples, default", "rays, default"] {
        assert!(
            harness.query_all_by_label(what).count() >= 2,
            "{what}: a CPU and an adapter"
        );
    }
    // The viewport goes on.
    harness.wait("the picture", App::is_settled);
}

#[test]
fn examples_are_opened_from_the_help_menu() {
    let mut harness = editor();
    let before = harness.document().clone();
    for example in &EXAMPLES {
        harness.click(Role::Button, "Help");
        harness.click_on(|harness| harness.get_by_label_contains("Examples").rect());
        harness.click(Role::Button, example.label);
        let document = (example.document)();
        assert_eq!(harness.document().materials, document.materials, "{}", example.label);
        assert_eq!(harness.document().model, document.model);
        document.check().expect("every number can be worked with");
        assert!(
            Pane::ALL.iter().any(|pane| pane.title() == example.panel),
            "{}",
            example.panel
        );
        harness.command(Command::Undo);
        assert_eq!(*harness.document(), before);
    }
}
