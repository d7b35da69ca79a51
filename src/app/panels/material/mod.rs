//! The selected material: every parameter of the registry, in its group, with the widget that suits its kind, and with
//! its texture.

mod textures;

use std::cell::Cell;

use super::*;
use crate::{
    document::{MaterialSettings, PARAMETERS, Parameter, material::Conductor},
    kit::{keys, parameter_row, tile::Tile},
    optics::{fresnel::Fresnel, lobe::Lobe},
    services::selection::Thing,
    store::PRESETS,
};

/// Side of the ball before a slot's name, points.
const BALL: f32 = 26.0;
/// From how many slots on they can be searched.
const SEARCHED_FROM: usize = 7;
/// The slots that are seen at once: more are scrolled to, so that the parameters stay in sight.
const SLOTS_SHOWN: f32 = 6.0;

/// From how many parameters on a change is not one by hand, but another material.
const ANOTHER_FROM: usize = 3;
/// The groups that are always open.
const ALWAYS_OPEN: [&str; 2] = ["Base", "Specular"];

/// The parameters of the selected material.
#[derive(Default)]
pub struct MaterialPanel {
    /// What was shown last, of which slot of which model.
    shown: Option<((usize, usize), MaterialSettings)>,
    /// What is searched for among the model's materials.
    search: String,
}

impl MaterialPanel {
    /// Whether another material is shown than in the last frame.
    fn is_another(&mut self, desk: &Desk, material: &MaterialSettings) -> bool {
        let model = desk.scene().map_or(0, |scene| Arc::as_ptr(&scene.model) as usize);
        let slot = (desk.shared.selection.slot, model);
        let is_another = match &self.shown {
            Some((last, before)) if *last == slot => {
                let is_changed = |parameter: &&Parameter| parameter.get(before) != parameter.get(material);
                before != material && PARAMETERS.iter().filter(is_changed).count() >= ANOTHER_FROM
            }
            _ => true,
        };
        if is_another || self.shown.as_ref().is_none_or(|(_, before)| before != material) {
            self.shown = Some((slot, material.clone()));
        }
        is_another
    }
}

/// Whether a parameter is left to *Measure*: the paper's horizon, as long as it is what it is at first.
fn is_for_measuring(parameter: &Parameter, material: &MaterialSettings, measures: bool) -> bool {
    !measures && parameter.key == "specular.horizon" && parameter.get(material) == parameter.default_value()
}

/// Whether a group says nothing of the material: all of it is as it is at first.
fn is_at_default(desk: &Desk, group: &str, material: &MaterialSettings) -> bool {
    let is_other = |parameter: &Parameter| parameter.get(material) != parameter.default_value();
    let has_texture = textures::of_group(group).any(|target| textures::is_there(desk, target));
    let mut of_group = PARAMETERS.iter().filter(|parameter| parameter.group == group);
    !has_texture && !of_group.any(is_other)
}

impl Panel for MaterialPanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk) {
        let search = &mut self.search;
        widgets::comes_and_goes(ui, |ui| slots(ui, desk, search));
        let before = desk.material();
        let is_another = self.is_another(desk, &before);
        let mut material = before.clone();
        name(ui, desk, &mut material);
        ui.add_space(theme::GAP);
        let mut groups: Vec<&'static str> = PARAMETERS.iter().map(|parameter| parameter.group).collect();
        groups.dedup();
        let measures = desk.shared.viewing.measures;
        // The switches of textures stand beside their images.
        let is_shown = |parameter: &&Parameter| {
            !parameter.key.ends_with("_texture")
                && (parameter.applies)(&before)
                && !is_for_measuring(parameter, &before, measures)
        };
        for group in groups {
            let parameters = || PARAMETERS.iter().filter(|parameter| parameter.group == group);
            // What says nothing is folded whenever another material is shown; the user opens it for as long.
            let opens = ALWAYS_OPEN.contains(&group) || (is_another && !is_at_default(desk, group, &before));
            let mut rows = |ui: &mut Ui| {
                for parameter in parameters() {
                    widgets::comes_and_goes(ui, |ui| {
                        if is_shown(&parameter) {
                            show_parameter(ui, desk, parameter, &mut material);
                        }
                    });
                    if parameter.key == "specular.conductor" {
                        widgets::comes_and_goes(ui, |ui| metal(ui, desk, &mut material));
                    }
                    if let Some(target) = textures::target_of(parameter.key) {
                        widgets::comes_and_goes(ui, |ui| textures::show(ui, desk, target, &mut material));
                    }
                }
            };
            widgets::comes_and_goes(ui, |ui| {
                if parameters().any(|parameter| is_shown(&parameter)) {
                    widgets::group_open(ui, group, is_another.then_some(opens), &mut rows);
                }
            });
        }
        if material != before {
            desk.set_material(material);
        }
    }
}

/// The model's slots, where there is a choice.
fn slots(ui: &mut Ui, desk: &mut Desk, search: &mut String) {
    // They are not known while the model is being loaded.
    let Some(model) = desk.scene().map(|scene| scene.model.clone()) else {
        return;
    };
    let count = model.slots.len();
    if desk.shared.selection.slot >= count.max(1) {
        desk.shared.selection.slot = 0;
    }
    if count < 2 {
        return;
    }
    widgets::group(ui, "Materials of the model", |ui| {
        let materials: Vec<MaterialSettings> = (0..count).map(|slot| desk.document.material(slot)).collect();
        let is_in_flow = desk.edits.is_in_flow();
        let balls = desk.shared.pictures.of_document(&materials, is_in_flow);
        if count >= SEARCHED_FROM {
            keys::search_field(ui, search, "Search", "Search materials of the model");
        }
        let wanted = search.to_lowercase();
        let height = SLOTS_SHOWN * (BALL + 4.0 + ui.spacing().item_spacing.y);
        ScrollArea::vertical().max_height(height).show(ui, |ui| {
            for (slot, (material, ball)) in materials.iter().zip(&balls).enumerate() {
                let name = &model.slots[slot].name;
                let is_wanted = |text: &str| text.to_lowercase().contains(&wanted);
                if is_wanted(name) || is_wanted(&material.name) {
                    ui.push_id(slot, |ui| slot_entry(ui, desk, (slot, name), material, ball.as_ref()));
                }
            }
        });
        let chosen = desk.shared.selection.slots().len();
        if chosen > 1 {
            widgets::note(ui, format!("{chosen} materials are edited together."));
        }
    });
}

/// A material by its ball and name; behind it what its surface is called in the model, where that is something else.
fn slot_entry(
    ui: &mut Ui,
    desk: &mut Desk,
    (slot, name): (usize, &str),
    material: &MaterialSettings,
    ball: Option<&TextureHandle>,
) {
    let label = match (material.name.as_str(), name) {
        (own, of_model) if own == of_model || of_model.is_empty() => own.to_owned(),
        ("", of_model) => of_model.to_owned(),
        (own, of_model) => format!("{own}  ({of_model})"),
    };
    let is_selected = slot == desk.shared.selection.slot;
    let row = Tile {
        name: &label,
        full_name: &format!("Slot {}: {label}", slot + 1),
        picture: ball,
        size: Vec2::splat(BALL),
        color: widgets::shown(material.base_color),
        is_current: desk.shared.selection.slots().contains(&slot),
    };
    let item = row.row(ui);
    desk.light_up(ui, &item, Thing::Slot(slot));
    item.dnd_set_drag_payload(material.clone());
    if let Some(dropped) = item.dnd_release_payload() {
        desk.drop_on(slot, &dropped);
    }
    item.context_menu(|ui| {
        for command in [Command::CopyMaterial, Command::PasteMaterial, Command::FrameSelected] {
            let is_possible = command != Command::PasteMaterial || desk.shared.selection.copied.is_some();
            if widgets::pressed_if(ui, is_possible, command.label(), command.help(), "") {
                desk.shared.selection.objects.clear();
                desk.actions.push(Action::SelectSlot(slot));
                desk.act(command);
                ui.close();
            }
        }
    });
    // Where a click in the viewport selected it.
    let shown = Id::unique("slot in sight");
    if is_selected && ui.memory(|memory| memory.data.get_temp::<usize>(shown)) != Some(slot) {
        item.scroll_to_me(None);
        ui.memory_mut(|memory| memory.data.insert_temp(shown, slot));
    }
    if !item.on_hover_text(label).clicked() {
    } else if widgets::is_beside_others(ui) && slot != desk.shared.selection.slot {
        desk.shared.selection.choose_also(slot);
    } else {
        desk.shared.selection.objects.clear();
        desk.actions.push(Action::SelectSlot(slot));
    }
}

/// The other way to say which metal it is: two colours in place of η and k, or those of a measured metal.
fn metal(ui: &mut Ui, desk: &mut Desk, material: &mut MaterialSettings) {
    if material.metalness < 1.0 {
        return;
    }
    if material.fresnel == Fresnel::Conductor {
        let help = "The same metal by two colours, seen head-on and towards the edge, to pick as you like.";
        if widgets::pressed(ui, "Edit as colours", help) {
            *material = material.by_colors();
            desk.edits.did("Edit the metal as colours");
        }
        return;
    }
    let menu = ui.menu_button("Measured metal…", |ui| {
        for conductor in Conductor::all().filter(|conductor| *conductor != Conductor::Custom) {
            if widgets::entry(ui, conductor.name(), "") {
                *material = material.by_measured(conductor);
                desk.edits.did(format!("Use measured {}", conductor.name()));
            }
        }
    });
    menu.response
        .on_hover_text("Replaces the colours by a metal's measured η and k.");
}

fn name(ui: &mut Ui, desk: &mut Desk, material: &mut MaterialSettings) {
    ui.horizontal(|ui| {
        let width = ui.available_width() - theme::ROW_HEIGHT - ui.spacing().item_spacing.x;
        let field = TextEdit::singleline(&mut material.name)
            .desired_width(width)
            .margin(vec2(6.0, 3.0));
        if ui.add(field).accessible_name("Material name").changed() {
            desk.edits.note("Rename material", "material name");
        }
        let more = icons::button(ui, Icon::More, "Material menu", "Open, save, reset");
        Popup::menu(&more).show(|ui| {
            use Command::{Open, ResetMaterial, SaveMaterial, SaveToMyPresets};
            for command in [Open, SaveMaterial, SaveToMyPresets, ResetMaterial] {
                desk.button(ui, command);
            }
        });
    });
}

/// The lobe, without those of older papers: *Measure* has all of them.
fn lobe(ui: &mut Ui, parameter: &Parameter, material: &mut MaterialSettings) -> bool {
    let older = [Lobe::GgxNdf, Lobe::Ggx2018, Lobe::BlinnPhong, Lobe::Lambert];
    let mut choices = widgets::choices::<Lobe>();
    choices.retain(|(lobe, ..)| *lobe == material.lobe || !older.contains(lobe));
    let full = parameter.full_name();
    let (name, default) = (
        [&*full, parameter.label, parameter.help],
        MaterialSettings::default().lobe,
    );
    widgets::value_row(ui, name, &mut material.lobe, default, |ui, lobe| {
        widgets::choice(ui, &full, lobe, &choices)
    })
}

/// The row of a parameter.
fn show_parameter(ui: &mut Ui, desk: &mut Desk, parameter: &Parameter, material: &mut MaterialSettings) {
    let idle = (parameter.idle)(material);
    let [pressed, pointed] = [Cell::new(false), Cell::new(false)];
    let target = textures::target_of(parameter.key);
    // A texture that is there has a row of its own; its parameter's control stays the one that it is.
    let empty = target.filter(|target| !textures::is_there(desk, *target));
    let mut slot = |ui: &mut Ui| {
        if let Some(target) = empty {
            let response = textures::empty_slot(ui, target);
            pressed.set(response.clicked());
            pointed.set(response.contains_pointer());
        }
    };
    let measures = desk.shared.viewing.measures;
    let row = ui.add_enabled_ui(idle.is_none(), |ui| {
        if parameter.key == "specular.lobe" && !measures {
            return lobe(ui, parameter, material);
        }
        let beside = target.is_some().then_some(&mut slot as &mut dyn FnMut(&mut Ui));
        let preset = PRESETS.iter().find(|preset| preset.name == material.name);
        let default = preset.map_or_else(|| parameter.default_value(), |preset| parameter.get(preset));
        parameter_row::edit_from(ui, parameter, &parameter.full_name(), material, (default, beside))
    });
    if pressed.get() {
        desk.actions.extend(empty.map(Action::ChooseTexture));
    }
    if pointed.get() {
        desk.shared.selection.texture = empty;
    }
    widgets::explained(row.response, idle.unwrap_or_default());
    if row.inner {
        let key = format!("{}/{}", desk.shared.selection.slot, parameter.key);
        desk.edits.note(parameter.full_name(), key);
    }
}
