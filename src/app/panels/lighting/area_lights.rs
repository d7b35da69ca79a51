//! The list of area lights, and a row for each of their parameters.

use egui::{Button, Ui};

use crate::app::actions::Action;
use crate::app::desk::Desk;
use crate::app::kit::icons::{self, Icon};
use crate::app::kit::parameter_row;
use crate::app::kit::widgets::{self, Name, NumberStyle, RowResponse};
use crate::app::lights::{View, put_in_view};
use crate::app::services::viewing::Pick;
use crate::document::{AreaLight, GroupName, LIGHT_PARAMETERS, Parameter, range};
use crate::optics::blackbody::{TEMPERATURES_K, blackbody_color, temperature_of_color};

/// What the buttons beside a light's name ask for.
enum Asked {
    Remove,
    Solo,
}

/// A light that can be added: what the button says and is called, what it adds, and help.
type LightKind = (&'static str, &'static str, fn() -> AreaLight, &'static str);

const KINDS: [LightKind; 3] = [
    (
        "Area light",
        "Add area light",
        AreaLight::default,
        "A rectangle that shines on the model.",
    ),
    (
        "Spot",
        "Add spot",
        AreaLight::spot,
        "A small disc that shines into a cone.",
    ),
    (
        "Sun",
        "Add sun",
        AreaLight::sun,
        "A disc so far away that its light is parallel.",
    ),
];

pub fn show(ui: &mut Ui, desk: &mut Desk<'_>) {
    desk.shared.selection.shows_lights = true;
    let mut lights = desk.document.lighting.area_lights.clone();
    let soloed = soloed(&lights);
    // Of several the chosen one has its rows: all together would be a scroll of a metre.
    let is_alone = lights.len() == 1;
    let mut asked = None;
    for (index, light) in lights.iter_mut().enumerate() {
        let title = format!("Area light {}", index + 1);
        let now = header(ui, desk, index, &title, light, soloed == Some(index));
        asked = now.map(|now| (now, index)).or(asked);
        let is_open = is_alone || desk.shared.selection.light == Some(index);
        widgets::comes_and_goes(ui, |ui| {
            if is_open {
                rows(ui, desk, (&title, index), light);
                let help = "Click the model to put the highlight there.";
                let pick = desk.pick_toggle(ui, Pick::Highlight(index), "Place highlight", help);
                pick.accessible_name(format!("Place highlight of {}", title.to_lowercase()));
            }
        });
    }
    match asked {
        Some((Asked::Solo, index)) => {
            let is_over = soloed == Some(index);
            for (other, light) in lights.iter_mut().enumerate() {
                light.is_muted = !is_over && other != index;
            }
            desk.edits.note("Solo area light", "");
        }
        Some((Asked::Remove, index)) => {
            lights.remove(index);
            // What another light was to be picked for would become its neighbour's.
            desk.shared.viewing.picks = None;
            desk.shared.selection.light = None;
            desk.edits.note("Remove area light", "");
        }
        None => {}
    }
    add(ui, desk, &mut lights);
    desk.document.lighting.area_lights = lights;
    desk.settings(ui, "Area lights");
}

/// Buttons that add a light, which is then the chosen one.
fn add(ui: &mut Ui, desk: &mut Desk<'_>, lights: &mut Vec<AreaLight>) {
    let is_full = lights.len() as f64 >= *range::AREA_LIGHTS.end();
    ui.add_enabled_ui(!is_full, |ui| {
        ui.horizontal(|ui| {
            for (word, name, made, help) in KINDS {
                let button = ui.button(format!("+ {word}")).on_hover_text(help);
                if button.clicked() && !is_full {
                    lights.push(in_view(desk, made(), lights.len()));
                    desk.shared.selection.light = Some(lights.len() - 1);
                    desk.edits.note(name, "");
                }
                button.accessible_name(name);
            }
        });
    });
}

/// Width and height of a new light that is in the image, bounding radii.
const SIDE_IN_VIEW: f64 = 0.4;

/// A new light where it is seen; a sun stays where it is.
fn in_view(desk: &Desk<'_>, mut light: AreaLight, number: usize) -> AreaLight {
    if let Some(scene) = desk.scene().filter(|_| !light.is_sun()) {
        let view = View {
            camera: scene.job.settings.camera,
            size: glam::DVec2::ONE,
        };
        put_in_view(&mut light, &view, number);
        if !light.is_spot() {
            (light.width, light.height) = (SIDE_IN_VIEW, SIDE_IN_VIEW);
        }
    }
    light
}

/// The only one of several lights that shines.
fn soloed(lights: &[AreaLight]) -> Option<usize> {
    let mut shining = (0..lights.len()).filter(|&index| !lights[index].is_muted);
    match (shining.next(), shining.next()) {
        (Some(index), None) if lights.len() > 1 => Some(index),
        _ => None,
    }
}

fn header(
    ui: &mut Ui,
    desk: &mut Desk<'_>,
    index: usize,
    title: &str,
    light: &mut AreaLight,
    is_soloed: bool,
) -> Option<Asked> {
    let of_light = title.to_lowercase();
    let button = |ui: &mut Ui, word: &str, is_on: bool, help: &str| {
        let button = ui.add(Button::new(word).selected(is_on)).on_hover_text(help);
        button.accessible_name(format!("{word} {of_light}")).clicked()
    };
    let mut asked = None;
    ui.horizontal(|ui| {
        let chosen = &mut desk.shared.selection.light;
        let is_chosen = *chosen == Some(index);
        let name = ui.selectable_label(is_chosen, egui::RichText::new(title).strong());
        let name = name.on_hover_text("Shows its rows here and its handles in the viewport.");
        if name.clicked() {
            *chosen = (!is_chosen).then_some(index);
        }
        name.accessible_name(format!("Choose {of_light}"));
        widgets::at_right(ui, |ui| {
            let name = format!("Remove {}", title.to_lowercase());
            if icons::button(ui, Icon::Close, &name, "Remove this light").clicked() {
                asked = Some(Asked::Remove);
            }
            if button(
                ui,
                "Solo",
                is_soloed,
                "Mutes all other area lights; again: lets all shine.",
            ) {
                asked = Some(Asked::Solo);
            }
            let help = "Mute: light off and hidden.";
            if button(ui, "Mute", light.is_muted, help) {
                light.is_muted = !light.is_muted;
                desk.edits.note("Mute area light", "");
            }
        });
    });
    asked
}

fn rows(ui: &mut Ui, desk: &mut Desk<'_>, (title, index): (&str, usize), light: &mut AreaLight) {
    for parameter in LIGHT_PARAMETERS.iter() {
        widgets::comes_and_goes(ui, |ui| parameter_of(ui, desk, title, parameter, light));
        if parameter.word() == "color" {
            temperature(ui, desk, title, light);
        }
    }
    widgets::comes_and_goes(ui, |ui| power(ui, desk, title, light));
    widgets::comes_and_goes(ui, |ui| profile(ui, desk, (title, index), light));
    widgets::comes_and_goes(ui, |ui| group(ui, desk, title, light));
}

/// The file of a sphere's intensities by direction.
fn profile(ui: &mut Ui, desk: &mut Desk<'_>, (title, index): (&str, usize), light: &mut AreaLight) {
    if !light.is_sphere() {
        return;
    }
    let full = format!("{title} profile");
    let help = "Sends the power of the light as a measured lamp does, by an .ies file.";
    let name = Name::new(&full, "Profile", help);
    let file = light.profile.map(|file| file.path());
    let remove = format!("Remove {}", full.to_lowercase());
    let remove = (remove.as_str(), "Shines evenly again");
    if desk.file_row(ui, name, file, Action::ChooseProfile(index), remove) {
        light.profile = None;
        desk.edits.note("Remove the light profile", "");
    }
}

/// The name of its light group, while groups are summed apart.
fn group(ui: &mut Ui, desk: &mut Desk<'_>, title: &str, light: &mut AreaLight) {
    if !desk.document.lighting.light_groups {
        return;
    }
    let full = format!("{title} group");
    let help = "Lights of the same group share a factor and a layer.";
    let by_kind = AreaLight {
        group: GroupName::default(),
        ..*light
    };
    let mut text = light.group.to_string();
    let response = widgets::row(ui, Name::new(&full, "Group", help), |ui| {
        let field = egui::TextEdit::singleline(&mut text).hint_text(by_kind.group_name().to_string());
        ui.add(field.desired_width(f32::INFINITY))
    });
    if response.changed {
        light.group = GroupName::new(&text);
    }
    edited(desk, response, full, &mut light.group, GroupName::default());
}

/// The row of a parameter, where it has an effect on a light of this shape.
fn parameter_of(
    ui: &mut Ui,
    desk: &mut Desk<'_>,
    title: &str,
    parameter: &Parameter<AreaLight>,
    light: &mut AreaLight,
) {
    if (parameter.idle)(light).is_some() {
        return;
    }
    let full = format!("{title} {}", parameter.label.to_lowercase());
    let mut value = parameter.get(light);
    if parameter_row::show_as(ui, parameter, &full, &mut value) && parameter.set(light, value).is_ok() {
        desk.edits.note(full.clone(), full);
    }
}

/// The colour as that of a lamp or a sky.
fn temperature(ui: &mut Ui, desk: &mut Desk<'_>, title: &str, light: &mut AreaLight) {
    let [coldest, hottest] = TEMPERATURES_K;
    let style = NumberStyle::plain(coldest..=hottest, " K", 20.0, 0).with_bar([coldest, 10000.0]);
    let full = format!("{title} temperature");
    let help = "Gives the light the colour of a body that shines at this temperature: 2700 K a light bulb, 5600 K the sun, \
                10000 K a blue sky.";
    let mut temperature_k = temperature_of_color(light.color.map(f64::from));
    let name = Name::new(&full, "Temperature", help);
    let response = widgets::row(ui, name, |ui| widgets::number(ui, &mut temperature_k, &style));
    if response.changed {
        light.color = blackbody_color(temperature_k).map(|x| x as f32);
    }
    edited(desk, response, full, &mut light.color, AreaLight::default().color);
}

/// The strength as a lamp's packet or a light meter says it, once the size of the model is known.
fn power(ui: &mut Ui, desk: &mut Desk<'_>, title: &str, light: &mut AreaLight) {
    let unit_m = desk.document.unit_m;
    let Some(radius) = desk.scene().map(|scene| scene.job.geometry.world_units_per_unit) else {
        return;
    };
    let radius_m = radius * unit_m;
    let (label, unit, help) = if light.is_sun() {
        (
            "Illuminance",
            " lx",
            "Of what faces the sun, where a radiance of 1 is 1 cd/m². Sets the strength.",
        )
    } else {
        (
            "Power",
            " lm",
            "Luminous flux, where a radiance of 1 is 1 cd/m² and the model as large as the scene unit says; 683 lm are 1 W. \
             Sets the strength.",
        )
    };
    let of_black = AreaLight {
        strength: 1.0,
        ..*light
    }
    .power(radius_m)
        <= 0.0;
    let full = format!("{title} power");
    let row = ui.add_enabled_ui(!of_black, |ui| {
        let mut power = light.power(radius_m);
        let style = NumberStyle::plain(0.0..=f64::MAX, unit, (0.01 * power).max(1e-3), 2);
        let response = widgets::row(ui, Name::new(&full, label, help), |ui| {
            widgets::number(ui, &mut power, &style)
        });
        (response, power)
    });
    let (response, power) = row.inner;
    if response.changed {
        light.set_power(power, radius_m);
    }
    edited(desk, response, full, &mut light.strength, AreaLight::default().strength);
}

/// Notes an edit, and resets where that was asked for.
fn edited<T>(desk: &mut Desk<'_>, response: RowResponse, name: String, value: &mut T, default: T) {
    if response.reset {
        *value = default;
    }
    if response.changed || response.reset {
        desk.edits.note(name.clone(), name);
    }
}
