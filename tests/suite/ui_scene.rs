//! Effects, depth of field and picking, in the editor with the real renderer.

use egui::{Modifiers, Pos2, Vec2, accesskit::Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glossmith::{
    app::layout::Pane,
    document::{AreaLight, effect::Switch},
    job::effect::EffectId,
    scene::ModelSource,
};

use super::{
    ui::{Editor, editor, editor_of, options, picture},
    worker::small_document,
};

pub fn choose(harness: &mut Editor, menu: &str, item: &str) {
    harness.tap(Role::ComboBox, menu);
    harness.press(item);
    harness.settle();
}

pub fn click_at(harness: &mut Editor, at: Pos2) {
    harness.hover_at(at);
    harness.step();
    harness.drag_at(at);
    harness.step();
    harness.drop_at(at);
    harness.run_steps(2);
}

fn number(harness: &Editor, label: &str) -> f64 {
    let node = harness.get_by_role_and_label(Role::SpinButton, label);
    node.accesskit_node().numeric_value().expect("a number")
}

#[test]
fn an_effect_is_switched_off_and_back() {
    let mut document = small_document();
    document.ground = true;
    let mut harness = editor_of(glossmith::app::Options {
        document: Some(document),
        ..options()
    });
    harness.settle();
    let before = picture(&harness);
    harness.reveal(Pane::Effects);
    choose(&mut harness, "Ground: auto, on or off", "off");
    assert_eq!(harness.document().render.effects.get(EffectId::Ground), Switch::Off);
    assert!(harness.document().ground, "the document keeps its ground");
    assert_ne!(picture(&harness), before);
    harness.undo();
    assert_eq!(picture(&harness), before);
}

#[test]
fn a_click_says_what_is_sharp() {
    let mut harness = editor();
    let sharp = picture(&harness);
    harness.reveal(Pane::Camera);
    harness.set("f-number", 1e6);
    assert!(harness.tells("Nothing blurs"));
    harness.set("f-number", 0.05);
    assert!(!harness.tells("Nothing blurs"));
    harness.settle();
    let at_target = picture(&harness);
    assert_ne!(at_target, sharp);
    let far = number(&harness, "Focus distance");
    harness.tap_label("Pick focus");
    let center = harness.get_by_label("Viewport").rect().center();
    click_at(&mut harness, center);
    harness.settle();
    let near = harness.document().camera.focus_distance.expect("it was picked");
    assert!(near < far && near > 0.3 * far, "{near} of {far}");
    assert_ne!(picture(&harness), at_target);
    // Ctrl does the same without the button.
    harness.undo();
    assert_eq!(harness.document().camera.focus_distance, None);
    harness.event(egui::Event::ModifiersChanged(Modifiers::COMMAND));
    click_at(&mut harness, center);
    harness.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    assert_eq!(harness.document().camera.focus_distance, Some(near));
}

/// A smooth dark ball in the dark, with two lights.
fn lit_ball() -> Editor {
    let mut document = small_document();
    document.model = ModelSource::Sphere;
    document.lighting.strength = 0.0;
    document.lighting.area_lights = vec![
        AreaLight {
            yaw_deg: 150.0,
            ..AreaLight::default()
        };
        2
    ];
    document.materials[0].roughness = 0.2;
    let mut harness = editor_of(glossmith::app::Options {
        document: Some(document),
        ..options()
    });
    harness.settle();
    harness.reveal(Pane::Lighting);
    harness
}

#[test]
fn a_click_puts_a_lights_highlight_there() {
    let mut harness = lit_ball();
    let brightness = |harness: &Editor| -> f32 { picture(harness).iter().map(|pixel| pixel[1]).sum() };
    let from_behind = brightness(&harness);
    harness.tap_label("Choose area light 2");
    harness.tap_label("Place highlight of area light 2");
    let center = harness.get_by_label("Viewport").rect().center();
    click_at(&mut harness, center);
    harness.settle();
    let lights = harness.document().lighting.area_lights.clone();
    let camera = harness.document().camera;
    assert_eq!(lights[0].yaw_deg, 150.0, "the other stays");
    // The middle of a ball mirrors the viewer.
    near!(lights[1].yaw_deg, camera.yaw_deg, 2.0);
    near!(lights[1].pitch_deg, camera.pitch_deg, 2.0);
    assert!(brightness(&harness) > from_behind, "it is seen");
    // The next click chooses again.
    click_at(&mut harness, center + Vec2::new(12.0, 0.0));
    assert_eq!(harness.document().lighting.area_lights, lights);
    harness.undo();
    assert_eq!(harness.document().lighting.area_lights[1].yaw_deg, 150.0);
}

#[test]
fn lights_are_muted_soloed_and_warmed() {
    let mut harness = lit_ball();
    let muted = |harness: &Editor| -> Vec<bool> {
        let lights = &harness.document().lighting.area_lights;
        lights.iter().map(|light| light.is_muted).collect()
    };
    let both = picture(&harness);
    let press = |harness: &mut Editor, label: &str| {
        harness.tap_label(label);
        harness.settle();
        picture(harness)
    };
    let one = press(&mut harness, "Mute area light 1");
    assert_eq!(muted(&harness), [true, false]);
    assert_ne!(one, both);
    press(&mut harness, "Mute area light 1");
    let alone = press(&mut harness, "Solo area light 2");
    assert_eq!(muted(&harness), [true, false]);
    assert_eq!(alone, one);
    press(&mut harness, "Solo area light 1");
    assert_eq!(muted(&harness), [false, true]);
    let all = press(&mut harness, "Solo area light 1");
    assert_eq!(muted(&harness), [false, false]);
    assert_eq!(all, both);
    harness.tap_label("Choose area light 1");
    harness.set("Area light 1 temperature", 2700.0);
    harness.settle();
    let [red, green, blue] = harness.document().lighting.area_lights[0].color;
    assert!(
        red == 1.0 && green < 0.8 && blue < 0.4 && blue > 0.05,
        "{red} {green} {blue}"
    );
    near!(number(&harness, "Area light 1 temperature"), 2700.0, 1.0);
    harness.undo();
    assert_eq!(harness.document().lighting.area_lights[0].color, [1.0; 3]);
}

#[test]
fn a_click_in_the_viewport_gives_its_angle_to_the_plots() {
    let mut document = small_document();
    document.model = ModelSource::Sphere;
    let mut harness = editor_of(glossmith::app::Options {
        document: Some(document),
        ..options()
    });
    harness.settle();
    harness.reveal(Pane::Samples);
    harness.tap_label("Pick angle");
    let center = harness.get_by_label("Viewport").rect().center();
    click_at(&mut harness, center);
    assert!(
        number(&harness, "Samples view angle") < 4.0,
        "head-on in the middle of a sphere"
    );
}

#[test]
fn ctrl_shift_and_a_click_explain_the_pixel() {
    let mut harness = editor();
    let before = harness.document().clone();
    let center = harness.get_by_label("Viewport").rect().center();
    harness.event(egui::Event::ModifiersChanged(Modifiers::COMMAND | Modifiers::SHIFT));
    click_at(&mut harness, center);
    harness.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    harness.run_steps(2);
    assert!(harness.has("Path trace of this pixel"));
    for text in ["camera      from", "bounce 0", "contribution"] {
        assert!(harness.tells(text), "{text}");
    }
    assert_eq!(harness.document(), &before, "nothing is edited");
    harness.tap_label("Close");
    assert!(!harness.has("Path trace of this pixel"));
}

/// What a preset would be dropped on is named; it is given the preset.
#[test]
fn the_part_below_a_dragged_preset_is_named() {
    let mut harness = editor();
    let [from, to] = [
        harness.get_by_role_and_label(Role::Button, "Plastic blue"),
        harness.get_by_label("Viewport"),
    ]
    .map(|node| node.rect().center());
    harness.hover_at(from);
    harness.step();
    harness.drag_at(from);
    for share in [0.2, 0.6, 1.0] {
        harness.hover_at(from.lerp(to, share));
        harness.run_steps(2);
    }
    assert!(harness.tells("Drop on "));
    harness.drop_at(to);
    harness.run_steps(3);
    assert_eq!(harness.material().name, "Plastic blue");
    assert!(!harness.tells("Drop on "));
}

/// Charts end within their panels, and the menu *View* within the window.
#[test]
fn charts_and_menus_fit_the_window() {
    let mut harness = editor();
    for height in [1080.0, 768.0] {
        harness.set_size(Vec2::new(1366.0, height));
        let charts = [(Pane::Samples, "The samples"), (Pane::Curve, "The curve D over ξ")];
        for (pane, chart) in charts {
            harness.reveal(pane);
            harness.see_label(chart);
            let bottom = harness.get_by_label(chart).rect().bottom();
            assert!(bottom < height - 28.0, "{chart}: {bottom} of {height}");
        }
        harness.click(Role::Button, "View");
        let last = harness.get_by_label_contains("Panels").rect().bottom();
        assert!(last < height, "{last} of {height}");
        harness.key_press(egui::Key::Escape);
        harness.run_steps(2);
    }
}

/// A panel is closed and opened by its tick in the menu *View*.
#[test]
fn panels_are_closed_and_come_back() {
    let mut harness = editor();
    let toggle = |harness: &mut Editor| {
        harness.click(Role::Button, "View");
        harness.get_by_label_contains("Panels").click();
        harness.run_steps(3);
        harness.click(Role::CheckBox, "Snapshots");
    };
    let is_there = |harness: &Editor| harness.tells("Pin a snapshot");
    harness.reveal(Pane::Snapshots);
    assert!(is_there(&harness));
    toggle(&mut harness);
    assert!(!is_there(&harness));
    toggle(&mut harness);
    assert!(is_there(&harness));
}
