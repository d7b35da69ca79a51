//! Eight more tasks of docs/WALK.md: what an artist does in the first minutes.

use egui::accesskit::Role;
use egui::{Key, Modifiers, PointerButton};
use egui_kittest::kittest::Queryable as _;
use glossmith::app::layout::Pane;
use glossmith::document::AreaLight;
use glossmith::optics::fresnel::Fresnel;
use glossmith::scene::camera::Projection;
use glossmith::scene::texture::TextureTarget;

use super::ui::{see_label, wait};
use super::ui_files::drop_on;
use super::walk::Walk;

impl Walk {
    /// Clicks a control, once it is scrolled into sight, which takes a while for what is far away.
    fn press(&mut self, role: Role, label: &str) {
        self.harness.get_by_role_and_label(role, label).scroll_to_me();
        self.harness.run_steps(40);
        self.click(role, label);
    }

    /// Types into what has the keys.
    fn types(&mut self, text: &str) {
        self.harness.event(egui::Event::Text(text.to_owned()));
        self.harness.run_steps(3);
        self.events += 1;
    }

    /// Types a path into the field that asks for one.
    fn path(&mut self, path: &std::path::Path) {
        see_label(&mut self.harness, "Path");
        let field = self.harness.get_by_role_and_label(Role::TextInput, "Path");
        field.set_text_value_accesskit(&path.display().to_string());
        self.harness.run_steps(2);
        self.events += 1;
    }

    fn image(&self, name: &str) -> std::path::PathBuf {
        let path = self._folder.path().join(name);
        let image = image::RgbImage::from_pixel(8, 6, image::Rgb([120, 80, 40]));
        image.save(&path).expect("an image");
        path
    }
}

#[test]
fn a_material_is_found_by_its_look() {
    let mut walk = Walk::new(|_| {});
    walk.harness.key_press_modifiers(Modifiers::COMMAND, Key::K);
    walk.harness.run_steps(3);
    walk.events += 1;
    walk.types("red cloth");
    walk.key(Key::Enter);
    assert_eq!(walk.app().document().materials[0].name, "Velvet burgundy");
    walk.ends("Find a red cloth and put it on");
}

#[test]
fn a_measured_metal_becomes_two_colours() {
    let mut walk = Walk::new(|_| {});
    let gold = walk.tile("Gold");
    walk.click_at(gold, PointerButton::Primary);
    walk.press(Role::Button, "Edit as colours");
    assert_eq!(walk.app().document().materials[0].fresnel, Fresnel::Schlick);
    walk.ends("Take measured gold and edit it by two colours");
}

#[test]
fn a_map_is_put_beside_its_parameter() {
    let mut walk = Walk::new(|_| {});
    let file = walk.image("any.png");
    let square = walk
        .harness
        .get_by_role_and_label(Role::Button, "Texture of the roughness");
    let at = square.rect().center();
    walk.harness.hover_at(at);
    walk.harness.run_steps(2);
    drop_on(&mut walk.harness, &[file]);
    walk.events += 1;
    wait(&mut walk.harness, "the texture", |app| {
        let own = &app.document().materials[0].user_textures;
        own.get(TextureTarget::Roughness).is_some()
    });
    walk.ends("Put an image on the roughness");
}

#[test]
fn the_model_is_seen_from_the_side_in_parallel_rays() {
    let mut walk = Walk::new(|_| {});
    walk.key(Key::Num3);
    assert_eq!(walk.app().document().camera.projection, Projection::Orthographic);
    walk.ends("Look from the side in parallel rays");
}

#[test]
fn a_light_is_hidden() {
    let mut walk = Walk::new(|document| document.lighting.area_lights.push(AreaLight::default()));
    walk.tab(Pane::Lighting);
    walk.press(Role::CheckBox, "Area light 1 hidden");
    assert!(walk.app().document().lighting.area_lights[0].is_hidden);
    walk.ends("Hide a light from the camera");
}

#[test]
fn a_reference_is_laid_over_the_render() {
    let mut walk = Walk::new(|_| {});
    let file = walk.image("photo.png");
    walk.tab(Pane::Camera);
    walk.press(Role::Button, "Reference image");
    walk.path(&file);
    walk.press(Role::Button, "Open");
    wait(&mut walk.harness, "the reference", |app| {
        app.document().view.reference.is_some()
    });
    walk.ends("Lay a photo over the render");
}

#[test]
fn the_error_is_looked_at() {
    let mut walk = Walk::new(|_| {});
    walk.tab(Pane::Convergence);
    assert!(walk.harness.query_by_label("Manual: Convergence").is_some());
    walk.ends("See what the error is, and what less would cost");
}

#[test]
fn the_image_is_saved() {
    let mut walk = Walk::new(|_| {});
    walk.harness.key_press_modifiers(Modifiers::COMMAND, Key::E);
    walk.harness.run_steps(3);
    walk.events += 1;
    let file = walk._folder.path().join("saved.png");
    walk.path(&file);
    walk.press(Role::Button, "Save");
    wait(&mut walk.harness, "the file", |_| file.exists());
    walk.ends("Save the image with its document inside");
}
