//! The selected material: every parameter of the registry, in its group, with the widget that suits its kind.

use std::sync::Arc;

use egui::Ui;

use super::Panel;
use crate::app::actions::{Action, Command};
use crate::app::desk::Desk;
use crate::app::kit::icons::{self, Icon};
use crate::app::kit::widgets;
use crate::app::kit::{parameter_row, theme};
use crate::document::{Kind, MaterialSettings, PARAMETERS, Parameter};
use crate::scene::{AlphaMode, Model, Texture};

/// The slots that are seen at once: more are scrolled to, so that the parameters stay in sight.
const SLOTS_SHOWN: f32 = 6.0;

/// The parameters of the selected material.
#[derive(Default)]
pub(super) struct MaterialPanel;

impl Panel for MaterialPanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        widgets::comes_and_goes(ui, |ui| slots(ui, desk));
        let before = desk.material();
        let mut material = before.clone();
        name(ui, desk, &mut material);
        ui.add_space(theme::GAP);
        let mut groups: Vec<&'static str> = Vec::new();
        let textures = textures(desk);
        let is_shown = |parameter: &&Parameter| match parameter.kind {
            // A texture's switch stands beside its picture, where the model has one.
            Kind::Toggle => textures.iter().any(|(key, _)| *key == parameter.key),
            _ => (parameter.applies)(&before),
        };
        for parameter in PARAMETERS.iter() {
            if !groups.contains(&parameter.group) {
                groups.push(parameter.group);
            }
        }
        for group in groups {
            let parameters = || PARAMETERS.iter().filter(|parameter| parameter.group == group);
            let mut rows = |ui: &mut Ui| {
                for parameter in parameters() {
                    widgets::comes_and_goes(ui, |ui| {
                        if is_shown(&parameter) {
                            let picture = textures.iter().find(|(key, _)| *key == parameter.key);
                            let picture = picture.map(|(_, picture)| picture.as_ref());
                            show_parameter(ui, desk, parameter, picture, &mut material);
                        }
                    });
                }
            };
            // A group of textures comes with the model's pictures, above others that stay.
            widgets::comes_and_goes(ui, |ui| {
                if parameters().any(|parameter| is_shown(&parameter)) {
                    widgets::group(ui, group, &mut rows);
                }
            });
        }
        if material != before {
            desk.set_material(material);
        }
    }
}

/// The model's slots, where there is a choice.
fn slots(ui: &mut Ui, desk: &mut Desk<'_>) {
    // While a model is loaded nobody knows how many it has.
    let Some(count) = desk.scene().map(|scene| scene.model.slots.len()) else {
        return;
    };
    if desk.shared.slot >= count.max(1) {
        desk.shared.slot = 0;
    }
    if count < 2 {
        return;
    }
    widgets::group(ui, "Slots", |ui| {
        let names: Vec<String> = desk
            .scene()
            .map(|scene| scene.model.slots.iter().map(|slot| slot.name.clone()).collect())
            .unwrap_or_default();
        let height = SLOTS_SHOWN * (theme::ROW_HEIGHT + ui.spacing().item_spacing.y);
        egui::ScrollArea::vertical().max_height(height).show(ui, |ui| {
            for (slot, name) in names.iter().enumerate() {
                slot_entry(ui, desk, slot, name);
            }
        });
    });
}

fn slot_entry(ui: &mut Ui, desk: &mut Desk<'_>, slot: usize, name: &str) {
    let label = if name.is_empty() {
        format!("slot {}", slot + 1)
    } else {
        name.to_owned()
    };
    let is_selected = slot == desk.shared.slot;
    let size = egui::vec2(ui.available_width(), theme::ROW_HEIGHT);
    let button = egui::Button::selectable(is_selected, label.as_str()).truncate();
    let item = ui.add_sized(size, button.min_size(size));
    // Where a click in the viewport selected it.
    let shown = egui::Id::unique("slot in sight");
    if is_selected && ui.memory(|memory| memory.data.get_temp::<usize>(shown)) != Some(slot) {
        item.scroll_to_me(None);
        ui.memory_mut(|memory| memory.data.insert_temp(shown, slot));
    }
    if item.on_hover_text(label).clicked() {
        desk.actions.push(Action::SelectSlot(slot));
    }
}

fn name(ui: &mut Ui, desk: &mut Desk<'_>, material: &mut MaterialSettings) {
    ui.horizontal(|ui| {
        let width = ui.available_width() - theme::ROW_HEIGHT - ui.spacing().item_spacing.x;
        let field = egui::TextEdit::singleline(&mut material.name)
            .desired_width(width)
            .margin(egui::vec2(6.0, 3.0));
        if ui.add(field).accessible_name("Material name").changed() {
            desk.edits.note("Rename material", "material name");
        }
        let more = icons::button(ui, Icon::More, "Material menu", "Open, save, reset");
        egui::Popup::menu(&more).show(|ui| {
            for command in [Command::OpenMaterial, Command::SaveMaterial, Command::ResetMaterial] {
                if ui.button(command.label()).on_hover_text(command.help()).clicked() {
                    desk.act(command);
                }
            }
        });
    });
}

/// The pictures of the selected slot, by the keys of the parameters that switch them.
fn textures(desk: &Desk<'_>) -> Vec<(&'static str, Arc<SlotPicture>)> {
    let Some(scene) = desk.scene() else { return Vec::new() };
    let Some(slot) = scene.model.slots.get(desk.shared.slot) else {
        return Vec::new();
    };
    let opacity = slot.base_color_texture.filter(|_| slot.alpha_mode != AlphaMode::Opaque);
    let kinds = [
        ("base.color_texture", slot.base_color_texture),
        ("specular.roughness_texture", slot.metallic_roughness_texture),
        ("emission.color_texture", slot.emissive_texture),
        ("geometry.opacity_texture", opacity),
        ("geometry.normal_texture", slot.normal_texture),
    ];
    let found = kinds.into_iter().filter_map(|(key, reference)| {
        let picture = Arc::new(SlotPicture {
            model: scene.model.clone(),
            texture: reference?.texture,
        });
        Some((key, picture))
    });
    found.collect()
}

/// A picture of a model.
struct SlotPicture {
    model: Arc<Model>,
    texture: usize,
}

impl SlotPicture {
    /// Its name, size and a small copy, which is made once for each model.
    fn show(&self, ui: &mut Ui) {
        let picture = &self.model.textures[self.texture];
        let id = egui::Id::unique(("texture", Arc::as_ptr(&self.model) as usize, self.texture));
        let known = ui.memory(|memory| memory.data.get_temp::<egui::TextureHandle>(id));
        let handle = known.unwrap_or_else(|| {
            let handle = ui
                .ctx()
                .load_texture(&picture.name, small_copy(picture), egui::TextureOptions::LINEAR);
            ui.memory_mut(|memory| memory.data.insert_temp(id, handle.clone()));
            handle
        });
        let side = egui::Vec2::splat(theme::ROW_HEIGHT - 2.0);
        let about = format!("{}\n{} × {}", picture.name, picture.width, picture.height);
        ui.add(egui::Image::new((handle.id(), side)).alt_text(&picture.name))
            .on_hover_text(&about);
        ui.add(egui::Label::new(&picture.name).truncate()).on_hover_text(about);
    }
}

/// Most texels to a side of the small copy that is shown.
const SMALL_SIDE: u32 = 64;

/// A picture reduced to at most [`SMALL_SIDE`] texels a side, by the nearest texel.
fn small_copy(picture: &Texture) -> egui::ColorImage {
    let [width, height] = [picture.width, picture.height].map(|side| side.clamp(1, SMALL_SIDE));
    let pixels = (0..width * height).map(|i| {
        let (x, y) = (i % width * picture.width / width, i / width * picture.height / height);
        let place = 4 * (y * picture.width + x) as usize;
        match picture.rgba8.get(place..place + 3) {
            Some(&[r, g, b]) => egui::Color32::from_rgb(r, g, b),
            _ => egui::Color32::BLACK,
        }
    });
    egui::ColorImage::new([width as usize, height as usize], pixels.collect())
}

/// The row of a parameter, with the picture that its switch stands for.
fn show_parameter(
    ui: &mut Ui,
    desk: &mut Desk<'_>,
    parameter: &Parameter,
    picture: Option<&SlotPicture>,
    material: &mut MaterialSettings,
) {
    let mut value = parameter.get(material);
    let idle = (parameter.idle)(material);
    let row = ui.add_enabled_ui(idle.is_none(), |ui| {
        parameter_row::show(ui, parameter, &mut value, |ui| {
            if let Some(picture) = picture {
                picture.show(ui);
            }
        })
    });
    if let Some(why) = idle {
        row.response.on_hover_text(why);
    }
    let is_other = row.inner;
    if is_other && parameter.set(material, value).is_ok() {
        let key = format!("{}/{}", desk.shared.slot, parameter.key);
        desk.edits.note(parameter.full_name(), key);
    }
}
