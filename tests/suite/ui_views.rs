//! Views, small windows and plots: parallel views from the sides, lights that are hidden and moved along axes, tabs that are
//! whole, and the radius of the lobe's slice.

use egui::accesskit::Role;
use egui::{Key, Rect, Vec2};
use egui_kittest::kittest::Queryable as _;
use glossmith::app::Options;
use glossmith::app::actions::Action;
use glossmith::app::layout::Pane;
use glossmith::document::{AreaLight, CameraSettings};
use glossmith::scene::ModelSource;
use glossmith::scene::camera::Projection;

use super::ui::{Editor, drag, editor, editor_of, editor_with, options, picture, see, settle, undo};
use super::worker::small_document;

fn camera(harness: &Editor) -> CameraSettings {
    harness.state().document().camera
}

#[test]
fn keys_look_from_the_sides_in_parallel_rays() {
    let mut harness = editor();
    let (before, shown) = (harness.state().document().clone(), picture(&harness));
    for (key, yaw_deg, pitch_deg) in [(Key::Num1, 0.0, 0.0), (Key::Num3, 90.0, 0.0), (Key::Num7, 0.0, 90.0)] {
        harness.key_press(key);
        settle(&mut harness);
        let camera = camera(&harness);
        assert_eq!(
            (camera.yaw_deg, camera.pitch_deg, camera.projection),
            (yaw_deg, pitch_deg, Projection::Orthographic)
        );
        assert_ne!(picture(&harness), shown);
    }
    harness.key_press(Key::Num5);
    settle(&mut harness);
    assert_eq!(camera(&harness).projection, Projection::Perspective);
    // And by its row.
    harness.state_mut().reveal(Pane::Camera);
    harness.run_steps(3);
    harness
        .get_by_role_and_label(Role::ComboBox, "Projection")
        .click_accesskit();
    harness.run_steps(3);
    harness
        .get_by_role_and_label(Role::Button, "Orthographic")
        .click_accesskit();
    settle(&mut harness);
    assert_eq!(camera(&harness).projection, Projection::Orthographic);
    for _ in 0..5 {
        undo(&mut harness);
    }
    assert_eq!(*harness.state().document(), before);
    assert_eq!(picture(&harness), shown);
}

/// A drag of the camera in parallel rays keeps what is looked at, and zooming enlarges.
#[test]
fn a_parallel_view_is_turned_and_zoomed() {
    let mut harness = editor();
    harness.key_press(Key::Num1);
    settle(&mut harness);
    let middle = harness.get_by_label("Viewport").rect().center();
    drag(&mut harness, middle, Vec2::new(40.0, 0.0));
    settle(&mut harness);
    let turned = camera(&harness);
    assert!(turned.yaw_deg != 0.0 && turned.projection == Projection::Orthographic);
    assert_eq!(
        (turned.target, turned.distance),
        (None, None),
        "it goes on framing the model"
    );
    let of_model = |harness: &Editor| picture(harness).iter().filter(|pixel| pixel[3] > 0.0).count();
    let before = picture(&harness);
    assert!(of_model(&harness) > 0);
    harness.get_by_label("Viewport").focus();
    harness.run_steps(2);
    harness.key_press(Key::PageUp);
    settle(&mut harness);
    assert!(camera(&harness).distance.is_some());
    assert_ne!(picture(&harness), before, "nearer is larger");
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
    settle(&mut harness);
    harness.state_mut().reveal(Pane::Lighting);
    harness.run_steps(4);
    harness
}

#[test]
fn a_light_is_hidden_from_the_camera_by_its_row() {
    let mut harness = lit();
    let (before, shown) = (harness.state().document().clone(), picture(&harness));
    harness
        .get_by_role_and_label(Role::CheckBox, "Area light 1 hidden")
        .click_accesskit();
    settle(&mut harness);
    assert!(harness.state().document().lighting.area_lights[0].is_hidden);
    let brightest = |pixels: &[[f32; 4]]| pixels.iter().map(|pixel| pixel[1]).fold(0.0, f32::max);
    assert!(brightest(&shown) >= 5.0 && brightest(&picture(&harness)) < brightest(&shown));
    undo(&mut harness);
    assert_eq!(*harness.state().document(), before);
    assert_eq!(picture(&harness), shown);
}

/// New lights come into the image, none over another.
#[test]
fn new_lights_are_where_they_are_seen() {
    let mut harness = editor();
    harness.state_mut().reveal(Pane::Lighting);
    harness.run_steps(4);
    for label in ["Add area light", "Add spot"] {
        harness.get_by_label(label).click_accesskit();
        settle(&mut harness);
    }
    let viewport = harness.get_by_label("Viewport").rect();
    let [first, second] = [1, 2].map(|number| {
        let mark = harness
            .get_by_label(&format!("Move area light {number}"))
            .rect()
            .center();
        assert!(viewport.shrink(20.0).contains(mark), "{mark} in {viewport:?}");
        mark
    });
    assert!(first.distance(second) > 60.0, "{first} and {second}");
}

#[test]
fn a_light_is_moved_along_an_axis_and_in_the_plane_of_the_image() {
    let mut harness = lit();
    harness.get_by_label("Choose area light 1").click_accesskit();
    harness.run_steps(3);
    let before = harness.state().document().clone();
    let middle = |harness: &Editor| {
        harness.state().document().lighting.area_lights[0]
            .shape()
            .frame()
            .middle
    };
    let from = middle(&harness);
    let mark = harness.get_by_label("Move area light 1").rect().center();
    for (name, axis) in [("x", glam::DVec3::X), ("y", glam::DVec3::Y)] {
        let handle = harness
            .get_by_label(&format!("Move area light 1 along {name}"))
            .rect()
            .center();
        drag(&mut harness, handle, 0.4 * (handle - mark));
        settle(&mut harness);
        let by = middle(&harness) - from;
        assert!(
            by.dot(axis) > 0.02 && by.cross(axis).length() < 1e-6,
            "along {name}: {by}"
        );
        undo(&mut harness);
        assert_eq!(*harness.state().document(), before);
    }
    let handle = harness.get_by_label("Move area light 1 in the plane").rect().center();
    drag(&mut harness, handle, Vec2::new(-20.0, 15.0));
    settle(&mut harness);
    let now = harness.get_by_label("Move area light 1").rect().center();
    assert!(now.distance(mark + Vec2::new(-20.0, 15.0)) < 1.0, "{now}");
    undo(&mut harness);
    assert_eq!(*harness.state().document(), before);
}

/// A photograph is chosen, shown under, over and beside the render, and taken away; the render is no other one.
#[test]
fn a_reference_picture_is_shown_under_over_and_beside_the_render() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("photo.png");
    image::RgbImage::from_pixel(8, 4, image::Rgb([200, 30, 30]))
        .save(&file)
        .expect("a temporary file");
    let mut harness = editor_of(Options {
        typed_paths: Some(folder.path().to_owned()),
        ..options()
    });
    settle(&mut harness);
    let (before, shown) = (harness.state().document().clone(), picture(&harness));
    harness.state_mut().reveal(Pane::Camera);
    harness.run_steps(4);
    harness.get_by_label("Reference image").click_accesskit();
    see(&mut harness, "the path field", |harness| {
        harness.query_by_role_and_label(Role::TextInput, "Path").is_some()
    });
    harness
        .get_by_role_and_label(Role::TextInput, "Path")
        .set_text_value_accesskit(&file.display().to_string());
    harness.run_steps(2);
    harness.get_by_role_and_label(Role::Button, "Open").click();
    let named = |harness: &Editor, place: &str| {
        let name = format!("Reference image {place} the render");
        harness.query_by_label(&name).map(|picture| picture.rect())
    };
    see(&mut harness, "it under the render", |harness| {
        named(harness, "under").is_some()
    });
    let viewport = harness.get_by_label("Viewport").rect();
    for (choice, place) in [("Over the render", "over"), ("Beside the render", "beside")] {
        harness
            .get_by_role_and_label(Role::ComboBox, "Place of the reference")
            .click_accesskit();
        harness.run_steps(3);
        harness.get_by_role_and_label(Role::Button, choice).click_accesskit();
        see(&mut harness, choice, |harness| named(harness, place).is_some());
    }
    let (now, beside) = (
        harness.get_by_label("Viewport").rect(),
        named(&harness, "beside").expect("it is seen"),
    );
    assert!(
        now.width() < 0.51 * viewport.width() && beside.left() > now.right(),
        "{now:?} and {beside:?}"
    );
    harness
        .get_by_role_and_label(Role::SpinButton, "Opacity of the reference")
        .set_value_accesskit(0.5);
    settle(&mut harness);
    let reference = harness
        .state()
        .document()
        .view
        .reference
        .clone()
        .expect("it was chosen");
    assert_eq!((reference.file, reference.opacity), (file, 0.5));
    assert_eq!(picture(&harness), shown, "it is no part of the render");
    harness.get_by_label("Remove the reference image").click_accesskit();
    harness.run_steps(3);
    assert_eq!(*harness.state().document(), before);
    assert_eq!(harness.get_by_label("Viewport").rect(), viewport);
    undo(&mut harness);
    assert!(harness.state().document().view.reference.is_some());
}

/// From the moment on that the panels show another model the image says that it is not that one.
#[test]
fn an_image_of_another_model_says_what_will_come() {
    let mut harness = editor();
    let says = |harness: &Editor| {
        let told = ["Preparing Plane …", "The image still shows", "Loading "];
        told.iter()
            .any(|text| harness.query_all_by_label_contains(text).next().is_some())
    };
    assert!(!says(&harness));
    harness.state_mut().request(Action::UseModel(ModelSource::Plane));
    let is_plane = |harness: &Editor| harness.state().document().model == ModelSource::Plane;
    let mut was_said = false;
    see(&mut harness, "the plane", |harness| is_plane(harness) || says(harness));
    while !(is_plane(&harness) && harness.state().is_settled()) {
        was_said |= is_plane(&harness) && says(&harness);
        std::thread::sleep(std::time::Duration::from_millis(3));
        harness.step();
    }
    assert!(was_said, "the image was that of the other model");
    settle(&mut harness);
    assert!(!says(&harness));
}

/// The tabs that are shown, each with the place where the tabs of its bar end.
fn tabs(harness: &Editor) -> Vec<(&'static str, Rect, f32)> {
    let ends: Vec<Rect> = ["Manual: ", "More panels beside "]
        .into_iter()
        .flat_map(|name| harness.query_all_by_label_contains(name))
        .map(|button| button.rect())
        .collect();
    let of_pane = |pane: &Pane| {
        let tab = harness.query_all_by_role_and_label(Role::Button, pane.title()).next()?;
        let tab = tab.rect();
        let same_bar = ends
            .iter()
            .filter(|end| end.y_range().contains(tab.center().y) && end.right() > tab.left());
        let end = same_bar.map(|end| end.left()).fold(f32::INFINITY, f32::min);
        Some((pane.title(), tab, end))
    };
    Pane::ALL
        .iter()
        .filter(|pane| **pane != Pane::Viewport)
        .filter_map(of_pane)
        .collect()
}

/// Those for which there is no room are chosen from a menu.
#[test]
fn no_tab_is_cut_off_in_a_small_window() {
    let mut harness = editor();
    for size in [[800.0, 600.0], [1100.0, 700.0], [1366.0, 768.0]] {
        harness.set_size(Vec2::from(size));
        harness.run_steps(6);
        let tabs = tabs(&harness);
        assert!(tabs.len() >= 4, "one a bar at least: {tabs:?}");
        for (title, tab, end) in tabs {
            assert!(
                tab.right() <= end + 1.0,
                "{title} at {size:?}: {tab:?} is cut off at {end}"
            );
        }
    }
    harness.set_size(Vec2::new(800.0, 600.0));
    harness.state_mut().reveal(Pane::Curve);
    harness.run_steps(6);
    assert!(harness.query_by_role_and_label(Role::Button, "Convergence").is_none());
    harness.get_by_label("More panels beside Curve").click_accesskit();
    harness.run_steps(3);
    harness
        .get_by_role_and_label(Role::Button, "Convergence")
        .click_accesskit();
    harness.run_steps(6);
    assert!(
        harness.query_by_label("Manual: Convergence").is_some(),
        "it is in front"
    );
}

/// The slice of a narrow lobe in powers of ten, and cut off.
#[test]
fn the_polar_slice_has_a_logarithmic_radius_and_a_limit() {
    let mut harness = editor();
    harness
        .get_by_role_and_label(Role::SpinButton, "Specular roughness")
        .set_value_accesskit(0.05);
    harness.state_mut().reveal(Pane::Lobe);
    harness.run_steps(3);
    let says = |harness: &Editor, text: &str| harness.query_all_by_label_contains(text).next().is_some();
    let (radius, from_zero) = ("cos θ (1/sr): ", "cos θ (1/sr): 0 to ");
    see(&mut harness, "the slice", |harness| says(harness, from_zero));
    let logarithmic = |harness: &mut Editor| {
        harness
            .get_by_role_and_label(Role::CheckBox, "Logarithmic radius")
            .click_accesskit();
        harness.run_steps(3);
    };
    logarithmic(&mut harness);
    assert!(says(&harness, radius) && !says(&harness, from_zero), "powers of ten");
    logarithmic(&mut harness);
    assert!(says(&harness, from_zero) && !says(&harness, "the rest is cut off"));
    harness
        .get_by_role_and_label(Role::SpinButton, "Radius up to")
        .set_value_accesskit(2.0);
    harness.run_steps(3);
    assert!(says(&harness, "cos θ (1/sr): 0 to 2"));
    assert!(
        harness
            .query_all_by_label_contains("the rest is cut off")
            .next()
            .is_some()
    );
}
