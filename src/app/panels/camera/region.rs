//! The part of the image that is rendered, by numbers.

use egui::Ui;

use crate::app::desk::Desk;
use crate::app::kit::widgets::{self, Name, NumberStyle};

/// What the switch begins with: the middle of the image.
const AT_FIRST: [f64; 4] = [0.25, 0.25, 0.75, 0.75];
/// The least width and height, shares of the image.
const LEAST: f64 = 0.01;

pub fn show(ui: &mut Ui, desk: &mut Desk<'_>) {
    let mut is_on = desk.document.render.region.is_some();
    let help = "Renders a part of the image only. In the viewport: B, then drag a rectangle; Esc clears it.";
    let name = Name::new("Render region", "Region", help);
    let response = widgets::row(ui, name, |ui| ui.checkbox(&mut is_on, ""));
    if response.changed {
        desk.document.render.region = is_on.then_some(AT_FIRST);
    }
    desk.edited(response, "Render region", |document| &mut document.render.region);
    let Some(mut region) = desk.document.render.region else {
        return;
    };
    let sides = [
        ("Region left", "Left", 0.0..=region[2] - LEAST),
        ("Region top", "Top", 0.0..=region[3] - LEAST),
        ("Region right", "Right", region[0] + LEAST..=1.0),
        ("Region bottom", "Bottom", region[1] + LEAST..=1.0),
    ];
    for (side, (full, label, range)) in region.iter_mut().zip(sides) {
        let mut percent = 100.0 * *side;
        let style =
            NumberStyle::plain(100.0 * range.start()..=100.0 * range.end(), " %", 0.5, 1).with_bar([0.0, 100.0]);
        let name = Name::new(
            full,
            label,
            "Share of the image's width or height, from its left or upper edge.",
        );
        if widgets::row(ui, name, |ui| widgets::number(ui, &mut percent, &style)).changed {
            *side = (0.01 * percent).clamp(0.0, 1.0);
            desk.edits.note("Render region", full);
        }
    }
    desk.document.render.region = Some(region);
}
