//! Textures of one's own in the window: chosen, dropped, placed, taken off.

use std::path::{Path, PathBuf};

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable as _;
use glossmith::{
    app::Options,
    document::Document,
    scene::ModelSource,
    scene::texture::{TextureTarget, UserTexture, set::recognised, set::targets_of},
};
use image::{Rgba, RgbaImage};

use super::{
    cli_support::Workplace,
    ui::{Editor, editor_of, editor_with, options, picture},
    ui_files::says,
    worker::small_document,
};

/// The editor on a sphere, with paths typed into a field.
fn on_a_sphere(folder: &Workplace) -> Editor {
    let document = Document {
        model: ModelSource::Sphere,
        ..small_document()
    };
    let mut harness = editor_of(Options {
        document: Some(document),
        typed_paths: Some(folder.root().to_owned()),
        ..options()
    });
    harness.settle();
    harness
}

fn write(folder: &Workplace, name: &str) -> std::path::PathBuf {
    let path = folder.path(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    let texels = |x: u32, y: u32| Rgba([(90 * x) as u8, (90 * y) as u8, 200, 255]);
    RgbaImage::from_fn(3, 3, texels).save(&path).unwrap();
    path
}

fn own(harness: &Editor, target: TextureTarget) -> Option<UserTexture> {
    harness.material().user_textures.get(target).cloned()
}

#[test]
fn a_texture_is_chosen_placed_and_removed() {
    let folder = Workplace::new();
    let file = write(&folder, "any.png");
    let mut harness = on_a_sphere(&folder);
    let plain = picture(&harness);
    let before = harness.document().clone();
    harness.tap(Role::Button, "Texture of the base colour");
    harness.see_label("Choose a texture");
    harness.write("Path", file.to_str().unwrap());
    harness.tap(Role::Button, "Open");
    harness.wait("the texture", |app| {
        app.document().materials[0]
            .user_textures
            .get(TextureTarget::BaseColor)
            .is_some()
    });
    harness.settle();
    let textured = picture(&harness);
    assert!(textured != plain);
    assert_eq!(own(&harness, TextureTarget::BaseColor), Some(UserTexture::of(file)));
    // Its switch, its placement.
    harness.tap(Role::CheckBox, "Base colour texture");
    harness.settle();
    assert!(picture(&harness) != textured && own(&harness, TextureTarget::BaseColor).is_some());
    harness.undo();
    assert!(picture(&harness) == textured);
    harness.tap_label("Placement of the base colour texture");
    // It unfolds by and by.
    harness.see_label("Base colour texture rotation");
    harness.run_steps(20);
    let value = |harness: &mut Editor, label: &str, value: f64| {
        let row = harness.get_by_role_and_label(Role::SpinButton, label);
        row.set_value_accesskit(value);
        harness.settle();
    };
    value(&mut harness, "Base colour texture rotation", 45.0);
    value(&mut harness, "Base colour texture scale", 3.0);
    let placed = own(&harness, TextureTarget::BaseColor).unwrap();
    assert_eq!((placed.rotation_deg, placed.scale), (45.0, 3.0));
    assert!(picture(&harness) != textured);
    harness.undo();
    harness.undo();
    assert!(picture(&harness) == textured);
    // Taken off by its menu, and brought back.
    harness.tap(Role::Button, "Menu of the base colour texture");
    harness.tap(Role::Button, "Remove");
    harness.settle();
    assert_eq!(own(&harness, TextureTarget::BaseColor), None);
    harness.undo();
    assert!(own(&harness, TextureTarget::BaseColor).is_some());
    harness.undo();
    assert_eq!(*harness.document(), before);
}

/// The pictures of a set go where their names say, in one edit; by files and by their folder.
#[test]
fn a_set_is_dropped_at_once() {
    let folder = Workplace::new();
    let names = [
        "wood/wood_basecolor.png",
        "wood/wood_rough.png",
        "wood/wood_nor_dx.png",
        "wood/wood_ao.png",
    ];
    let files = names.map(|name| write(&folder, name));
    let mut harness = on_a_sphere(&folder);
    let before = harness.document().clone();
    for dropped in [files.to_vec(), vec![folder.path("wood")]] {
        harness.drop_on(&dropped);
        harness.settle();
        assert_eq!(own(&harness, TextureTarget::BaseColor).unwrap().file, files[0]);
        assert_eq!(own(&harness, TextureTarget::Roughness).unwrap().file, files[1]);
        let normal = own(&harness, TextureTarget::Normal).unwrap();
        assert!(normal.file == files[2] && normal.inverted, "green points down");
        assert!(
            says(&harness, "wood_ao.png: not used"),
            "{:?}",
            harness.state().messages()
        );
        harness.undo();
        assert_eq!(*harness.document(), before);
    }
}

/// What is missing is told at its row, and all else goes on.
#[test]
fn a_missing_texture_is_told() {
    let folder = Workplace::new();
    let mut document = Document {
        model: ModelSource::Sphere,
        ..small_document()
    };
    let here = UserTexture::of(write(&folder, "here.png"));
    document.materials[0].put_texture(TextureTarget::BaseColor, here);
    let gone = UserTexture::of(folder.path("gone.png"));
    document.materials[0].put_texture(TextureTarget::Roughness, gone);
    let mut harness = editor_with(document, Vec::new());
    harness.settle();
    harness.see_label("gone.png: missing");
    assert!(harness.query_all_by_label("here.png").count() > 0);
}

fn targets(name: &str) -> Vec<(&'static str, bool)> {
    targets_of(Path::new(name))
        .iter()
        .map(|(target, texture)| (target.name(), texture.inverted))
        .collect()
}

#[test]
fn pictures_are_known_by_their_names() {
    assert_eq!(targets("wood_BaseColor.png"), [("base-color", false)]);
    assert_eq!(targets("rusty_metal_02_diff_4k.jpg"), [("base-color", false)]);
    assert_eq!(targets("Wood062_2K_NormalGL.jpg"), [("normal", false)]);
    assert_eq!(targets("Wood062_2K_NormalDX.jpg"), [("normal", true)]);
    assert_eq!(targets("brick_nor_dx_1k.exr"), [("normal", true)]);
    assert_eq!(targets("brick_nor_gl_1k.exr"), [("normal", false)]);
    assert_eq!(targets("paint-Glossiness.tif"), [("roughness", true)]);
    assert_eq!(
        targets("helmet_OcclusionRoughnessMetallic.png"),
        [("roughness", false), ("metalness", false)]
    );
    assert_eq!(targets("rock_arm_2k.png"), [("roughness", false), ("metalness", false)]);
    assert_eq!(targets("base_color.png"), [("base-color", false)]);
    assert_eq!(targets("metal_plate_rough.png"), [("roughness", false)]);
    assert_eq!(targets("rock_ao.png"), []);
    assert_eq!(targets("holiday.jpg"), []);
}

#[test]
fn of_two_for_one_target_the_better_is_taken() {
    let paths = ["a_arm.png", "a_nor_dx.png", "a_nor_gl.png", "a_rough.png", "a_disp.png"].map(PathBuf::from);
    let (found, left) = recognised(&paths);
    let names: Vec<_> = found
        .iter()
        .map(|(target, texture)| (target.name(), texture.file.to_str().unwrap_or_default()))
        .collect();
    assert_eq!(
        names,
        [
            ("roughness", "a_rough.png"),
            ("metalness", "a_arm.png"),
            ("normal", "a_nor_gl.png")
        ]
    );
    assert_eq!(left, ["a_nor_dx.png", "a_disp.png"].map(PathBuf::from));
}
