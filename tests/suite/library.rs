//! The presets panel: the user's own materials, and pictures of all of them.

use std::path::Path;

use egui::{Key, accesskit::Role};
use egui_kittest::kittest::Queryable as _;
use glossmith::{
    app::Options,
    app::actions::{Action, Command},
    document::MaterialSettings,
    render::thumbnails::key,
    scene::texture::{TextureTarget, UserTexture},
    store::{PRESETS, library, load_material},
};

use super::{
    cli_support::Workplace,
    ui::{Editor, editor_of, options},
};

/// An editor with the user's folder, its panel showing only what has this in its name.
fn editor_showing(data: &Path, name: &str) -> Editor {
    let mut harness = editor_of(Options {
        data: Some(data.to_owned()),
        ..options()
    });
    harness.run_steps(3);
    let search = harness.get_by_role_and_label(Role::TextInput, "Search presets");
    search.set_text_value_accesskit(name);
    harness.run_steps(2);
    harness
}

fn has_button(harness: &Editor, label: &str) -> bool {
    harness.query_by_role_and_label(Role::Button, label).is_some()
}

fn files(folder: &Path) -> Vec<MaterialSettings> {
    let entries = std::fs::read_dir(folder).map(|entries| entries.flatten().collect::<Vec<_>>());
    let paths = entries.unwrap_or_default().into_iter().map(|entry| entry.path());
    let paths = paths.filter(|path| path.is_file());
    paths.map(|path| load_material(&path).expect("whole").value).collect()
}

#[test]
fn own_presets_are_saved_found_again_used_renamed_and_deleted() {
    let folder = Workplace::new();
    let mut own = PRESETS[3].clone();
    own.name = "Zebra".to_owned();
    own.roughness = 0.77;
    let mut harness = editor_showing(folder.root(), "Zebra");
    harness.request(Action::UseMaterial(Box::new(own.clone())));
    harness.command(Command::SaveToMyPresets);
    // Its name is asked for, and begins as the material's.
    harness.see("the name", |harness| {
        harness.query_by_role_and_label(Role::TextInput, "New name").is_some()
    });
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    harness.see("the preset", |harness| has_button(harness, "Zebra"));
    assert_eq!(files(&folder.path("materials")), [own.clone()]);
    // Closed as it should be: nothing unsaved is offered at the next start.
    eframe::App::on_exit(harness.state_mut());
    drop(harness);

    let mut harness = editor_showing(folder.root(), "Z");
    harness.see("the preset", |harness| has_button(harness, "Zebra"));
    harness.check_accessibility();
    assert_ne!(*harness.material(), own);
    harness.press("Zebra");
    assert_eq!(*harness.material(), own);

    harness.press("Rename, export or delete Zebra");
    harness.press("Rename");
    harness.write("New name", "Zinc");
    harness.key_press(Key::Enter);
    harness.see("the new name", |harness| has_button(harness, "Zinc"));
    assert!(!has_button(&harness, "Zebra"));
    own.name = "Zinc".to_owned();
    assert_eq!(files(&folder.path("materials")), [own.clone()]);

    harness.press("Rename, export or delete Zinc");
    harness.press("Duplicate");
    harness.see("the copy", |harness| has_button(harness, "Zinc copy"));
    harness.press("Rename, export or delete Zinc copy");
    harness.press("Delete");
    harness.see("the copy to go", |harness| !has_button(harness, "Zinc copy"));

    harness.press("Rename, export or delete Zinc");
    harness.press("Delete");
    harness.see("it to go", |harness| !has_button(harness, "Zinc"));
    assert_eq!(files(&folder.path("materials")), []);
    harness.press("Restore zinc");
    harness.see("it to come back", |harness| has_button(harness, "Zinc"));
    assert_eq!(files(&folder.path("materials")), [own]);
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let folder = Workplace::new();
    let file = folder.path("file");
    std::fs::write(&file, "no folder").expect("a temporary file");
    let mut harness = editor_showing(&file, "");
    harness.command(Command::SaveToMyPresets);
    harness.wait("the message", |app| {
        let is_named = |text: &String| text.contains("materials") && text.contains("permissions");
        app.messages().iter().any(is_named)
    });
    let mut harness = editor_of(options());
    harness.command(Command::SaveToMyPresets);
    harness.wait_for_words("no folder for your materials");
}

/// The colour in the corner of a preset's picture, beside where a dot would be.
fn corner(harness: &mut Editor, name: &str) -> [u8; 4] {
    let rect = harness.get_by_role_and_label(Role::Button, name).rect();
    let window = harness
        .render()
        .expect("a Vulkan driver: apt install mesa-vulkan-drivers");
    let at = rect.left_center() + egui::vec2(7.0, -14.0);
    window.get_pixel(at.x as u32, at.y as u32).0
}

#[test]
fn presets_show_pictures_which_are_kept() {
    let folder = Workplace::new();
    let mut harness = editor_of(Options {
        cache: Some(folder.root().to_owned()),
        ..options()
    });
    harness.run_steps(3);
    let first = &PRESETS[0];
    let picture = |material| folder.path(format!("thumbnails/{:016x}.png", key(material)));
    let before = corner(&mut harness, &first.name);
    let shown = 6;
    for material in &PRESETS[..shown] {
        harness.see("the picture", |_| picture(material).exists());
    }
    harness.run_steps(3);
    let after = corner(&mut harness, &first.name);
    assert_ne!(before, after, "a dot leaves the corner as it is, a picture does not");
}

/// A material with images is a folder of its own, which holds all that it needs and comes back whole.
#[test]
fn materials_with_images_are_folders() {
    let place = Workplace::new();
    let folder = place.path("materials");
    let images = [place.path("a/wood.png"), place.path("b/wood.png")];
    let mut material = PRESETS[0].clone();
    material.name = "Oak floor".to_owned();
    let targets = [
        TextureTarget::BaseColor,
        TextureTarget::Roughness,
        TextureTarget::CoatColor,
    ];
    let files = [images[0].clone(), images[1].clone(), place.path("gone.png")];
    for (number, image) in images.iter().enumerate() {
        std::fs::create_dir_all(image.parent().expect("a folder")).expect("made");
        std::fs::write(image, [number as u8]).expect("written");
    }
    for (target, file) in std::iter::zip(targets, files) {
        material.put_texture(
            target,
            UserTexture {
                file,
                ..UserTexture::default()
            },
        );
    }
    assert_eq!(material.coat_weight, 1.0, "what has a colour is there");
    let path = library::add(&folder, &material).expect("added");
    assert_eq!(path, folder.join("oak-floor.material/oak-floor.json"));
    // Nothing of it lies elsewhere but what was gone before.
    std::fs::remove_dir_all(place.path("a")).expect("removed");
    let load = |path: &Path| load_material(path).expect("a material").value;
    let image = |material: &MaterialSettings, target: usize| {
        let texture = material.user_textures.get(targets[target]).expect("it has one");
        std::fs::read(&texture.file).ok()
    };
    let has_all = |path: &Path| [0, 1, 2].map(|target| image(&load(path), target));
    let whole = [Some(vec![0]), Some(vec![1]), None];
    assert_eq!(has_all(&path), whole);
    assert!(
        !std::fs::read_to_string(&path).expect("text").contains("/b/"),
        "by a name beside it"
    );
    std::fs::write(path.with_file_name("notes.txt"), "mine").expect("written");
    let renamed = library::rename(&path, "Floor").expect("renamed");
    assert!(
        renamed.with_file_name("notes.txt").is_file(),
        "what else is there moves along"
    );
    assert_eq!(renamed, folder.join("floor.material/floor.json"));
    assert_eq!(has_all(&renamed), whole);
    let copy = library::duplicate(&renamed).expect("copied");
    assert_eq!(has_all(&copy), whole);
    let removed = library::remove(&renamed).expect("removed");
    let names = |folder: &Path| {
        library::list(folder)
            .expect("listed")
            .iter()
            .map(library::LibraryMaterial::name)
            .collect::<Vec<_>>()
    };
    assert_eq!(names(&folder), ["Floor copy"]);
    assert_eq!(library::restore(&removed).expect("restored"), renamed);
    assert_eq!(has_all(&renamed), whole);
    // Beside one that took its name meanwhile.
    let removed = library::remove(&renamed).expect("removed");
    library::add(&folder, &load(&copy))
        .and_then(|path| library::rename(&path, "Floor"))
        .expect("added");
    let restored = library::restore(&removed).expect("restored");
    assert_eq!(restored, folder.join("floor 2.material/floor 2.json"));
    assert_eq!(has_all(&restored), whole);
    assert_eq!(names(&folder), ["Floor", "Floor", "Floor copy"]);
}
