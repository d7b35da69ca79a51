//! The mix of light groups: a factor and a colour for each, applied to what has been rendered.

use egui::Ui;

use crate::app::desk::Desk;
use crate::app::kit::widgets::{self, Name, NumberStyle};
use crate::document::{LightMix, range};

pub fn show(ui: &mut Ui, desk: &mut Desk<'_>) {
    desk.settings(ui, "Light groups");
    for group in desk.document.light_groups() {
        let before = desk.document.light_mix(group);
        let mut mix = before;
        widgets::comes_and_goes(ui, |ui| rows(ui, &mut mix));
        if mix != before {
            desk.document.set_light_mix(mix);
            let name = format!("Mix of {group}");
            desk.edits.note(name.clone(), name);
        }
    }
}

/// Factor and colour of a group.
fn rows(ui: &mut Ui, mix: &mut LightMix) {
    let neutral = LightMix::of(mix.group);
    let style = NumberStyle {
        range: range::LIGHT_MIX,
        bar: Some([0.0, 2.0]),
        unit: "",
        speed: 0.01,
        decimals: 2,
    };
    let label = mix.group.to_string();
    let full = format!("Mix of {label}");
    let help = "Multiplies the light of this group, without rendering again.";
    let response = widgets::row(ui, Name::new(&full, &label, help), |ui| {
        widgets::number(ui, &mut mix.factor, &style)
    });
    if response.reset {
        mix.factor = neutral.factor;
    }
    let full = format!("Mix colour of {label}");
    let help = "Tints the light of this group.";
    let response = widgets::row(ui, Name::new(&full, "", help), |ui| {
        widgets::color(ui, &full, &mut mix.color)
    });
    if response.reset {
        mix.color = neutral.color;
    }
    mix.color = mix.color.map(|channel| channel.clamp(0.0, 1.0));
}
