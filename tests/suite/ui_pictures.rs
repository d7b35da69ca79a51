//! Pictures of the window's main states in both themes, compared with those in tests/snapshots; UPDATE_SNAPSHOTS=1 makes
//! them anew.

use std::time::{Duration, Instant};

use egui::{Rect, Vec2};
use egui_kittest::kittest::Queryable as _;
use egui_kittest::{Harness, SnapshotOptions, image_snapshot_options};
use glossmith::app::actions::{Action, Command};
use glossmith::app::layout::Pane;
use glossmith::app::{App, Options};

use super::ui::{PATIENCE, options, request, settle};

/// Drivers rasterise edges and blend text a little differently.
const COLOR_TOLERANCE: f32 = 2.0;
/// A changed label is hundreds of pixels.
const PIXELS_TOLERATED: usize = 80;

fn editor(options: Options) -> Harness<'static, App> {
    let mut harness = Harness::builder()
        .with_size(Vec2::new(1100.0, 720.0))
        .build_eframe(move |creation| App::new(creation, options).expect("a thread to render on"));
    settle(&mut harness);
    harness
}

/// Compares the window with its picture, in both themes. The renderer's picture and the status bar, which has times in it,
/// are left out: other tests look at them.
fn compare(harness: &mut Harness<'static, App>, name: &str) {
    for theme in ["dark", "light"] {
        // The pointer lies where it changes nothing.
        harness.hover_at(egui::pos2(-10.0, -10.0));
        harness.run_steps(4);
        let viewport = harness.get_by_label("Viewport").rect();
        let mut window = harness
            .render()
            .expect("a Vulkan driver: apt install mesa-vulkan-drivers");
        let status = Rect::from_min_max(egui::pos2(0.0, 720.0 - 30.0), egui::pos2(1100.0, 720.0));
        for covered in [viewport, status] {
            cover(&mut window, covered);
        }
        let options = SnapshotOptions::new()
            .threshold(COLOR_TOLERANCE)
            .max_failed_pixels(PIXELS_TOLERATED);
        image_snapshot_options(&window, format!("{name}-{theme}"), &options);
        request(harness, Action::Do(Command::ToggleTheme));
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
    harness.state_mut().reveal(Pane::Camera);
    settle(&mut harness);
    compare(&mut harness, "camera-and-curve");
}

#[test]
fn two_compared_beside_effects() {
    let mut harness = editor(options());
    harness.state_mut().reveal(Pane::Effects);
    harness.state_mut().reveal(Pane::Snapshots);
    request(&mut harness, Action::Do(Command::Compare));
    settle(&mut harness);
    let begun = Instant::now();
    while harness.query_by_label_contains("RMS").is_none() {
        assert!(begun.elapsed() < PATIENCE, "they are not compared");
        harness.step();
        std::thread::sleep(Duration::from_millis(5));
    }
    compare(&mut harness, "compared-and-effects");
}
