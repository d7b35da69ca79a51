//! The race and the ledger in the editor, with the real renderer.

use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glossmith::{app::actions::Command, app::layout::Pane, document::Document, document::Strategy, scene::ModelSource};

use super::{
    ui::{Editor, editor_of, options},
    worker::small_document,
};

fn sphere() -> Document {
    Document {
        model: ModelSource::Sphere,
        ..small_document()
    }
}

/// Has the strategies alone race, for so many seconds each.
pub fn race_strategies(harness: &mut Editor, seconds_each: f64) {
    race_kinds(harness, &["Bounces", "Fresnel term"], seconds_each);
}

/// Has the kinds race that are chosen, for so many seconds each, these chosen or not any more.
fn race_kinds(harness: &mut Editor, changed: &[&str], seconds_each: f64) {
    harness.reveal(Pane::Race);
    for kind in changed {
        harness.tap(Role::CheckBox, kind);
    }
    harness.set("Time per technique", seconds_each);
    harness.tap_label("Run the race");
}

/// An editor whose sphere is rendered.
fn sphere_editor() -> Editor {
    let mut harness = editor_of(glossmith::app::Options {
        document: Some(sphere()),
        ..options()
    });
    harness.settle();
    harness
}

#[test]
fn a_race_is_run_and_its_winner_taken() {
    let mut harness = sphere_editor();
    race_strategies(&mut harness, 0.05);
    harness.see_label("Use Light sampling only");
    assert!(harness.has("Time against bias"), "the chart is shown");
    assert_eq!(harness.document().render.strategy, Strategy::Mis);
    harness.tap_label("Equal error");
    harness.tap_label("Use Light sampling only");
    harness.settle();
    assert_eq!(harness.document().render.strategy, Strategy::Light);
    harness.undo();
    assert_eq!(harness.document().render.strategy, Strategy::Mis);
}

/// A window in which a race runs, so many seconds for each technique.
fn racing(seconds: f64) -> Editor {
    let mut harness = sphere_editor();
    harness.reveal(Pane::Race);
    harness.set("Time per technique", seconds);
    harness.tap_label("Run the race");
    harness
}

#[test]
fn a_race_can_be_stopped() {
    let mut harness = racing(300.0);
    harness.tap_label("Stop");
    harness.see_label("Run the race");
    // The viewport renders again.
    harness.wait("a finished picture", glossmith::app::App::is_settled);
}

#[test]
fn the_ledger_is_measured_on_demand() {
    let mut harness = sphere_editor();
    // The command shows the panel as well.
    harness.command(Command::Measure);
    // Nothing else is measured meanwhile.
    harness.reveal(Pane::Race);
    assert!(harness.get_by_label("Run the race").accesskit_node().is_disabled());
    harness.reveal(Pane::Effects);
    if cfg!(not(feature = "thorough")) {
        // It takes two seconds for each effect.
        harness.see_label("Stop");
        harness.tap_label("Stop");
        harness.see_label("Stopped.");
        return;
    }
    harness.see("the ledger", |harness| {
        let line = "Schlick's Fresnel (instead of exact): ";
        harness.tells(line)
    });
    assert!(harness.tells("ms for one sample of every pixel"));
    // What was measured of an effect stands beside the reason for it, too.
    assert!(harness.query_all_by_label_contains(" · ").count() > 2);
}
