//! Effects, depth of field, bookmarks and picking, in the editor with the real renderer.

use egui::accesskit::Role;
use egui::{Modifiers, Pos2, Vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glossmith::app::actions::Action;
use glossmith::app::layout::Pane;
use glossmith::document::effect::Switch;
use glossmith::document::{AreaLight, Denoise};
use glossmith::job::effect::EffectId;
use glossmith::optics::tone::ToneCurve;
use glossmith::render::shown::Shown;
use glossmith::scene::ModelSource;

use super::ui::{Editor, editor, editor_of, options, picture, request, see_label, settle, undo};
use super::worker::small_document;

pub(super) fn choose(harness: &mut Editor, menu: &str, item: &str) {
    harness.get_by_role_and_label(Role::ComboBox, menu).click_accesskit();
    harness.run_steps(2);
    harness.get_by_role_and_label(Role::Button, item).click_accesskit();
    settle(harness);
}

pub(super) fn click_at(harness: &mut Editor, at: Pos2) {
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
    settle(&mut harness);
    let before = picture(&harness);
    harness.state_mut().reveal(Pane::Effects);
    harness.run_steps(2);
    choose(&mut harness, "Ground: auto, on or off", "off");
    assert_eq!(
        harness.state().document().render.effects.get(EffectId::Ground),
        Switch::Off
    );
    assert!(harness.state().document().ground, "the document keeps its ground");
    assert_ne!(picture(&harness), before);
    undo(&mut harness);
    assert_eq!(picture(&harness), before);
}

#[test]
fn a_bookmark_brings_the_camera_back() {
    let mut harness = editor();
    let first = harness.state().document().camera;
    harness.state_mut().reveal(Pane::Camera);
    harness.run_steps(2);
    harness.get_by_label("Add bookmark").click_accesskit();
    harness.run_steps(2);
    harness
        .get_by_role_and_label(Role::SpinButton, "Yaw")
        .set_value_accesskit(-60.0);
    harness.run_steps(3);
    assert_ne!(harness.state().document().camera, first);
    harness.get_by_label("Apply").click_accesskit();
    harness.run_steps(3);
    assert_eq!(harness.state().document().camera, first);
    undo(&mut harness);
    assert_eq!(harness.state().document().camera.yaw_deg, -60.0);
    harness.get_by_label("Remove camera bookmark 1").click_accesskit();
    harness.run_steps(3);
    assert_eq!(harness.state().document().bookmarks, []);
}

#[test]
fn a_click_says_what_is_sharp() {
    let mut harness = editor();
    let sharp = picture(&harness);
    harness.state_mut().reveal(Pane::Camera);
    harness.run_steps(2);
    harness
        .get_by_role_and_label(Role::SpinButton, "Aperture")
        .set_value_accesskit(0.3);
    settle(&mut harness);
    let at_target = picture(&harness);
    assert_ne!(at_target, sharp);
    let far = number(&harness, "Focus distance");
    harness.get_by_label("Pick focus").click_accesskit();
    harness.run_steps(2);
    let center = harness.get_by_label("Viewport").rect().center();
    click_at(&mut harness, center);
    settle(&mut harness);
    let near = harness.state().document().camera.focus_distance.expect("it was picked");
    assert!(near < far && near > 0.3 * far, "{near} of {far}");
    assert_ne!(picture(&harness), at_target);
    // Ctrl does the same without the button.
    undo(&mut harness);
    assert_eq!(harness.state().document().camera.focus_distance, None);
    harness.event(egui::Event::ModifiersChanged(Modifiers::COMMAND));
    click_at(&mut harness, center);
    harness.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    assert_eq!(harness.state().document().camera.focus_distance, Some(near));
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
    settle(&mut harness);
    harness.state_mut().reveal(Pane::Lighting);
    harness.run_steps(2);
    harness
}

#[test]
fn a_click_puts_a_lights_highlight_there() {
    let mut harness = lit_ball();
    let brightness = |harness: &Editor| -> f32 { picture(harness).iter().map(|pixel| pixel[1]).sum() };
    let from_behind = brightness(&harness);
    harness.get_by_label("Choose area light 2").click_accesskit();
    harness.run_steps(2);
    harness
        .get_by_label("Place highlight of area light 2")
        .click_accesskit();
    harness.run_steps(2);
    let center = harness.get_by_label("Viewport").rect().center();
    click_at(&mut harness, center);
    settle(&mut harness);
    let lights = harness.state().document().lighting.area_lights.clone();
    let camera = harness.state().document().camera;
    assert_eq!(lights[0].yaw_deg, 150.0, "the other stays");
    // The middle of a ball mirrors the viewer.
    assert!(
        (lights[1].yaw_deg - camera.yaw_deg).abs() < 2.0,
        "{lights:?} {camera:?}"
    );
    assert!(
        (lights[1].pitch_deg - camera.pitch_deg).abs() < 2.0,
        "{lights:?} {camera:?}"
    );
    assert!(brightness(&harness) > from_behind, "it is seen");
    // The next click chooses again.
    click_at(&mut harness, center + Vec2::new(12.0, 0.0));
    assert_eq!(harness.state().document().lighting.area_lights, lights);
    undo(&mut harness);
    assert_eq!(harness.state().document().lighting.area_lights[1].yaw_deg, 150.0);
}

#[test]
fn lights_are_muted_soloed_and_warmed() {
    let mut harness = lit_ball();
    let muted = |harness: &Editor| -> Vec<bool> {
        let lights = &harness.state().document().lighting.area_lights;
        lights.iter().map(|light| light.is_muted).collect()
    };
    let both = picture(&harness);
    let press = |harness: &mut Editor, label: &str| {
        harness.get_by_label(label).click_accesskit();
        harness.run_steps(2);
        settle(harness);
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
    harness.get_by_label("Choose area light 1").click_accesskit();
    harness.run_steps(2);
    harness
        .get_by_role_and_label(Role::SpinButton, "Area light 1 temperature")
        .set_value_accesskit(2700.0);
    settle(&mut harness);
    let [red, green, blue] = harness.state().document().lighting.area_lights[0].color;
    assert!(
        red == 1.0 && green < 0.8 && blue < 0.4 && blue > 0.05,
        "{red} {green} {blue}"
    );
    assert!((number(&harness, "Area light 1 temperature") - 2700.0).abs() < 1.0);
    undo(&mut harness);
    assert_eq!(harness.state().document().lighting.area_lights[0].color, [1.0; 3]);
}

#[test]
fn a_click_in_the_viewport_gives_its_angle_to_the_plots() {
    let mut document = small_document();
    document.model = ModelSource::Sphere;
    let mut harness = editor_of(glossmith::app::Options {
        document: Some(document),
        ..options()
    });
    settle(&mut harness);
    harness.state_mut().reveal(Pane::Samples);
    harness.run_steps(2);
    let center = harness.get_by_label("Viewport").rect().center();
    click_at(&mut harness, center);
    assert!(
        number(&harness, "Samples view angle") < 4.0,
        "head-on in the middle of a sphere"
    );
}

#[test]
fn the_precision_view_tells_that_nothing_is_wrong() {
    let mut harness = editor();
    harness
        .get_by_role_and_label(Role::ComboBox, "Viewport shows")
        .click_accesskit();
    harness.run_steps(2);
    harness
        .get_by_role_and_label(Role::Button, "Precision")
        .click_accesskit();
    harness.run_steps(2);
    see_label(&mut harness, "0 dropped");
    for told in ["0 f32 off f64", "0 start inside", "of 960 pixels"] {
        assert!(harness.query_by_label(told).is_some(), "{told}");
    }
    request(&mut harness, Action::Show(Shown::Picture));
    assert!(harness.query_by_label("0 dropped").is_none());
}

#[test]
fn ctrl_shift_and_a_click_explain_the_pixel() {
    let mut harness = editor();
    let before = harness.state().document().clone();
    let center = harness.get_by_label("Viewport").rect().center();
    harness.event(egui::Event::ModifiersChanged(Modifiers::COMMAND | Modifiers::SHIFT));
    click_at(&mut harness, center);
    harness.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    harness.run_steps(2);
    assert!(harness.query_by_label("Path trace of this pixel").is_some());
    let told = |text: &str| harness.query_by_label_contains(text).is_some();
    assert!(told("camera") && told("bounce 0") && told("contribution"));
    assert_eq!(harness.state().document(), &before, "nothing is edited");
    harness.get_by_label("Close").click_accesskit();
    harness.run_steps(2);
    assert!(harness.query_by_label("Path trace of this pixel").is_none());
}

/// *Denoise* beside the exposure: the picture changes without being rendered again, and the status bar tells what error is
/// left; undo brings the noise back.
#[test]
fn noise_is_taken_out_and_the_error_that_is_left_is_told() {
    let mut harness = editor();
    settle(&mut harness);
    let noisy = picture(&harness);
    let seconds = harness.state().snapshot().progress.render_seconds;
    harness.state_mut().reveal(Pane::Camera);
    harness.run_steps(2);
    choose(&mut harness, "Denoise", "High quality");
    assert_eq!(harness.state().document().view.denoise, Denoise::High);
    assert_ne!(picture(&harness), noisy);
    let snapshot = harness.state().snapshot();
    assert_eq!(snapshot.progress.render_seconds, seconds, "nothing is rendered again");
    let told = snapshot.denoised.expect("there are two halves").value;
    assert!(told > 0.0);
    assert!(harness.query_by_label_contains("denoised ").is_some(), "the status bar");
    undo(&mut harness);
    assert_eq!(picture(&harness), noisy);
    assert!(harness.query_by_label_contains("denoised ").is_none());
}

/// A narrow bar over the viewport: what it has no room for is in a menu, and works from there.
#[test]
fn a_narrow_bar_puts_what_it_has_no_room_for_into_a_menu() {
    let mut harness = editor();
    harness.set_size(Vec2::new(1024.0, 720.0));
    harness.run_steps(2);
    for gone in ["Viewport tone map", "Resolution"] {
        assert!(harness.query_by_label(gone).is_none(), "{gone} is in the bar");
    }
    harness.get_by_label("Viewport denoise").click_accesskit();
    harness.run_steps(2);
    assert_eq!(harness.state().document().view.denoise, Denoise::Auto);
    let open = |harness: &mut Editor, menu: &str| {
        harness.get_by_label("More of the viewport's controls").click();
        harness.run_steps(2);
        harness.get_by_role_and_label(Role::Button, menu).click();
        harness.run_steps(2);
    };
    open(&mut harness, "Tone map");
    harness.get_by_role_and_label(Role::RadioButton, "PBR Neutral").click();
    harness.run_steps(2);
    assert_eq!(harness.state().document().view.tone_map, ToneCurve::PbrNeutral);
    undo(&mut harness);
    harness.set_size(Vec2::new(1400.0, 1000.0));
    harness.run_steps(2);
    assert!(harness.query_by_label("Resolution").is_some(), "there is room again");
}

/// A panel is closed and opened by its tick in the menu *View*.
#[test]
fn panels_are_closed_and_come_back() {
    let mut harness = editor();
    let toggle = |harness: &mut Editor| {
        harness.get_by_role_and_label(Role::Button, "View").click();
        harness.run_steps(2);
        harness.get_by_role_and_label(Role::CheckBox, "Snapshots").click();
        harness.run_steps(2);
    };
    let is_there = |harness: &Editor| harness.query_by_label_contains("Pin a snapshot").is_some();
    harness.state_mut().reveal(Pane::Snapshots);
    harness.run_steps(2);
    assert!(is_there(&harness));
    toggle(&mut harness);
    assert!(!is_there(&harness));
    toggle(&mut harness);
    assert!(is_there(&harness));
}
