//! Pictures of the window's main states in both themes, compared with those in tests/snapshots; UPDATE_SNAPSHOTS=1 makes
//! them anew.

use std::path::Path;

use egui::{Rect, Vec2};
use egui_kittest::{SnapshotOptions, image_snapshot_options, kittest::Queryable as _};
use glossmith::{
    app::{Options, actions::Command, layout::Pane},
    document::Document,
};

use super::{
    ui::{Editor, editor_sized, options},
    ui_study::race_strategies,
};

/// Drivers rasterise edges and blend text a little differently.
const COLOR_TOLERANCE: f32 = 2.0;
/// A changed row is more.
const PIXELS_TOLERATED: usize = 300;

fn editor(options: Options) -> Editor {
    let mut harness = editor_sized(Vec2::new(1100.0, 720.0), options);
    harness.settle();
    harness
}

/// Compares the window with its picture, in both themes. The renderer's picture, numbers made from it, and the status bar,
/// which has times in it, are left out: other tests look at them.
fn compare(harness: &mut Editor, name: &str) {
    compare_but(harness, name, &[]);
}

/// The same, with other places left out, too.
fn compare_but(harness: &mut Editor, name: &str, changing: &[Rect]) {
    for theme in ["dark", "light"] {
        // The pointer lies where it changes nothing.
        harness.hover_at(egui::pos2(-10.0, -10.0));
        harness.run_steps(4);
        let viewport = harness.get_by_label("Viewport").rect();
        let mut window = harness
            .render()
            .expect("a Vulkan driver: apt install mesa-vulkan-drivers");
        let status = Rect::from_min_max(egui::pos2(0.0, 720.0 - 30.0), egui::pos2(1100.0, 720.0));
        // A number that goes on changing while pictures come.
        let rms = harness.query_by_label_contains("RMS").map(|label| label.rect());
        let rms = rms.map(|label| Rect::from_min_max(label.right_top() - Vec2::new(140.0, 0.0), label.max));
        for covered in [viewport, status]
            .into_iter()
            .chain(rms)
            .chain(changing.iter().copied())
        {
            cover(&mut window, covered);
        }
        let options = SnapshotOptions::new()
            .output_path(Path::new(crate::ROOT).join("tests/snapshots"))
            .threshold(COLOR_TOLERANCE)
            .max_failed_pixels(PIXELS_TOLERATED);
        image_snapshot_options(&window, format!("{name}-{theme}"), &options);
        harness.command(Command::ToggleTheme);
    }
}

fn cover(window: &mut image::RgbaImage, place: Rect) {
    for y in place.top() as u32..(place.bottom().ceil() as u32).min(window.height()) {
        for x in place.left() as u32..(place.right().ceil() as u32).min(window.width()) {
            window.put_pixel(x, y, image::Rgba([128, 128, 128, 255]));
        }
    }
}

#[test]
fn camera_and_curve() {
    let mut harness = editor(options());
    harness.reveal(Pane::Camera);
    harness.settle();
    compare(&mut harness, "camera-and-curve");
}

#[test]
fn two_compared_beside_effects() {
    let mut harness = editor(options());
    harness.reveal(Pane::Effects);
    harness.reveal(Pane::Snapshots);
    harness.command(Command::Compare);
    harness.settle();
    // B's roughness is found, and then rendered with.
    let roughness = |document: &Document| document.materials[0].roughness;
    harness.wait("B with its look matched", |app| {
        let rival = app.rival_snapshot().and_then(|rival| rival.picture.clone());
        let is_matched = rival.is_some_and(|rival| roughness(&rival.document) != roughness(app.document()));
        is_matched && app.rms_difference().is_some()
    });
    compare(&mut harness, "compared-and-effects");
}

#[test]
fn the_scene_as_a_tree() {
    let mut harness = editor(options());
    harness.reveal(Pane::Scene);
    // Small pictures of environments come when they are made.
    harness.reveal(Pane::Camera);
    harness.settle();
    compare(&mut harness, "scene");
}

/// All but what was measured: the points, and the numbers beside them.
#[test]
fn the_race_beside_the_convergence() {
    let mut harness = editor(options());
    race_strategies(&mut harness, 0.02);
    harness.see_label("Run the race");
    harness.reveal(Pane::Convergence);
    let place = |label: &str| harness.get_by_label(label).rect();
    let (race, error) = (place("Time against bias"), place("Error against time"));
    let around = |chart: Rect| Rect::from_min_max(chart.min - Vec2::new(60.0, 0.0), chart.max + Vec2::new(10.0, 22.0));
    // The chart shrinks to what the lines below it leave.
    let below = Rect::from_min_max(egui::pos2(0.0, race.top()), egui::pos2(race.right() + 20.0, 690.0));
    // The text over the chart: how many lines it takes depends on the numbers.
    let tabs = place("Curve").bottom() + 5.0;
    let over = Rect::from_min_max(egui::pos2(error.left() - 60.0, tabs), error.right_top());
    compare_but(
        &mut harness,
        "race-and-convergence",
        &[around(race), below, around(error), over],
    );
}

/// Without its small pictures, which come when they are made.
#[test]
fn the_browser_of_presets() {
    let mut harness = editor(options());
    harness.reveal(Pane::Presets);
    harness.reveal(Pane::Camera);
    harness.settle();
    compare(&mut harness, "browser");
}
