//! The part of the image that is rendered, by numbers.

use super::*;

/// What the switch begins with: the middle of the image.
const AT_FIRST: [f64; 4] = [0.25, 0.25, 0.75, 0.75];
/// The least width and height, shares of the image.
const LEAST: f64 = 0.01;

pub fn show(ui: &mut Ui, desk: &mut Desk) {
    let help = "Renders a part of the image only. In the viewport: B, then drag a rectangle; Esc clears it.";
    let switch = |ui: &mut Ui, region: &mut Option<[f64; 4]>| {
        let mut is_on = region.is_some();
        let response = ui.checkbox(&mut is_on, "");
        if response.changed() {
            *region = is_on.then_some(AT_FIRST);
        }
        response
    };
    let name = ["Render region", "Region", help];
    desk.row(ui, name, |document| &mut document.render.region, switch);
    let Some(region) = &mut desk.document.render.region else {
        return;
    };
    let [left, top, right, bottom] = *region;
    let sides = [
        ("Region left", "Left", [0.0, right - LEAST]),
        ("Region top", "Top", [0.0, bottom - LEAST]),
        ("Region right", "Right", [left + LEAST, 1.0]),
        ("Region bottom", "Bottom", [top + LEAST, 1.0]),
    ];
    let help = "Share of the image's width or height, from its left or upper edge.";
    for (side, (full, label, range)) in region.iter_mut().zip(sides) {
        let [low, high] = range.map(|end| 100.0 * end);
        let style = NumberStyle::plain(low..=high, " %", 0.5, 1).with_bar([0.0, 100.0]);
        let is_edited = widgets::row(ui, [full, label, help], |ui| {
            let share = |percent: f64| (0.01 * percent).clamp(0.0, 1.0);
            widgets::number_as(ui, side, &style, |share| 100.0 * share, share)
        });
        if is_edited {
            desk.edits.note("Render region", full);
        }
    }
}
