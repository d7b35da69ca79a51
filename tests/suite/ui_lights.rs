//! Lights moved in the viewport, and the environment in its preview, as a person does it.

use egui::{Event, Key, Modifiers, Pos2, Vec2, accesskit::Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glossmith::app::layout::Pane;
use glossmith::document::{AreaLight, AreaLightShape, Document};

use super::{
    ui::{Editor, editor_with},
    worker::small_document,
};

/// Lights in view of the camera, and the window with their list.
fn editor_lit_by(lights: &[AreaLight]) -> Editor {
    let mut document = small_document();
    (document.camera.yaw_deg, document.camera.pitch_deg) = (0.0, 0.0);
    document.lighting.area_lights = lights.to_vec();
    let mut harness = editor_with(document, Vec::new());
    harness.settle();
    harness.reveal(Pane::Lighting);
    harness
}

/// A light in front of the model, beside the middle of the picture.
fn in_view() -> AreaLight {
    AreaLight {
        yaw_deg: 20.0,
        pitch_deg: 15.0,
        distance: 1.2,
        width: 0.5,
        height: 0.3,
        ..AreaLight::default()
    }
}

fn document(harness: &Editor) -> &Document {
    harness.document()
}

fn light(harness: &Editor) -> AreaLight {
    document(harness).lighting.area_lights[0]
}

fn place(harness: &Editor, label: &str) -> Pos2 {
    harness.get_by_label(label).rect().center()
}

fn with_modifiers(harness: &mut Editor, modifiers: Modifiers, deed: impl FnOnce(&mut Editor)) {
    harness.event(Event::ModifiersChanged(modifiers));
    deed(harness);
    harness.event(Event::ModifiersChanged(Modifiers::NONE));
    harness.run_steps(1);
}

#[test]
fn a_light_is_dragged_around_its_target_in_one_step() {
    let mut harness = editor_lit_by(&[
        in_view(),
        AreaLight {
            yaw_deg: 180.0,
            ..in_view()
        },
    ]);
    let before = document(&harness).clone();
    let (mark, by) = ("Move area light 1", Vec2::new(30.0, -20.0));
    let at = place(&harness, mark);
    harness.drag(at, by);
    harness.settle();
    let now = place(&harness, mark);
    assert!(now.distance(at + by) < 1.0, "from {at} to {now}");
    let moved = light(&harness);
    assert!(moved.yaw_deg > before.lighting.area_lights[0].yaw_deg, "{moved:?}");
    let elsewhere = AreaLight {
        yaw_deg: 20.0,
        pitch_deg: 15.0,
        ..moved
    };
    assert_eq!(elsewhere, in_view(), "nothing else of it changed");
    assert_eq!(document(&harness).camera, before.camera);
    harness.undo();
    assert_eq!(*document(&harness), before);
    // With ctrl in round steps.
    with_modifiers(&mut harness, Modifiers::COMMAND, |harness| harness.drag(at, by));
    assert_eq!(light(&harness).yaw_deg % 15.0, 0.0);
    harness.undo();
    // With shift a tenth of the way.
    with_modifiers(&mut harness, Modifiers::SHIFT, |harness| harness.drag(at, by));
    let now = place(&harness, mark);
    assert!(now.distance(at + 0.1 * by) < 0.5, "finely from {at} to {now}");
    harness.undo();
    assert_eq!(*document(&harness), before);
}

#[test]
fn each_handle_changes_its_number_in_one_step() {
    let spot = AreaLight {
        shape: AreaLightShape::Spot,
        ..in_view()
    };
    let mut harness = editor_lit_by(&[spot]);
    assert!(!harness.has("Turn handle of area light 1"), "no light is chosen");
    harness.tap_label("Choose area light 1");
    let before = document(&harness).clone();
    let middle = place(&harness, "Move area light 1");
    /// What of a light a handle changes.
    type Changed = fn(&AreaLight) -> f64;
    let handles: [(&str, Changed); 5] = [
        ("Width", |light| light.width),
        ("Height", |light| light.height),
        ("Distance", |light| light.distance),
        ("Turn", |light| light.turn_deg),
        ("Cone", |light| light.cone_deg),
    ];
    for (handle, number) in handles {
        let at = place(&harness, &format!("{handle} handle of area light 1"));
        let arm = at - middle;
        let by = if handle == "Turn" { arm.rot90() } else { 0.5 * arm };
        harness.drag(at, by);
        harness.settle();
        assert_ne!(number(&light(&harness)), number(&spot), "{handle}");
        for (other, same) in handles.iter().filter(|(other, _)| *other != handle) {
            assert_eq!(same(&light(&harness)), same(&spot), "{handle} changed {other}");
        }
        harness.undo();
        assert_eq!(*document(&harness), before, "{handle}");
    }
    harness.tap_label("Choose area light 1");
    assert!(!harness.has("Turn handle of area light 1"));
}

#[test]
fn the_environment_is_turned_in_its_preview() {
    let mut harness = editor_lit_by(&[]);
    let before = document(&harness).clone();
    let preview = harness.get_by_label("Environment preview").rect();
    harness.drag(preview.center(), Vec2::new(0.25 * preview.width(), 7.0));
    harness.settle();
    let rotation_deg = document(&harness).lighting.rotation_deg;
    assert!((rotation_deg + 90.0).abs() < 0.5, "{rotation_deg}");
    harness.undo();
    assert_eq!(*document(&harness), before);
    harness.get_by_label("Environment preview").focus();
    harness.run_steps(2);
    harness.key_press(Key::ArrowLeft);
    harness.run_steps(2);
    assert_eq!(document(&harness).lighting.rotation_deg, 1.0);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::ArrowRight);
    harness.run_steps(2);
    assert_eq!(document(&harness).lighting.rotation_deg, -14.0);
    harness.undo();
    assert_eq!(*document(&harness), before);
}

#[test]
fn power_is_the_strength_in_lumens_and_stays_as_it_was_set() {
    let mut harness = editor_lit_by(&[in_view()]);
    let radius = harness
        .state()
        .snapshot()
        .scene
        .as_ref()
        .expect("there is one")
        .job
        .geometry
        .world_units_per_unit;
    let power = harness.get_by_role_and_label(Role::SpinButton, "Area light 1 power");
    power.set_value_accesskit(500.0);
    harness.settle();
    near!(light(&harness).power(radius), 500.0, 0.01);
    let before = document(&harness).clone();
    harness.run_steps(5);
    assert_eq!(*document(&harness), before, "showing it edits nothing");
    harness.set("Scene unit", 0.01);
    harness.settle();
    assert_eq!(document(&harness).lighting, before.lighting);
    let shown = harness.get_by_role_and_label(Role::SpinButton, "Area light 1 power");
    let shown = shown.accesskit_node().numeric_value().expect("a number");
    near!(shown, 0.05, 0.001);
}
