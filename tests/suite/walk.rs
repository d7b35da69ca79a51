//! Ten tasks of look-dev in the window, every press of a key or a button counted: docs/WALK.md sets them beside what other
//! programs' manuals ask for.

use std::time::Instant;

use egui::accesskit::Role;
use egui::{Key, Modifiers, PointerButton, Pos2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glossmith::app::App;
use glossmith::app::layout::Pane;
use glossmith::document::{AreaLight, Document, LightPaths};
use glossmith::scene::ModelSource;
use glossmith::scene::texture::TextureTarget;

use super::ui::{Editor, drag, editor_of, options, see, settle, wait};
use super::ui_files::drop_on;
use super::worker::small_document;

/// A window, and how often a hand has done something in it.
pub(super) struct Walk {
    pub(super) harness: Editor,
    /// Clicks, drags, key presses; a number or a path that is typed counts as one.
    pub(super) events: u32,
    begun: Instant,
    pub(super) _folder: tempfile::TempDir,
}

impl Walk {
    pub(super) fn new(change: impl FnOnce(&mut Document)) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut document = Document {
            model: ModelSource::Teapot,
            ..small_document()
        };
        change(&mut document);
        let mut harness = editor_of(glossmith::app::Options {
            document: Some(document),
            data: Some(folder.path().join("data")),
            typed_paths: Some(folder.path().to_owned()),
            ..options()
        });
        settle(&mut harness);
        Self {
            harness,
            events: 0,
            begun: Instant::now(),
            _folder: folder,
        }
    }

    /// Clicks a control where it is seen.
    pub(super) fn click(&mut self, role: Role, label: &str) {
        let at = self.harness.get_by_role_and_label(role, label).rect().center();
        self.click_at(at, PointerButton::Primary);
    }

    /// Brings a panel to the front by its tab.
    pub(super) fn tab(&mut self, pane: Pane) {
        let is_shown = |node: &egui_kittest::Node<'_>| node.accesskit_node().role() != Role::MenuItem;
        let tabs = self.harness.query_all_by_label(pane.title());
        let at = tabs.filter(is_shown).map(|tab| tab.rect().center()).next();
        self.click_at(at.expect("the panel's tab"), PointerButton::Primary);
    }

    pub(super) fn click_at(&mut self, at: Pos2, button: PointerButton) {
        self.harness.hover_at(at);
        self.harness.step();
        for pressed in [true, false] {
            let modifiers = Modifiers::NONE;
            let event = egui::Event::PointerButton {
                pos: at,
                button,
                pressed,
                modifiers,
            };
            self.harness.event(event);
            self.harness.step();
        }
        self.harness.run_steps(3);
        self.events += 1;
    }

    pub(super) fn key(&mut self, key: Key) {
        self.harness.key_press(key);
        self.harness.run_steps(3);
        self.events += 1;
    }

    /// The middle of what is seen.
    pub(super) fn middle(&self) -> Pos2 {
        self.harness.get_by_label("Viewport").rect().center()
    }

    pub(super) fn app(&self) -> &App {
        self.harness.state()
    }

    /// A material's tile among the presets, brought into view.
    pub(super) fn tile(&mut self, name: &str) -> Pos2 {
        self.harness.get_by_role_and_label(Role::Button, name).scroll_to_me();
        self.harness.run_steps(3);
        self.harness.get_by_role_and_label(Role::Button, name).rect().center()
    }

    /// What the page tells of the task must be what it took.
    pub(super) fn ends(mut self, task: &str) {
        settle(&mut self.harness);
        let root = crate::ROOT;
        let told = std::fs::read_to_string(format!("{root}/docs/WALK.md")).expect("the page");
        let row = told.lines().find(|line| line.starts_with(&format!("| {task} |")));
        let count = row.and_then(|row| row.split('|').nth(2)?.trim().parse::<u32>().ok());
        println!("{task}: {} in {:.1} s", self.events, self.begun.elapsed().as_secs_f64());
        assert_eq!(count, Some(self.events), "docs/WALK.md, {task}");
    }
}

#[test]
fn a_set_of_textures_is_put_on_the_material() {
    let mut walk = Walk::new(|_| {});
    let folder = walk._folder.path().join("oak");
    std::fs::create_dir(&folder).expect("a folder");
    let picture = image::RgbImage::from_pixel(4, 4, image::Rgb([120, 80, 40]));
    for name in ["oak_basecolor.png", "oak_rough.png"] {
        picture.save(folder.join(name)).expect("a picture");
    }
    drop_on(&mut walk.harness, &[folder]);
    walk.events += 1;
    wait(&mut walk.harness, "the textures", |app| {
        let own = &app.document().materials[0].user_textures;
        own.get(TextureTarget::BaseColor).is_some() && own.get(TextureTarget::Roughness).is_some()
    });
    walk.ends("Put a set of textures on a material");
}

#[test]
fn a_highlight_is_put_where_it_is_wanted() {
    let mut walk = Walk::new(|document| document.lighting.area_lights.push(AreaLight::default()));
    let before = walk.app().document().lighting.area_lights[0];
    let label = "Place highlight of area light 1";
    walk.harness.get_by_label(label).scroll_to_me();
    walk.harness.run_steps(3);
    walk.click(Role::Button, label);
    walk.click_at(walk.middle(), PointerButton::Primary);
    assert_ne!(walk.app().document().lighting.area_lights[0], before);
    walk.ends("Move a light so that its highlight sits on the handle");
}

#[test]
fn two_metals_are_compared() {
    let mut walk = Walk::new(|_| {});
    let gold = walk.tile("Gold");
    walk.click_at(gold, PointerButton::Primary);
    let copper = walk.tile("Copper");
    walk.click_at(copper, PointerButton::Secondary);
    walk.click(Role::Button, "Compare as B");
    wait(&mut walk.harness, "both", |app| {
        let rival = app.rival_snapshot().and_then(|rival| rival.picture.clone());
        rival.is_some_and(|picture| picture.document.materials[0].name == "Copper")
    });
    assert_eq!(walk.app().document().materials[0].name, "Gold");
    walk.ends("Compare two metals in one image");
}

#[test]
fn the_noisiest_pixel_is_found() {
    let mut walk = Walk::new(|_| {});
    walk.tab(Pane::Inspector);
    see(&mut walk.harness, "what is known of pixels", |harness| {
        let button = harness.query_by_label("Noisiest pixel");
        button.is_some_and(|button| !button.accesskit_node().is_disabled())
    });
    walk.click(Role::Button, "Noisiest pixel");
    assert!(walk.harness.query_by_label_contains("of 40 × 24").is_some());
    walk.ends("Find the noisiest pixel");
}

#[test]
fn direct_light_is_looked_at_alone() {
    let mut walk = Walk::new(|_| {});
    walk.click(Role::ComboBox, "Viewport shows");
    walk.click(Role::Button, LightPaths::Direct.label());
    assert_eq!(walk.app().document().render.light_paths, LightPaths::Direct);
    walk.ends("Look at the direct light alone");
}

#[test]
fn something_is_put_into_focus() {
    let mut walk = Walk::new(|_| {});
    walk.tab(Pane::Camera);
    walk.harness
        .get_by_role_and_label(Role::SpinButton, "Aperture")
        .scroll_to_me();
    walk.harness.run_steps(3);
    let aperture = walk.harness.get_by_role_and_label(Role::SpinButton, "Aperture").rect();
    drag(
        &mut walk.harness,
        aperture.left_center() + egui::vec2(8.0, 0.0),
        egui::vec2(60.0, 0.0),
    );
    walk.events += 1;
    assert!(walk.app().document().camera.aperture > 0.0);
    let middle = walk.middle();
    walk.harness.event(egui::Event::ModifiersChanged(Modifiers::COMMAND));
    super::ui_scene::click_at(&mut walk.harness, middle);
    walk.harness.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    walk.events += 1;
    assert!(walk.app().document().camera.focus_distance.is_some());
    walk.ends("Blur what is not at a place that is clicked");
}

#[test]
fn a_turn_becomes_a_video() {
    let mut walk = Walk::new(|_| {});
    walk.click(Role::Button, "Render");
    walk.click(Role::Button, "Render a turntable…");
    walk.harness.run_steps(2);
    walk.click(Role::Button, "Add to the queue");
    wait(&mut walk.harness, "the video", |app| {
        app.messages().iter().any(|text| text.contains("turntable.mp4"))
    });
    walk.ends("Render a turn as a video");
}

#[test]
fn the_cost_of_each_effect_is_measured() {
    let mut walk = Walk::new(|_| {});
    walk.click(Role::Button, "Render");
    walk.click(Role::Button, "Profile features");
    see(&mut walk.harness, "the ledger", |harness| {
        harness
            .query_by_label_contains("ms for one sample of every pixel")
            .is_some()
    });
    walk.ends("Learn what each effect costs in time");
}

#[test]
fn what_is_left_to_an_error_is_told() {
    let mut walk = Walk::new(|document| document.render.samples = 64);
    walk.tab(Pane::Convergence);
    see(&mut walk.harness, "what more would cost", |harness| {
        harness.query_by_label_contains("% in").is_some()
    });
    walk.ends("Learn how long it takes to an error of 1 %");
}

#[test]
fn another_lobe_is_seen_beside_with_its_look_matched() {
    let mut walk = Walk::new(|_| {});
    walk.key(Key::C);
    wait(&mut walk.harness, "B", |app| app.rms_difference().is_some());
    walk.ends("See the material with another lobe of the same look");
}
