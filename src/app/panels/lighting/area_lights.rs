//! The rectangles and triangles that shine: adding, removing, and a row for each of their numbers.

use std::ops::RangeInclusive;

use egui::{Align, Button, Layout, Ui};

use crate::app::desk::{Desk, Pick};
use crate::app::kit::icons::{self, Icon};
use crate::app::kit::widgets::{self, Name, NumberStyle, RowResponse};
use crate::document::{AreaLight, AreaLightShape, range};
use crate::optics::blackbody::{TEMPERATURES_K, blackbody_color, temperature_of_color};

/// What the buttons beside a light's name ask for.
enum Wish {
    Remove,
    Solo,
}

pub(super) fn show(ui: &mut Ui, desk: &mut Desk<'_>) {
    let mut lights = desk.document.lighting.area_lights.clone();
    let soloed = soloed(&lights);
    let mut wished = None;
    for (index, light) in lights.iter_mut().enumerate() {
        let title = format!("Area light {}", index + 1);
        let wish = header(ui, desk, &title, light, soloed == Some(index));
        wished = wish.map(|wish| (wish, index)).or(wished);
        rows(ui, desk, &title, light);
        let help = "The next click on the model turns the light so that it is seen mirrored there.";
        let pick = desk.pick_toggle(ui, Pick::Highlight(index), "Place highlight", help);
        pick.accessible_name(format!("Place highlight of {}", title.to_lowercase()));
    }
    match wished {
        Some((Wish::Solo, index)) => {
            let is_over = soloed == Some(index);
            for (other, light) in lights.iter_mut().enumerate() {
                light.is_muted = !is_over && other != index;
            }
            desk.edits.note("Solo area light", "");
        }
        Some((Wish::Remove, index)) => {
            lights.remove(index);
            // What another light was to be picked for would become its neighbour's.
            desk.shared.picks = None;
            desk.edits.note("Remove area light", "");
        }
        None => {}
    }
    let is_full = lights.len() as f64 >= *range::AREA_LIGHTS.end();
    ui.add_enabled_ui(!is_full, |ui| {
        let button = ui.button("Add area light");
        if button.on_hover_text("A rectangle that shines on the model.").clicked() {
            lights.push(AreaLight::default());
            desk.edits.note("Add area light", "");
        }
    });
    desk.document.lighting.area_lights = lights;
}

/// The only one of several lights that shines.
fn soloed(lights: &[AreaLight]) -> Option<usize> {
    let mut shining = (0..lights.len()).filter(|&index| !lights[index].is_muted);
    match (shining.next(), shining.next()) {
        (Some(index), None) if lights.len() > 1 => Some(index),
        _ => None,
    }
}

fn header(ui: &mut Ui, desk: &mut Desk<'_>, title: &str, light: &mut AreaLight, is_soloed: bool) -> Option<Wish> {
    let of_light = title.to_lowercase();
    let button = |ui: &mut Ui, word: &str, is_on: bool, help: &str| {
        let button = ui.add(Button::new(word).selected(is_on)).on_hover_text(help);
        button.accessible_name(format!("{word} {of_light}")).clicked()
    };
    let mut wish = None;
    ui.horizontal(|ui| {
        ui.strong(title);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let name = format!("Remove {}", title.to_lowercase());
            if icons::button(ui, Icon::Close, &name, "Remove this light").clicked() {
                wish = Some(Wish::Remove);
            }
            if button(
                ui,
                "Solo",
                is_soloed,
                "Mutes all other area lights; again: lets all shine.",
            ) {
                wish = Some(Wish::Solo);
            }
            let help = "It does not shine, and is not there, until this is pressed again.";
            if button(ui, "Mute", light.is_muted, help) {
                light.is_muted = !light.is_muted;
                desk.edits.note("Mute area light", "");
            }
        });
    });
    wish
}

/// A number of an area light.
struct Row {
    label: &'static str,
    help: &'static str,
    field: fn(&mut AreaLight) -> &mut f64,
    range: RangeInclusive<f64>,
    bar: [f64; 2],
    unit: &'static str,
}

fn number_rows() -> [Row; 5] {
    let length = |label, help, field, bar| Row {
        label,
        help,
        field,
        range: range::AREA_LENGTH,
        bar,
        unit: "",
    };
    [
        Row {
            label: "Yaw",
            help: "Turns the light around the model.",
            field: |light| &mut light.yaw_deg,
            range: range::YAW_DEG,
            bar: [-180.0, 180.0],
            unit: "°",
        },
        Row {
            label: "Pitch",
            help: "Height of the light above the horizon.",
            field: |light| &mut light.pitch_deg,
            range: range::PITCH_DEG,
            bar: [-90.0, 90.0],
            unit: "°",
        },
        length(
            "Distance",
            "From the middle of the model, in its bounding radii.",
            |light| &mut light.distance,
            [0.0, 10.0],
        ),
        length(
            "Width",
            "In bounding radii of the model. A small light makes sharp shadows.",
            |light| &mut light.width,
            [0.0, 4.0],
        ),
        length(
            "Height",
            "In bounding radii of the model.",
            |light| &mut light.height,
            [0.0, 4.0],
        ),
    ]
}

fn rows(ui: &mut Ui, desk: &mut Desk<'_>, title: &str, light: &mut AreaLight) {
    let mut default = AreaLight::default();
    for row in number_rows() {
        let is_angle = !row.unit.is_empty();
        let style = NumberStyle {
            range: row.range,
            bar: Some(row.bar),
            unit: row.unit,
            speed: 0.01,
            decimals: if is_angle { 1 } else { 3 },
        };
        let full = format!("{title} {}", row.label.to_lowercase());
        let value = (row.field)(light);
        let response = widgets::row(ui, Name::new(&full, row.label, row.help), |ui| {
            widgets::number(ui, value, &style)
        });
        edited(desk, response, full, value, *(row.field)(&mut default));
    }
    let full = format!("{title} shape");
    let shapes: Vec<_> = AreaLightShape::ALL
        .iter()
        .map(|shape| (*shape, shape.label(), shape.help()))
        .collect();
    let response = widgets::row(ui, Name::new(&full, "Shape", "Rectangle or triangle."), |ui| {
        widgets::choice(ui, &full, &mut light.shape, &shapes)
    });
    edited(desk, response, full, &mut light.shape, default.shape);
    let full = format!("{title} colour");
    let name = Name::new(&full, "Colour", "Colour of the light.");
    let response = widgets::row(ui, name, |ui| widgets::color(ui, &full, &mut light.color));
    light.color = light.color.map(|x| x.clamp(0.0, 1.0));
    edited(desk, response, full, &mut light.color, default.color);
    temperature(ui, desk, title, light);
    let style = NumberStyle {
        range: range::STRENGTH,
        bar: Some([0.0, 100.0]),
        unit: "",
        speed: 0.1,
        decimals: 3,
    };
    let full = format!("{title} strength");
    let name = Name::new(
        &full,
        "Strength",
        "Radiance of the light: a larger one of the same strength gives more light.",
    );
    let response = widgets::row(ui, name, |ui| widgets::number(ui, &mut light.strength, &style));
    edited(desk, response, full, &mut light.strength, default.strength);
}

/// The colour as that of a lamp or a sky.
fn temperature(ui: &mut Ui, desk: &mut Desk<'_>, title: &str, light: &mut AreaLight) {
    let [coldest, hottest] = TEMPERATURES_K;
    let style = NumberStyle {
        range: coldest..=hottest,
        bar: Some([coldest, 10000.0]),
        unit: " K",
        speed: 20.0,
        decimals: 0,
    };
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

/// Notes an edit, and resets where that was asked for.
fn edited<T>(desk: &mut Desk<'_>, response: RowResponse, name: String, value: &mut T, default: T) {
    if response.reset {
        *value = default;
    }
    if response.changed || response.reset {
        desk.edits.note(name.clone(), name);
    }
}
