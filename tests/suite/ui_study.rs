//! The race and the ledger in the editor, with the real renderer.

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable as _;
use glossmith::app::layout::Pane;
use glossmith::document::{Document, Strategy};
use glossmith::scene::ModelSource;

use super::ui::{editor_of, options, settle, undo, wait};
use super::worker::small_document;

fn sphere() -> Document {
    Document {
        model: ModelSource::Sphere,
        ..small_document()
    }
}

#[test]
fn a_race_is_run_and_its_winner_taken() {
    let mut harness = editor_of(glossmith::app::Options {
        document: Some(sphere()),
        ..options()
    });
    settle(&mut harness);
    harness.state_mut().reveal(Pane::Race);
    harness.run_steps(2);
    // The strategies alone, and briefly.
    for kind in ["Bounces", "Fresnel term"] {
        harness.get_by_role_and_label(Role::CheckBox, kind).click_accesskit();
        harness.run_steps(2);
    }
    harness
        .get_by_role_and_label(Role::SpinButton, "Time of each")
        .set_value_accesskit(0.05);
    harness.run_steps(2);
    harness.get_by_label("Run the race").click_accesskit();
    harness.run_steps(2);
    let begun = std::time::Instant::now();
    while harness.query_by_label("Use Light by: light").is_none() {
        assert!(
            begun.elapsed() < super::ui::PATIENCE,
            "no race was run: {:?}",
            harness.state().messages()
        );
        harness.step();
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    assert!(
        harness.query_by_label("Time against bias").is_some(),
        "the chart is shown"
    );
    assert_eq!(harness.state().document().render.strategy, Strategy::Mis);
    harness.get_by_label("Equal error").click_accesskit();
    harness.run_steps(2);
    harness.get_by_label("Use Light by: light").click_accesskit();
    settle(&mut harness);
    assert_eq!(harness.state().document().render.strategy, Strategy::Light);
    undo(&mut harness);
    assert_eq!(harness.state().document().render.strategy, Strategy::Mis);
}

#[test]
fn a_race_can_be_stopped() {
    let mut harness = editor_of(glossmith::app::Options {
        document: Some(sphere()),
        ..options()
    });
    settle(&mut harness);
    harness.state_mut().reveal(Pane::Race);
    harness.run_steps(2);
    harness
        .get_by_role_and_label(Role::SpinButton, "Time of each")
        .set_value_accesskit(300.0);
    harness.run_steps(2);
    harness.get_by_label("Run the race").click_accesskit();
    harness.run_steps(3);
    harness.get_by_label("Stop").click_accesskit();
    let begun = std::time::Instant::now();
    while harness.query_by_label("Run the race").is_none() {
        assert!(begun.elapsed() < super::ui::PATIENCE, "it goes on");
        harness.step();
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    // The viewport renders again.
    wait(&mut harness, "a finished picture", glossmith::app::App::is_settled);
}

#[test]
fn the_ledger_is_measured_on_demand() {
    let mut harness = editor_of(glossmith::app::Options {
        document: Some(sphere()),
        ..options()
    });
    settle(&mut harness);
    harness.state_mut().reveal(Pane::Effects);
    harness.run_steps(2);
    harness.get_by_label("Measure what it costs").click_accesskit();
    harness.run_steps(2);
    let begun = std::time::Instant::now();
    while harness
        .query_by_label_contains("Schlick's Fresnel (instead of exact): ")
        .is_none()
    {
        assert!(
            begun.elapsed() < super::ui::PATIENCE,
            "no ledger: {:?}",
            harness.state().messages()
        );
        harness.step();
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    assert!(
        harness
            .query_by_label_contains("ms for one sample of every pixel")
            .is_some()
    );
    // What was measured of an effect stands beside the reason for it, too.
    assert!(harness.query_all_by_label_contains(" · ").count() > 2);
}
