//! Views: parallel views from the sides, lights that are hidden, a reference under, over and beside the render.

use egui::{Key, accesskit::Role};
use egui_kittest::kittest::Queryable as _;
use glossmith::{
    app::{Options, layout::Pane},
    document::{AreaLight, CameraSettings},
    scene::camera::Projection,
};

use super::{
    cli_support::Workplace,
    ui::{Editor, editor, editor_of, editor_with, options, picture},
    worker::small_document,
};

fn camera(harness: &Editor) -> CameraSettings {
    harness.document().camera
}

#[test]
fn keys_look_from_the_sides_in_parallel_rays() {
    let mut harness = editor();
    let (before, shown) = (harness.document().clone(), picture(&harness));
    harness.hover_at(harness.get_by_label("Viewport").rect().center());
    harness.run_steps(2);
    for (key, yaw_deg, pitch_deg) in [(Key::Num1, 0.0, 0.0), (Key::Num3, 90.0, 0.0), (Key::Num7, 0.0, 90.0)] {
        harness.key_press(key);
        harness.settle();
        let camera = camera(&harness);
        assert_eq!(
            (camera.yaw_deg, camera.pitch_deg, camera.projection),
            (yaw_deg, pitch_deg, Projection::Orthographic)
        );
        assert_ne!(picture(&harness), shown);
    }
    harness.key_press(Key::Num5);
    harness.settle();
    assert_eq!(camera(&harness).projection, Projection::Perspective);
    // And by its row.
    harness.reveal(Pane::Camera);
    harness.tap(Role::ComboBox, "Projection");
    harness.press("Orthographic");
    harness.settle();
    assert_eq!(camera(&harness).projection, Projection::Orthographic);
    for _ in 0..5 {
        harness.undo();
    }
    assert_eq!(*harness.document(), before);
    assert_eq!(picture(&harness), shown);
}

/// A light in view, and the window with its rows.
fn lit() -> Editor {
    let mut document = small_document();
    (document.camera.yaw_deg, document.camera.pitch_deg) = (20.0, 30.0);
    document.lighting.area_lights = vec![AreaLight {
        yaw_deg: 20.0,
        pitch_deg: 15.0,
        distance: 1.2,
        width: 0.5,
        height: 0.3,
        ..AreaLight::default()
    }];
    let mut harness = editor_with(document, Vec::new());
    harness.settle();
    harness.reveal(Pane::Lighting);
    harness
}

#[test]
fn a_light_is_hidden_from_the_camera_by_its_row() {
    let mut harness = lit();
    let (before, shown) = (harness.document().clone(), picture(&harness));
    harness.tap(Role::CheckBox, "Area light 1 hidden from camera");
    harness.settle();
    assert!(harness.document().lighting.area_lights[0].is_hidden);
    let brightest = |pixels: &[[f32; 4]]| pixels.iter().map(|pixel| pixel[1]).fold(0.0, f32::max);
    assert!(brightest(&shown) >= 5.0 && brightest(&picture(&harness)) < brightest(&shown));
    harness.undo();
    assert_eq!(*harness.document(), before);
    assert_eq!(picture(&harness), shown);
}

/// A photograph is chosen, shown under, over and beside the render, and taken away; the render is no other one.
#[test]
fn a_reference_picture_is_shown_under_over_and_beside_the_render() {
    let folder = Workplace::new();
    let file = folder.path("photo.png");
    image::RgbImage::from_pixel(8, 4, image::Rgb([200, 30, 30]))
        .save(&file)
        .expect("a temporary file");
    let mut harness = editor_of(Options {
        typed_paths: Some(folder.root().to_owned()),
        ..options()
    });
    harness.settle();
    let (before, shown) = (harness.document().clone(), picture(&harness));
    harness.reveal(Pane::Camera);
    harness.tap_label("Reference image");
    harness.type_path(&file, "Open");
    let named = |harness: &Editor, place: &str| {
        let name = format!("Reference image {place} the render");
        harness.query_by_label(&name).map(|picture| picture.rect())
    };
    harness.see("it under the render", |harness| named(harness, "under").is_some());
    let viewport = harness.get_by_label("Viewport").rect();
    for (choice, place) in [("Over the render", "over"), ("Beside the render", "beside")] {
        harness.tap(Role::ComboBox, "Place of the reference");
        harness.press(choice);
        harness.see(choice, |harness| named(harness, place).is_some());
    }
    let (now, beside) = (
        harness.get_by_label("Viewport").rect(),
        named(&harness, "beside").expect("it is seen"),
    );
    assert!(
        now.width() < 0.51 * viewport.width() && beside.left() > now.right(),
        "{now:?} and {beside:?}"
    );
    harness.set("Opacity of the reference", 0.5);
    harness.settle();
    let reference = harness.document().view.reference.clone().expect("it was chosen");
    assert_eq!((reference.file, reference.opacity), (file, 0.5));
    assert_eq!(picture(&harness), shown, "it is no part of the render");
    harness.tap_label("Remove the reference image");
    assert_eq!(*harness.document(), before);
    assert_eq!(harness.get_by_label("Viewport").rect(), viewport);
    harness.undo();
    assert!(harness.document().view.reference.is_some());
}
