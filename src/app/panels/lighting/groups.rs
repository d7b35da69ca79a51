//! The mix of light groups: a factor and a colour for each, applied to what has been rendered.

use super::*;
use crate::document::{LightMix, range};

pub fn show(ui: &mut Ui, desk: &mut Desk) {
    desk.settings(ui, "Light groups");
    for group in desk.document.light_groups() {
        let mut mix = desk.document.light_mix(group);
        if widgets::comes_and_goes(ui, |ui| rows(ui, &mut mix)) {
            desk.document.set_light_mix(mix);
            let name = format!("Mix of {group}");
            desk.edits.note(name.clone(), name);
        }
    }
}

/// Factor and colour of a group; true where one was edited.
fn rows(ui: &mut Ui, mix: &mut LightMix) -> bool {
    let neutral = LightMix::of(mix.group);
    let style = NumberStyle::plain(range::LIGHT_MIX, "", 0.01, 2).with_bar([0.0, 2.0]);
    let label = mix.group.to_string();
    let full = format!("Mix of {label}");
    let help = "Multiplies the light of this group, without rendering again.";
    let is_scaled = widgets::number_row(ui, [&full, &label, help], &mut mix.factor, neutral.factor, &style);
    let full = format!("Mix colour of {label}");
    let name = [full.as_str(), "", "Tints the light of this group."];
    let is_tinted = widgets::value_row(ui, name, &mut mix.color, neutral.color, |ui, color| {
        widgets::color(ui, &full, color)
    });
    mix.color = mix.color.map(|channel| channel.clamp(0.0, 1.0));
    is_scaled || is_tinted
}
