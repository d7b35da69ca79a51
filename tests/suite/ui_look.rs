//! Looking closer: the inspector, maps over the picture, and the picture's own pixels.

use egui::{Event, Key, Modifiers, Pos2, Vec2, accesskit::Role};
use egui_kittest::kittest::Queryable as _;
use glossmith::{
    app::actions::{Action, Command},
    app::layout::Pane,
    render::{shown::Shown, worker::Picture},
};

use super::{
    ui::{Editor, editor_with, picture},
    worker::small_document,
};

/// Where the picture is in the viewport, which it fits.
fn place(harness: &Editor) -> egui::Rect {
    let viewport = harness.get_by_label("Viewport").rect();
    let snapshot = harness.state().snapshot();
    let picture = snapshot.picture.as_ref().expect("it was waited for");
    let size = Vec2::new(picture.width as f32, picture.height as f32);
    let scale = (viewport.width() / size.x).min(viewport.height() / size.y);
    egui::Rect::from_center_size(viewport.center(), size * scale)
}

fn hover_pixel(harness: &mut Editor, [x, y]: [u32; 2]) {
    let place = place(harness);
    let pixel = place.width() / 40.0;
    harness.hover_at(place.min + Vec2::new(x as f32 + 0.5, y as f32 + 0.5) * pixel);
    harness.run_steps(3);
}

/// So many samples that the error of every pixel is known, and so bright that some are clipped.
fn editor() -> Editor {
    let mut document = small_document();
    document.render.samples = 16;
    document.view.exposure_ev = 2.5;
    let mut harness = editor_with(document, Vec::new());
    harness.settle();
    harness
}

fn inspecting() -> Editor {
    let mut harness = editor();
    harness.reveal(Pane::Inspector);
    harness.wait("what is known of pixels", |app| {
        app.snapshot()
            .picture
            .as_ref()
            .is_some_and(|picture| picture.facts.is_some())
    });
    harness
}

fn shown(harness: &Editor) -> std::sync::Arc<Picture> {
    harness.state().snapshot().picture.clone().expect("it was waited for")
}

#[test]
fn the_inspector_tells_of_the_pixel_under_the_pointer() {
    let mut harness = inspecting();
    assert!(harness.tells("Move the pointer over the image"));
    for pixel in [[20, 12], [3, 2]] {
        hover_pixel(&mut harness, pixel);
        let [x, y] = pixel;
        assert!(harness.tells(&format!("{x}, {y} of 40 × 24")));
        let index = (y * 40 + x) as usize;
        let [r, g, b, _] = picture(&harness)[index];
        assert!(harness.tells(&format!("{r:.4}  {g:.4}  {b:.4}")), "its linear colour");
        let bytes = &shown(&harness).rgba[4 * index..4 * index + 3];
        assert!(harness.tells(&format!("#{:02x}{:02x}{:02x}", bytes[0], bytes[1], bytes[2])));
        assert!(harness.tells("of the mean luminance"), "its error");
    }
    // The middle shows the model, the corner the background.
    assert!(harness.tells("none: the background"));
    hover_pixel(&mut harness, [20, 12]);
    let name = harness.material().name.clone();
    assert!(harness.tells(&name) && !harness.tells("none: the background"));
    assert!(harness.tells("Histogram of the image") && harness.tells("Too bright for the screen"));
}

/// Also while a coarse step is shown.
#[test]
fn the_inspector_names_pixels_of_the_full_size() {
    let mut document = small_document();
    (document.render.width, document.render.height) = (1200, 1200);
    let mut harness = editor_with(document, Vec::new());
    harness.command(Command::Pause);
    harness.reveal(Pane::Inspector);
    harness.request(Action::LookFrom(90.0, 0.0));
    harness.wait("a coarse step", |app| {
        app.snapshot()
            .picture
            .as_ref()
            .is_some_and(|picture| picture.reduction > 1)
    });
    harness.hover_at(place(&harness).center());
    harness.run_steps(3);
    assert!(harness.tells("of 1200 × 1200"));
}

#[test]
fn maps_are_chosen_over_the_picture_and_leave_it_as_it_is() {
    let mut harness = editor();
    let (linear, plain) = (picture(&harness), shown(&harness).rgba.clone());
    let mut seen = vec![plain.clone()];
    for &map in Shown::ALL[1..].iter().filter(|map| **map != Shown::Precision) {
        let label = map.label();
        harness.click(Role::ComboBox, "Viewport shows");
        // Panels may have tabs of the same name, but not over the viewport.
        let over = harness.get_by_label("Viewport").rect().x_range();
        harness.click_on(|harness| {
            let mut choices = harness.query_all_by_role_and_label(Role::Button, label);
            let choice = choices.find(|choice| over.contains(choice.rect().center().x));
            choice.expect("it is in the menu").rect()
        });
        harness.wait(label, |app| {
            let picture = app.snapshot().picture.clone();
            picture.is_some_and(|picture| picture.map.is_some_and(|(of, _)| of == map))
        });
        let rgba = shown(&harness).rgba.clone();
        assert_eq!(picture(&harness), linear, "{label} leaves the image as it is");
        assert!(!seen.contains(&rgba), "{label} shows nothing of its own");
        seen.push(rgba);
    }
    harness.request(Action::Show(Shown::Picture));
    harness.wait("the picture", |app| {
        app.snapshot()
            .picture
            .clone()
            .is_some_and(|picture| picture.map.is_none())
    });
    assert_eq!(shown(&harness).rgba, plain);
}

fn wheel(harness: &mut Editor, at: Pos2, points: f32) {
    harness.hover_at(at);
    harness.event(Event::ModifiersChanged(Modifiers::COMMAND));
    harness.event(Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: Vec2::new(0.0, points),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::COMMAND,
    });
    harness.run_steps(20);
    harness.event(Event::ModifiersChanged(Modifiers::NONE));
    harness.run_steps(2);
}

#[test]
fn the_pictures_own_pixels_are_magnified_without_moving_the_camera() {
    let mut harness = inspecting();
    let before = harness.document().clone();
    let whole = "Show the whole image";
    hover_pixel(&mut harness, [30, 16]);
    let at = place(&harness).min + Vec2::new(30.5, 16.5) * (place(&harness).width() / 40.0);
    wheel(&mut harness, at, 300.0);
    assert!(harness.has(whole), "it is not magnified");
    assert!(
        harness.tells("30, 16 of 40 × 24"),
        "what is under the pointer stays there"
    );
    // Moved by the middle button, the pixel goes with the pointer: to the side, as all of the height fits.
    let to = at - Vec2::new(100.0, 0.0);
    let button = |harness: &mut Editor, pos: Pos2, pressed: bool| {
        harness.event(Event::PointerButton {
            pos,
            button: egui::PointerButton::Middle,
            pressed,
            modifiers: Modifiers::NONE,
        });
        harness.run_steps(2);
    };
    button(&mut harness, at, true);
    for step in 1..=4 {
        harness.hover_at(at + (to - at) * (step as f32 / 4.0));
        harness.run_steps(2);
    }
    button(&mut harness, to, false);
    assert!(harness.tells("30, 16 of 40 × 24"), "it was not moved");
    assert_eq!(*harness.document(), before, "the camera stays");
    harness.click_on(|harness| harness.get_by_label(whole).rect());
    assert!(!harness.has(whole));
    for (key, is_magnified) in [
        (Key::Plus, true),
        (Key::Plus, true),
        (Key::Minus, true),
        (Key::Num0, false),
    ] {
        harness.key_press(key);
        harness.run_steps(3);
        assert_eq!(harness.has(whole), is_magnified, "{key:?}");
    }
    harness.command(Command::ZoomIn);
    harness.settle();
    harness.see("the whole image's button", |harness| harness.has(whole));
    assert_eq!(*harness.document(), before);
}
