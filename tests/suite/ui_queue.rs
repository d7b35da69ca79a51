//! Renders beside the window: pictures and turntables in the queue, and the turntable's preview in the viewport.

use std::path::Path;

use egui::{Key, ViewportCommand, ViewportEvent, ViewportId, accesskit::Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glossmith::app::{actions::Action, actions::Command, layout::Pane};

use super::{
    cli_support::Workplace,
    ui::{Editor, editor, editor_with},
    ui_files::says,
    worker::small_document,
};

/// Has a turn queued, of so many frames and samples, written as this.
fn turn(harness: &mut Editor, form: &str, output: &Path, [frames, samples]: [f64; 2]) {
    harness.command(Command::Turntable);
    // A sheet is first measured, then shown.
    harness.run_steps(2);
    harness.check_accessibility();
    harness.set("Turntable frames", frames);
    harness.set("Turntable samples", samples);
    harness.set("Turntable width", 20.0);
    harness.set("Turntable height", 16.0);
    harness.tap(Role::ComboBox, "Turntable form");
    harness.tap_label(form);
    harness.write("Turntable output", &output.display().to_string());
    harness.press("Add to the queue");
}

#[test]
fn how_long_a_turntable_takes_is_told_once_it_is_known() {
    let mut document = small_document();
    document.render.samples = 1;
    let mut harness = editor_with(document, Vec::new());
    harness.settle();
    harness.command(Command::Turntable);
    harness.run_steps(2);
    assert!(!harness.tells("rendered in about"));
}

#[test]
fn a_turntable_becomes_pictures_and_a_video_beside_the_window() {
    let folder = Workplace::new();
    let path = |name: &str| folder.path(name);
    let mut harness = editor();
    turn(&mut harness, "Images", &path("turn"), [3.0, 2.0]);
    harness.wait_for_words("turntable: 3 frames");
    assert_eq!(std::fs::read_dir(path("turn")).expect("made").count(), 3);
    let size = image::image_dimensions(path("turn/frame-0003.png")).expect("a picture");
    assert_eq!(size, (20, 16));
    // The ending follows what was chosen.
    turn(&mut harness, "Video (.mp4)", &path("film.gif"), [4.0, 2.0]);
    harness.wait_for_words("film.mp4");
    let bytes = std::fs::read(path("film.mp4")).expect("the video");
    assert_eq!(&bytes[4..8], b"ftyp");
    harness.run_steps(2);
    harness.check_accessibility();
    // What is below stays the control that it was.
    let below = harness.get_by_label("Remove film.mp4").accesskit_node().locate();
    harness.press("Remove turn");
    assert!(!harness.has("Remove turn"));
    assert_eq!(harness.get_by_label("Remove film.mp4").accesskit_node().locate(), below);
    harness.press("Clear finished");
    assert!(!harness.has("Remove film.mp4"));
}

#[test]
fn the_queue_is_paused_reordered_called_off_and_asked_about() {
    let folder = Workplace::new();
    let path = |name: &str| folder.path(name);
    let mut harness = editor();
    harness.request(Action::Reveal(Pane::Queue));
    harness.run_steps(2);
    harness.click(Role::CheckBox, "Pause the queue");
    turn(&mut harness, "Animation (.gif)", &path("long.gif"), [9000.0, 4000.0]);
    for name in ["first.png", "second.exr"] {
        harness.command(Command::QueuePicture);
        harness.type_path(&path(name), "Save");
    }
    harness.press("Next second.exr");
    harness.press("Cancel first.png");
    // What is edited afterwards is no part of it.
    harness.request(Action::LookFrom(90.0, 0.0));
    harness.settle();
    harness.click(Role::CheckBox, "Pause the queue");
    harness.wait_for_words("second.exr: 3 samples per pixel");
    assert!(!path("first.png").exists());
    harness.see("the turn under way", |harness| harness.has("Progress of long.gif"));
    let close = |harness: &mut Editor| {
        let viewport = harness.input_mut().viewports.get_mut(&ViewportId::ROOT);
        viewport.expect("the window").events.push(ViewportEvent::Close);
        harness.step();
        let commands = harness.output().viewport_output[&ViewportId::ROOT].commands.clone();
        let viewport = harness.input_mut().viewports.get_mut(&ViewportId::ROOT);
        viewport.expect("the window").events.clear();
        harness.run_steps(3);
        !commands.contains(&ViewportCommand::CancelClose)
    };
    assert!(!close(&mut harness), "it asks first");
    harness.check_accessibility();
    harness.press("Keep rendering");
    assert!(harness.has("Progress of long.gif"));
    harness.press("Cancel long.gif");
    harness.wait_for_words("turntable cancelled");
    assert!(!path("long.gif").exists(), "a video is whole or not there");
    assert!(!says(&harness, "internal error"));
}

#[test]
fn the_viewport_turns_until_escape_and_the_document_stays() {
    let mut harness = editor();
    harness.settle();
    let document = harness.document().clone();
    harness.key_press(Key::T);
    let yaw = |harness: &Editor| {
        let scene = harness.state().snapshot().scene.clone();
        scene.expect("a scene").document.camera.yaw_deg
    };
    for _ in 0..2 {
        let before = yaw(&harness);
        harness.see("a turn", |harness| yaw(harness) != before);
    }
    assert_eq!(*harness.document(), document);
    // What is edited meanwhile is seen while it goes on.
    harness.command(Command::ResetMaterial);
    let before = yaw(&harness);
    harness.see("a turn", |harness| yaw(harness) != before);
    harness.key_press(Key::Escape);
    harness.settle();
    assert_eq!(yaw(&harness), document.camera.yaw_deg);
    harness.key_press(Key::T);
    let before = yaw(&harness);
    harness.see("a turn", |harness| yaw(harness) != before);
    harness.request(Action::LookFrom(90.0, 0.0));
    harness.settle();
    assert_eq!(yaw(&harness), 90.0, "who moves the camera has it");
}
