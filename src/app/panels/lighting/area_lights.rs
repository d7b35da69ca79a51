//! The list of area lights, and a row for each of their parameters.

use super::*;
use crate::{
    document::{AreaLight, GroupName, LIGHT_PARAMETERS, range},
    kit::parameter_row,
    lights::{View, put_in_view},
    optics::blackbody::{TEMPERATURES_K, blackbody_color, temperature_of_color},
    services::viewing::Pick,
};

/// What the buttons beside a light's name ask for.
enum Asked {
    Remove,
    Solo,
}

/// A light that can be added: what the button says, what it adds, and help.
type LightKind = (&'static str, fn() -> AreaLight, &'static str);

#[rustfmt::skip]
const KINDS: [LightKind; 3] = [
    ("Area light", AreaLight::default, "A rectangle that shines on the model."),
    ("Spot", AreaLight::spot, "A small disc that shines into a cone."),
    ("Sun", AreaLight::sun, "A disc so far away that its light is parallel."),
];

pub fn show(ui: &mut Ui, desk: &mut Desk) {
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
            desk.edits.did("Solo area light");
        }
        Some((Asked::Remove, index)) => {
            lights.remove(index);
            // What another light was to be picked for would become its neighbour's.
            desk.shared.viewing.picks = None;
            desk.shared.selection.light = None;
            desk.edits.did("Remove area light");
        }
        None => {}
    }
    let is_full = lights.len() as f64 >= *range::AREA_LIGHTS.end();
    ui.add_enabled_ui(!is_full, |ui| {
        ui.horizontal_wrapped(|ui| {
            for (word, made, help) in KINDS {
                let button = ui.button(format!("+ {word}")).on_hover_text(help);
                let name = format!("Add {}", word.to_lowercase());
                if button.clicked() && !is_full {
                    desk.shared.selection.light = Some(lights.len());
                    lights.push(in_view(desk, made(), lights.len()));
                    desk.edits.did(name.clone());
                }
                button.accessible_name(name);
            }
        });
    });
    desk.document.lighting.area_lights = lights;
    desk.settings(ui, "Area lights");
}

/// Width and height of a new light that is in the image, bounding radii.
const SIDE_IN_VIEW: f64 = 0.4;

/// A new light where it is seen; a sun stays where it is.
fn in_view(desk: &Desk, mut light: AreaLight, number: usize) -> AreaLight {
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
    let shines = |light: &AreaLight| !light.is_muted;
    let is_only = lights.len() > 1 && lights.iter().filter(|light| shines(light)).count() == 1;
    lights.iter().position(shines).filter(|_| is_only)
}

fn header(
    ui: &mut Ui,
    desk: &mut Desk,
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
        let name = ui.selectable_label(is_chosen, RichText::new(title).strong());
        let name = name.on_hover_text("Shows its rows here and its handles in the viewport.");
        if name.clicked() {
            *chosen = (!is_chosen).then_some(index);
        }
        name.accessible_name(format!("Choose {of_light}"));
        widgets::at_right(ui, |ui| {
            if icons::button(ui, Icon::Close, &format!("Remove {of_light}"), "Remove this light").clicked() {
                asked = Some(Asked::Remove);
            }
            let help = "Mutes all other area lights; again: lets all shine.";
            if button(ui, "Solo", is_soloed, help) {
                asked = Some(Asked::Solo);
            }
            if button(ui, "Mute", light.is_muted, "Mute: light off and hidden.") {
                light.is_muted = !light.is_muted;
                desk.edits.did("Mute area light");
            }
        });
    });
    asked
}

fn rows(ui: &mut Ui, desk: &mut Desk, (title, index): (&str, usize), light: &mut AreaLight) {
    for parameter in LIGHT_PARAMETERS.iter() {
        widgets::comes_and_goes(ui, |ui| {
            // Of those that have an effect on a light of this shape.
            let full = format!("{title} {}", parameter.label.to_lowercase());
            if (parameter.idle)(light).is_none() && parameter_row::edit(ui, parameter, &full, light, None) {
                desk.edits.note(full.clone(), full);
            }
        });
        if parameter.word() == "color" {
            temperature(ui, desk, title, light);
        }
    }
    widgets::comes_and_goes(ui, |ui| power(ui, desk, title, light));
    widgets::comes_and_goes(ui, |ui| {
        if light.is_sphere() {
            profile(ui, desk, (title, index), light);
        }
    });
    widgets::comes_and_goes(ui, |ui| {
        if desk.document.lighting.light_groups {
            group(ui, desk, title, light);
        }
    });
}

/// A row of what is no parameter by itself.
fn row<T>(
    ui: &mut Ui,
    desk: &mut Desk,
    (title, word, label, help): (&str, &str, &str, &str),
    (value, default): (&mut T, T),
    control: impl FnOnce(&mut Ui, &mut T) -> Response,
) {
    let full = format!("{title} {word}");
    if widgets::value_row(ui, [&full, label, help], value, default, control) {
        desk.edits.note(full.clone(), full);
    }
}

/// The file of a sphere's intensities by direction.
fn profile(ui: &mut Ui, desk: &mut Desk, (title, index): (&str, usize), light: &mut AreaLight) {
    let full = format!("{title} profile");
    let help = "Sends the power of the light as a measured lamp does, by an .ies file.";
    let file = light.profile.map(|file| file.path());
    let remove = format!("Remove {}", full.to_lowercase());
    let remove = (remove.as_str(), "Shines evenly again");
    let name = [full.as_str(), "Profile", help];
    if desk.file_row(ui, name, file, Action::ChooseProfile(index), remove) {
        light.profile = None;
        desk.edits.did("Remove the light profile");
    }
}

/// The name of its light group, while groups are summed apart.
fn group(ui: &mut Ui, desk: &mut Desk, title: &str, light: &mut AreaLight) {
    let none = GroupName::default();
    let by_kind = AreaLight { group: none, ..*light }.group_name().to_string();
    let help = "Lights of the same group share a factor and a layer.";
    let words = (title, "group", "Group", help);
    row(ui, desk, words, (&mut light.group, none), |ui, group| {
        let mut text = group.to_string();
        let field = TextEdit::singleline(&mut text).hint_text(by_kind);
        let response = ui.add(field.desired_width(f32::INFINITY));
        if response.changed() {
            *group = GroupName::new(&text);
        }
        response
    });
}

/// The colour as that of a lamp or a sky.
fn temperature(ui: &mut Ui, desk: &mut Desk, title: &str, light: &mut AreaLight) {
    let [coldest, hottest] = TEMPERATURES_K;
    let style = NumberStyle::plain(coldest..=hottest, " K", 20.0, 0).with_bar([coldest, 10000.0]);
    let help = "Gives the light the colour of a body that shines at this temperature: 2700 K a light bulb, 5600 K the sun, \
                10000 K a blue sky.";
    let words = (title, "temperature", "Temperature", help);
    let color = (&mut light.color, AreaLight::default().color);
    row(ui, desk, words, color, |ui, color| {
        let of_color = |color: [f32; 3]| temperature_of_color(color.map(f64::from));
        let of_temperature = |temperature_k| blackbody_color(temperature_k).map(|x| x as f32);
        widgets::number_as(ui, color, &style, of_color, of_temperature)
    });
}

/// The strength as a lamp's packet or a light meter says it, once the size of the model is known.
fn power(ui: &mut Ui, desk: &mut Desk, title: &str, light: &mut AreaLight) {
    let Some(scene) = desk.scene() else { return };
    let radius_m = scene.job.geometry.world_units_per_unit * desk.document.unit_m;
    let (label, unit, help) = if light.is_sun() {
        let help = "Of what faces the sun, where a radiance of 1 is 1 cd/m². Sets the strength.";
        ("Illuminance", " lx", help)
    } else {
        let help = "Luminous flux, where a radiance of 1 is 1 cd/m² and the model as large as the scene unit says; 683 lm are \
                    1 W. Sets the strength.";
        ("Power", " lm", help)
    };
    let of_strength = |strength: f32| AreaLight { strength, ..*light };
    let is_black = of_strength(1.0).power(radius_m) <= 0.0;
    let default = of_strength(AreaLight::default().strength);
    let speed = (0.01 * light.power(radius_m)).max(0.001);
    let style = NumberStyle::plain(0.0..=f64::MAX, unit, speed, 2);
    ui.add_enabled_ui(!is_black, |ui| {
        row(
            ui,
            desk,
            (title, "power", label, help),
            (light, default),
            |ui, light| {
                let of_power = |power: f64| {
                    let mut light = default;
                    light.set_power(power, radius_m);
                    light
                };
                widgets::number_as(ui, light, &style, |light| light.power(radius_m), of_power)
            },
        );
    });
}
