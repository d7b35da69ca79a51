//! Comparing, pinning, pictures that bring their document back: in the editor with the real renderer.

use super::{
    cli_support::Workplace,
    ui::{Editor, editor, editor_of, options},
    worker::small_document,
};
use egui::{Key, Modifiers, Vec2, accesskit::Role};
use egui_kittest::kittest::Queryable as _;
use glossmith::{
    app::{
        Options,
        actions::{Action, Command},
        compare::Rival,
        layout::Pane,
    },
    document::Document,
    render::worker::{Activity, Picture},
    store::PRESETS,
};

/// Waits until B, too, is finished and both have been compared.
fn settle_both(harness: &mut Editor, what: &str, is_b: impl Fn(&Document) -> bool) {
    harness.settle();
    harness.wait(what, |app| {
        let Some(snapshot) = app.rival_snapshot() else {
            return false;
        };
        let is_current =
            |picture: &Picture| picture.reduction == 1 && picture.samples_per_pixel == 3 && is_b(&picture.document);
        snapshot.activity == Activity::Done && snapshot.picture.as_deref().is_some_and(is_current)
    });
    harness.wait("the difference", |app| app.rms_difference().is_some());
    harness.run_steps(2);
    harness.check_accessibility();
}

#[test]
fn a_and_b_have_the_same_random_numbers() {
    let mut harness = editor();
    let same = harness.material().clone();
    harness.request(Action::CompareWith(Rival::Material(Box::new(same.clone()))));
    settle_both(&mut harness, "B", |_| true);
    harness.wait("no difference", |app| app.rms_difference() == Some(0.0));
    let mut other = same;
    other.roughness = 0.9;
    harness.request(Action::CompareWith(Rival::Material(Box::new(other))));
    harness.wait("a difference", |app| app.rms_difference().is_some_and(|rms| rms > 0.01));
}

/// B is chosen among the presets, which leaves A as it is.
#[test]
fn b_is_chosen_in_the_grid_of_presets() {
    let mut harness = editor();
    let before = harness.document().clone();
    harness.command(Command::Compare);
    harness.run_steps(3);
    harness.click(Role::ComboBox, "Compare with");
    harness.press("Choose a preset…");
    harness.press("Rubber");
    harness.wait("B", |app| {
        let b = app.rival_snapshot().and_then(|rival| rival.picture.clone());
        b.is_some_and(|b| b.document.materials[0].name == "Rubber")
    });
    assert_eq!(*harness.document(), before);
    assert!(!harness.has("not matched"));
}

#[test]
fn every_view_shows_what_it_says() {
    let mut harness = editor();
    let white = PRESETS
        .iter()
        .find(|preset| preset.name == "Lambert white")
        .expect("shipped");
    harness.request(Action::CompareWith(Rival::Material(Box::new(white.clone()))));
    settle_both(&mut harness, "B", |b| b.materials[0] == *white);
    let colors = |harness: &mut Editor, at: [f32; 2]| {
        harness.run_steps(2);
        let rect = harness.get_by_label("Viewport").rect();
        let window = harness
            .render()
            .expect("a Vulkan driver: apt install mesa-vulkan-drivers");
        let at = rect.min + rect.size() * Vec2::from(at);
        window.get_pixel(at.x as u32, at.y as u32).0
    };
    // The sphere's middle lies a little left and right of the divider.
    let (left, right) = ([0.46, 0.5], [0.54, 0.5]);
    let [a, b] = [colors(&mut harness, left), colors(&mut harness, right)];
    assert_ne!(a, b, "metal left, white right");
    let divider = harness.get_by_role_and_label(Role::Slider, "Divider").rect().center();
    harness.hover_at(divider);
    harness.step();
    harness.drag_at(divider);
    harness.step();
    harness.hover_at(divider - Vec2::new(200.0, 0.0));
    harness.step();
    harness.drop_at(divider - Vec2::new(200.0, 0.0));
    harness.run_steps(2);
    assert_eq!(harness.document().camera, small_document().camera, "the camera stays");
    let wiped = colors(&mut harness, left);
    assert_ne!(wiped, a, "B is wiped over A");

    harness.click(Role::Button, "Difference");
    let [r, _, blue, _] = colors(&mut harness, right);
    assert!(r > blue, "B is brighter: orange");
    assert!(
        harness
            .query_by_role_and_label(Role::SpinButton, "Difference scale")
            .is_some()
    );
    let background = colors(&mut harness, [0.02, 0.5]);
    assert!(
        background[0].abs_diff(background[2]) < 4,
        "the background does not differ: {background:?}"
    );

    harness.click(Role::Button, "Side by side");
    harness.settle();
    let [a, b] = [colors(&mut harness, [0.25, 0.5]), colors(&mut harness, [0.75, 0.5])];
    assert_ne!(a, b);

    harness.click(Role::Button, "Flicker");
    harness.set("Flicker rate", 2.0);
    let mut seen = std::collections::HashSet::new();
    for _ in 0..20 {
        seen.insert(colors(&mut harness, [0.5, 0.5]));
    }
    assert_eq!(seen.len(), 2, "A and B in turn: {seen:?}");
    harness.check_accessibility();
}

#[test]
fn swapping_and_taking_b_are_one_step_each() {
    let mut harness = editor();
    let before = harness.document().clone();
    let gold = PRESETS.iter().find(|preset| preset.name == "Gold").expect("shipped");
    harness.request(Action::CompareWith(Rival::Material(Box::new(gold.clone()))));
    settle_both(&mut harness, "B", |b| b.materials[0] == *gold);
    harness.key_press(Key::X);
    harness.run_steps(2);
    assert_eq!(*harness.material(), *gold);
    settle_both(&mut harness, "the old A", |b| b.materials == before.materials);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(2);
    assert_eq!(*harness.document(), before);
    harness.request(Action::CompareWith(Rival::Material(Box::new(gold.clone()))));
    settle_both(&mut harness, "B", |b| b.materials[0] == *gold);
    harness.click(Role::Button, "Replace A with B");
    assert_eq!(*harness.material(), *gold);
    assert!(
        harness
            .query_by_role_and_label(Role::Button, "Replace A with B")
            .is_none(),
        "nothing to compare"
    );
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(2);
    assert_eq!(*harness.document(), before);
}

fn has_button(harness: &Editor, label: &str) -> bool {
    harness.query_by_role_and_label(Role::Button, label).is_some()
}

#[test]
fn snapshots_are_pinned_kept_brought_back_compared_and_deleted() {
    let folder = Workplace::new();
    let with_data = || {
        editor_of(Options {
            data: Some(folder.root().to_owned()),
            ..options()
        })
    };
    let mut harness = with_data();
    harness.settle();
    let mut pinned = harness.document().clone();
    pinned.materials[0].name = "Zebra".to_owned();
    pinned.materials[0].roughness = 0.77;
    harness.request(Action::UseMaterial(Box::new(pinned.materials[0].clone())));
    harness.settle();
    harness.key_press(Key::P);
    harness.see("the snapshot", |harness| has_button(harness, "Zebra"));
    harness.check_accessibility();
    eframe::App::on_exit(harness.state_mut());
    drop(harness);

    let mut harness = with_data();
    harness.settle();
    harness.reveal(Pane::Snapshots);
    harness.see("the snapshot", |harness| has_button(harness, "Zebra"));
    let before = harness.document().clone();
    harness.click(Role::Button, "Zebra");
    assert_eq!(*harness.document(), pinned);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(2);
    assert_eq!(*harness.document(), before);
    harness.click(Role::Button, "More of Zebra");
    harness.click(Role::Button, "Compare as B");
    settle_both(&mut harness, "B", |b| b.materials == pinned.materials);
    harness.click(Role::Button, "Stop comparing");
    harness.click(Role::Button, "More of Zebra");
    harness.click(Role::Button, "Rename");
    harness.write("New name", "Quagga");
    harness.key_press(Key::Enter);
    harness.see("its new name", |harness| has_button(harness, "Quagga"));
    assert!(!has_button(&harness, "Zebra") && folder.path("snapshots/Quagga.png").is_file());
    harness.click(Role::Button, "More of Quagga");
    harness.click(Role::Button, "Delete");
    harness.see("it to go", |harness| !has_button(harness, "Quagga"));
    harness.click(Role::Button, "Restore Quagga");
    harness.see("it to come back", |harness| has_button(harness, "Quagga"));
}
