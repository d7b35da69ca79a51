//! Textures, the lobe of opened models, the list of environments and the palette's parameters, in the
//! editor with the real renderer.

use egui::{Key, Modifiers, accesskit::Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glossmith::{
    app::{Options, actions::Action, actions::Command, layout::Pane},
    document::{AreaLight, Document, GroundKind, range},
    optics::{curve::Curve, curve::curve_density, lobe::Lobe},
    scene::{ModelSource, environment::EnvironmentSource, texture::TextureTarget},
    store::examples::still_life,
};
use serde_json::json;

use super::{
    cli_support::{Workplace, write_hdr},
    gltf_builder::glb,
    textures::{four_texels, textured_square},
    ui::{Editor, editor, editor_of, editor_with, options, picture},
    worker::small_document,
};

/// A file with a square whose colour and roughness are pictures.
fn textured_file(folder: &Workplace) -> std::path::PathBuf {
    let path = folder.path("square.glb");
    write_textured_square(&path);
    path
}

/// Writes a square whose colour and roughness are pictures.
pub fn write_textured_square(path: &std::path::Path) {
    let material = json!({"pbrMetallicRoughness": {
        "baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 1}
    }});
    let (buffer, document) = textured_square(&material, &[four_texels(), four_texels()], &json!({}));
    std::fs::write(path, glb(&document, &buffer.bytes)).expect("a temporary file");
}

#[test]
fn textures_have_rows_that_switch_them() {
    let folder = Workplace::new();
    let mut document = small_document();
    (document.camera.yaw_deg, document.camera.pitch_deg) = (0.0, 0.0);
    let mut harness = editor_with(document, vec![textured_file(&folder)]);
    harness.settle();
    assert!(!harness.has("Geometry normal texture"), "it has no normals");
    let textured = picture(&harness);
    for label in ["Specular roughness texture", "Base colour texture"] {
        let switch = |harness: &mut Editor| {
            harness.tap(Role::CheckBox, label);
            harness.settle();
        };
        let before = harness.document().clone();
        switch(&mut harness);
        let uses = harness.material().textures;
        assert_eq!(
            (uses[TextureTarget::BaseColor], uses[TextureTarget::Roughness]),
            (label != "Base colour texture", label == "Base colour texture")
        );
        assert!(picture(&harness) != textured, "{label}");
        harness.undo();
        assert_eq!(*harness.document(), before);
        assert!(picture(&harness) == textured, "{label}: undo");
    }
}

/// Files given at the start are where editing begins; undo does not go behind them.
#[test]
fn undo_stops_at_the_files_given_at_the_start() {
    let folder = Workplace::new();
    let light = folder.path("orange.hdr");
    write_hdr(&light, 16, 8, |_, _| [1.0, 0.4, 0.1]);
    let mut harness = editor_with(small_document(), vec![textured_file(&folder), light]);
    harness.settle();
    let start = harness.document().clone();
    assert!(matches!(start.model, ModelSource::File(_)), "{:?}", start.model);
    harness.set("Specular roughness", 0.85);
    harness.settle();
    assert_ne!(*harness.document(), start);
    for _ in 0..3 {
        harness.undo();
    }
    assert_eq!(*harness.document(), start);
}

#[test]
fn opened_models_get_the_lobe_that_the_menu_says() {
    let folder = Workplace::new();
    // Smooth enough for either: what is rougher than 0.7 is GGX whatever the menu says.
    let material = json!({"pbrMetallicRoughness": {"roughnessFactor": 0.5}});
    let (buffer, document) = textured_square(&material, &[], &json!({}));
    let path = folder.path("smooth.glb");
    std::fs::write(&path, glb(&document, &buffer.bytes)).expect("a temporary file");
    let mut harness = editor();
    for (label, lobe) in [("GGX", Lobe::Ggx), ("Geometric", Lobe::Geometric)] {
        harness.click(Role::Button, "File");
        harness.click_on(|harness| harness.get_by_label_contains("Import glTF materials as").rect());
        harness.click(Role::RadioButton, label);
        harness.key_press(Key::Escape);
        harness.run_steps(2);
        harness.request(Action::UseModel(ModelSource::Sphere));
        harness.wait("the sphere", |app| app.document().model == ModelSource::Sphere);
        harness.request(Action::Open(path.clone()));
        harness.wait("the model", |app| {
            app.document().model == ModelSource::File(path.clone())
        });
        assert_eq!(harness.material().lobe, lobe);
        assert!(harness.document().ground, "it stands on something");
    }
}

#[test]
fn environments_are_listed_with_pictures_and_files_stay_in_the_list() {
    let folder = Workplace::new();
    let light = folder.path("orange.hdr");
    write_hdr(&light, 16, 8, |_, _| [1.0, 0.4, 0.1]);
    let cache = folder.path("cache");
    let mut harness = editor_of(Options {
        cache: Some(cache.clone()),
        ..options()
    });
    harness.settle();
    harness.reveal(Pane::Lighting);
    harness.request(Action::Open(light.clone()));
    let source = EnvironmentSource::File(light);
    harness.wait("the light", |app| app.document().lighting.environment == source);
    harness.settle();
    // Before a photograph the ground is its shadow alone.
    assert_eq!(harness.document().lighting.ground.kind, GroundKind::ShadowCatcher);
    harness.press("Sky");
    harness.wait("the sky", |app| {
        app.document().lighting.environment == EnvironmentSource::Sky
    });
    harness.press("orange.hdr");
    harness.wait("the light again", |app| app.document().lighting.environment == source);
    // Studio, sky, furnace and the file.
    harness.see("the pictures", |_| {
        std::fs::read_dir(cache.join("environments")).is_ok_and(|entries| entries.count() == 4)
    });
    harness.run_steps(2);
    harness.check_accessibility();
    harness.undo();
    assert_eq!(harness.document().lighting.environment, EnvironmentSource::Sky);
}

#[test]
fn the_palette_leads_to_parameters_and_panels() {
    let mut harness = editor();
    let enter = |harness: &mut Editor, text: &str| {
        harness.event(egui::Event::Text(text.to_owned()));
        harness.run_steps(2);
        harness.key_press(Key::Enter);
        harness.run_steps(4);
    };
    let find = |harness: &mut Editor, words: &str| {
        harness.command(Command::Palette);
        enter(harness, words);
    };
    harness.key_press_modifiers(Modifiers::COMMAND, Key::K);
    harness.run_steps(2);
    // Typed at once: the field has the keys.
    enter(&mut harness, "spec rough");
    let node = harness.get_by_label("Specular roughness");
    assert!(node.accesskit_node().is_focused(), "the row has the keys");
    enter(&mut harness, "0.9");
    harness.settle();
    assert_eq!(harness.material().roughness, 0.9);
    // Digits after Enter are not those of the view.
    let camera = harness.document().camera;
    harness.key_press(Key::Num5);
    harness.run_steps(2);
    assert_eq!(harness.document().camera, camera);
    // What does not apply is found, and leads to what makes it apply.
    find(&mut harness, "coat rough");
    let node = harness.get_by_label("Coat weight");
    assert!(node.accesskit_node().is_focused());
    enter(&mut harness, "1");
    harness.settle();
    assert!(harness.has("Coat on the base") && harness.has("Coat darkening"));
    harness.undo();
    for (key, value) in [(Key::ArrowDown, Lobe::ALL[1]), (Key::ArrowUp, Lobe::ALL[0])] {
        find(&mut harness, "specular lobe");
        harness.key_press(key);
        harness.run_steps(2);
        assert_eq!(harness.material().lobe, value);
    }
    find(&mut harness, "f-number");
    let node = harness.get_by_role_and_label(Role::SpinButton, "f-number");
    assert!(node.accesskit_node().is_focused());
    find(&mut harness, "race");
    assert!(
        harness.has("Run the race"),
        "the panel is in front, and nothing has begun"
    );
}

/// In narrow columns rows wrap: no control reaches beyond its column, where it would be cut.
#[test]
fn no_control_is_cut_in_a_small_window() {
    let mut document = still_life();
    // Gold, whose indices are three numbers each.
    document.materials[0] = document.materials[2].clone();
    let mut harness = editor_with(document, Vec::new());
    harness.command(Command::Pause);
    harness.set_size(egui::vec2(800.0, 600.0));
    let mut cut = Vec::new();
    for pane in Pane::ALL {
        harness.reveal(pane);
        harness.run_steps(2);
        let image = harness.get_by_label("Viewport").rect();
        for node in harness.root().children_recursive() {
            let data = node.accesskit_node();
            // The borders between columns have no label.
            if data.bounding_box().is_none() || data.label().is_none() {
                continue;
            }
            let rect = node.rect();
            // The menus and the status bar go over all columns.
            let is_bar = rect.bottom() < image.top() - 20.0 || (image.bottom()..600.0).contains(&rect.center().y);
            let is_control = data.data().supports_action(egui::accesskit::Action::Click);
            if !is_control || is_bar || image.contains_rect(rect) {
                continue;
            }
            let end = if rect.left() < image.left() {
                image.left()
            } else {
                800.0
            };
            if rect.right() > end + 0.5 {
                cut.push(format!("{pane:?}: {:?} at {rect:?}, beyond {end}", data.label()));
            }
        }
    }
    assert!(cut.is_empty(), "{cut:#?}");
}

/// A plot that is begun in view ends in view.
#[test]
fn the_curve_fits_a_low_panel() {
    let mut harness = editor_with(small_document(), Vec::new());
    harness.command(Command::Pause);
    harness.reveal(Pane::Curve);
    for height in [600.0, 720.0, 768.0, 1080.0] {
        harness.set_size(egui::vec2(1280.0, height));
        harness.run_steps(3);
        let bottom = harness.get_by_label("Viewport").rect().bottom();
        for plot in ["The curve D over ξ", "The density of the distance D"] {
            let rect = harness.get_by_label(plot).rect();
            assert!(
                rect.bottom() <= bottom || rect.top() >= bottom - 16.0,
                "{plot} at {rect:?} of {bottom}"
            );
        }
    }
}

/// Brings the curve's panel to the front and makes the curve a custom one, by the button or by the menu.
fn make_custom(harness: &mut Editor, is_by_button: bool) {
    harness.reveal(Pane::Curve);
    if is_by_button {
        harness.click(Role::Button, "Edit as custom");
    } else {
        harness.click(Role::ComboBox, "Curve shape");
        harness.click(Role::Button, Curve::Custom.label());
    }
}

#[test]
fn a_named_curve_becomes_a_custom_one_in_its_panel() {
    for (named, is_by_button) in [(Curve::Smooth, true), (Curve::Cbrt, true), (Curve::Smooth, false)] {
        let mut document = small_document();
        document.materials[0].curve = named;
        let mut harness = editor_with(document, Vec::new());
        harness.settle();
        let before = harness.document().clone();
        make_custom(&mut harness, is_by_button);
        harness.settle();
        let material = harness.material();
        assert_eq!(material.curve, Curve::Custom);
        if is_by_button {
            let table = material.custom_curve.table();
            for distance in [0.3, 0.5, 0.7, 0.9_f64] {
                let [own, of_named] = [(Curve::Custom, &table[..]), (named, &[])]
                    .map(|(curve, table)| curve_density(curve, table, distance));
                near!(own / of_named, 1.0, 0.05, "{own} and {of_named} at {distance}");
            }
        }
        assert!(!harness.has("Edit as custom"));
        let plot = harness.get_by_label("The curve D over ξ").rect();
        harness.drag(plot.center() - egui::vec2(90.0, 40.0), egui::vec2(9.0, 0.0));
        harness.run_steps(60);
        let layers = harness.ctx.memory(|memory| memory.areas().visible_layer_ids());
        assert!(layers.iter().all(|layer| layer.order != egui::Order::Tooltip));
        harness.undo();
        assert_eq!(*harness.document(), before);
    }
}

/// A document whose numbers all lie at the lower or at the upper end of what is taken.
fn extreme_document(is_high: bool) -> Document {
    let end = |range: std::ops::RangeInclusive<f64>| if is_high { *range.end() } else { *range.start() };
    let mut document = small_document();
    let light = AreaLight {
        yaw_deg: end(range::YAW_DEG),
        pitch_deg: end(range::PITCH_DEG),
        distance: end(range::AREA_LENGTH),
        width: end(range::AREA_LENGTH),
        height: end(range::AREA_LENGTH),
        strength: end(range::STRENGTH) as f32,
        ..AreaLight::default()
    };
    document.lighting.area_lights = vec![light];
    document.lighting.strength = end(range::STRENGTH) as f32;
    document.lighting.rotation_deg = end(range::ROTATION_DEG) as f32;
    document.lighting.background_blur_deg = end(range::BACKGROUND_BLUR_DEG) as f32;
    let camera = &mut document.camera;
    (camera.yaw_deg, camera.pitch_deg) = (end(range::YAW_DEG), end(range::PITCH_DEG));
    (camera.fov_deg, camera.aperture) = (end(range::FOV_DEG), end(range::APERTURE).max(1e-9));
    camera.focus_distance = Some(end(range::DISTANCE));
    document.view.exposure_ev = end(range::EXPOSURE_EV) as f32;
    let render = &mut document.render;
    render.samples = end(range::SAMPLES) as u32;
    render.time_s = Some(end(range::TIME_S));
    render.noise = Some(end(range::NOISE));
    render.min_samples = end(range::MIN_SAMPLES) as u32;
    render.bounces = end(range::BOUNCES) as u32;
    render.firefly_clamp = Some(end(range::FIREFLY_CLAMP) as f32);
    if !is_high {
        (render.width, render.height) = (1, 1);
    }
    document.check().expect("the ends are taken");
    document
}

/// Numbers that a document may have are shown as they are: a panel takes none of them for out of range.
#[test]
fn looking_at_a_panel_changes_nothing() {
    for is_high in [false, true] {
        let document = extreme_document(is_high);
        let mut harness = editor_with(document.clone(), Vec::new());
        harness.command(Command::Pause);
        for pane in Pane::ALL {
            harness.reveal(pane);
            assert_eq!(*harness.document(), document, "{pane:?}, high: {is_high}");
        }
    }
}

#[test]
fn a_look_is_matched_used_and_undone() {
    let mut harness = editor();
    harness.reveal(Pane::Lobe);
    harness.click(Role::ComboBox, "Compare the lobe");
    harness.click(Role::Button, "GGX");
    // The panel may have to be scrolled to reach the buttons, which accessibility does by itself.
    harness.tap_label("Match look");
    harness.see_label("Use it");
    let before = harness.document().clone();
    harness.tap_label("Use it");
    harness.settle();
    let material = harness.material();
    assert_eq!((material.lobe, material.curve), (Lobe::Geometric, Curve::Custom));
    assert_ne!(material.custom_curve, before.materials[0].custom_curve);
    harness.undo();
    assert_eq!(*harness.document(), before);
}
