//! A and B in the viewport: wipe, side by side, difference, flicker; and the bar that says what they are.

use std::time::Duration;

use super::header::in_bar;
use super::*;
use crate::{
    analysis::difference::diverging,
    kit::{drag::steps, widgets::NumberStyle},
    optics::lobe::Lobe,
    pane::Pane,
    services::compare::{BEFORE, Rival},
    services::viewing::Pick,
};

/// Half the width in which the divider can be taken hold of, points.
const GRIP: f32 = 5.0;
/// How far an arrow key moves the divider, as a share of the width.
const KEY_STEP: f32 = 0.01;

/// Height of the bar.
pub const BAR_HEIGHT: f32 = 2.0 * theme::BAR_HEIGHT;

/// The part of the area in which A is shown, by which its size goes.
pub fn area_of_a(area: Rect, view: View) -> Rect {
    if view == View::SideBySide {
        halves(area)[0]
    } else {
        area
    }
}

fn halves(area: Rect) -> [Rect; 2] {
    let (left, right) = area.split_left_right_at_fraction(0.5);
    [
        left.with_max_x(left.right() - 1.0),
        right.with_min_x(right.left() + 1.0),
    ]
}

impl Viewport {
    /// Shows A and B where there is an image of it; returns where what the pointer is over is shown.
    pub fn compared(&mut self, ui: &mut Ui, area: Rect, picture: &Picture, desk: &Desk) -> Rect {
        let resolution = desk.shared.viewing.resolution;
        let place = placed(area_of_a(area, desk.shared.compare.view), picture, resolution);
        let Some(b_picture) = desk.shared.compare.picture() else {
            self.picture.paint(ui, place, place, picture, 0);
            label(ui, place, Align2::RIGHT_TOP, "B …");
            return place;
        };
        let compare = &desk.shared.compare;
        let (view, source) = (compare.view, compare.generation);
        let [name_a, name_b] = desk.compared_names();
        let [name_a, name_b] = [format!("A  {name_a}"), format!("B  {name_b}")];
        // A where `a` says, and B where `b` says.
        let mut both = |a: Option<Rect>, b: Option<(Rect, Rect)>, corner: Align2| {
            if let Some(clip) = a {
                self.picture.paint(ui, clip, place, picture, 0);
                label(ui, clip, Align2::LEFT_TOP, &name_a);
            }
            if let Some((clip, place)) = b {
                self.rival.paint(ui, clip, place, &b_picture, source);
                label(ui, clip, corner, &name_b);
            }
        };
        match view {
            View::Wipe => {
                let x = lerp(place.x_range(), compare.divider);
                let right = (place.with_min_x(x), place);
                both(Some(place.with_max_x(x)), Some(right), Align2::RIGHT_TOP);
            }
            View::SideBySide => {
                let [left, right] = halves(area);
                let right_place = placed(right, &b_picture, resolution);
                both(Some(left), Some((right, right_place)), Align2::LEFT_TOP);
                let pointer = ui.input(|input| input.pointer.press_origin().or(input.pointer.hover_pos()));
                if pointer.is_some_and(|at| right.contains(at)) {
                    return right_place;
                }
            }
            View::Difference => match compare.compared() {
                Some(compared) => {
                    let image = || ColorImage::from_rgba_unmultiplied(compared.size, &compared.rgba);
                    self.difference.upload(ui, [source, compared.serial], image);
                    self.difference.show(ui, place, place);
                    let scale = compared.scale;
                    let below = [format!("−{scale:.3}"), "0".to_owned(), format!("+{scale:.3}")];
                    let color = |share: f64| diverging(2.0 * share as f32 - 1.0);
                    legend::strip(ui, place, color, ["A brighter", "B brighter"], below);
                }
                None => self.picture.paint(ui, place, place, picture, 0),
            },
            View::Flicker => {
                let hz = f64::from(compare.flicker_hz.max(0.1));
                let turns = ui.input(|input| input.time) * hz;
                let left = Duration::from_secs_f64((1.0 - turns.fract()) / hz);
                ui.ctx().request_repaint_after(left);
                if (turns as u64).is_multiple_of(2) {
                    both(Some(place), None, Align2::LEFT_TOP);
                } else {
                    both(None, Some((place, place)), Align2::LEFT_TOP);
                }
            }
        }
        place
    }

    /// The divider over the image. To be shown after what turns the camera, so that it is before that.
    pub fn divider(ui: &mut Ui, place: Rect, desk: &mut Desk) {
        let divider = &mut desk.shared.compare.divider;
        let x = lerp(place.x_range(), *divider);
        let rect = Rect::from_x_y_ranges(x - GRIP..=x + GRIP, place.y_range());
        let response = ui.interact(rect, ui.scope_id().with("divider"), Sense::drag());
        let share = f64::from(*divider);
        response.widget_info(|| WidgetInfo::slider(true, share, "Divider"));
        let response = response.on_hover_cursor(CursorIcon::ResizeHorizontal);
        if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) {
            *divider = (at.x - place.left()) / place.width().max(1.0);
        }
        *divider = (*divider + KEY_STEP * steps(ui, &response, false).x).clamp(0.0, 1.0);
        let is_held = response.hovered() || response.dragged() || response.has_focus();
        let color = if is_held {
            theme::accent(ui)
        } else {
            Color32::from_white_alpha(200)
        };
        let x = lerp(place.x_range(), *divider);
        let painter = ui.painter_at(place);
        let shadow = Stroke::new(3.0, Color32::from_black_alpha(110));
        painter.vline(x, place.y_range(), shadow);
        painter.vline(x, place.y_range(), Stroke::new(1.0, color));
        let grip = Rect::from_center_size(pos2(x, place.center().y), vec2(6.0, 34.0));
        painter.rect_filled(grip, 3.0, color);
    }
}

/// A name over a corner of the image.
fn label(ui: &Ui, clip: Rect, corner: Align2, text: &str) {
    let at = corner.pos_in_rect(&clip.shrink(8.0));
    let colors = [Color32::from_black_alpha(150), Color32::WHITE];
    plate(&ui.painter_at(clip), corner, at, text, colors);
}

/// What A and B are, how they are shown, how far they are apart, and what can be done with B.
pub fn bar(ui: &mut Ui, bar: Rect, desk: &mut Desk) {
    ui.painter().rect_filled(bar, 0.0, ui.visuals().panel_fill);
    let (upper, lower) = bar.split_top_bottom_at_fraction(0.5);
    contestants(&mut in_bar(ui, "contestants", upper), desk);
    views(&mut in_bar(ui, "views", lower), desk);
}

fn contestants(ui: &mut Ui, desk: &mut Desk) {
    ui.weak("A");
    widgets::line(ui, desk.material().name);
    ui.weak("B");
    rivals(ui, desk);
    let why = desk.shared.compare.match_error(&desk.material());
    widgets::comes_and_goes(ui, |ui| {
        if let Some(why) = why {
            let color = ui.visuals().warn_fg_color;
            ui.colored_label(color, "not matched").on_hover_text(why);
        }
    });
    widgets::at_right(ui, |ui| {
        if icons::button(ui, Icon::Close, "Stop comparing", "Stop comparing (C)").clicked() {
            desk.act(Command::Compare);
        }
        for (command, text) in [
            (Command::TakeCompared, "Replace A with B"),
            (Command::SwapCompared, "Swap"),
        ] {
            if widgets::pressed(ui, text, command.help()) {
                desk.act(command);
            }
        }
    });
}

fn rivals(ui: &mut Ui, desk: &mut Desk) {
    let material = desk.material();
    let current = desk.shared.compare.rival.clone();
    let mut chosen = None;
    let combo = ComboBox::from_id_salt("rival")
        .width(190.0)
        .selected_text(desk.shared.compare.name(&material));
    let shown = combo.show_ui(ui, |ui| {
        let mut entry = |ui: &mut Ui, text: &str, rival: Rival| {
            if ui.selectable_label(current == rival, text).clicked() {
                chosen = Some(rival);
                ui.close();
            }
        };
        if let Some(before) = desk.edits.materials_before(desk.document) {
            entry(ui, BEFORE, Rival::Materials(BEFORE.to_owned(), before));
        }
        widgets::note(ui, "The same material, look matched");
        for lobe in Lobe::ALL.iter().filter(|lobe| **lobe != material.lobe) {
            entry(ui, lobe.label(), Rival::Lobe(*lobe));
        }
        let pinned = &desk.shared.snapshots.entries;
        if !pinned.is_empty() {
            widgets::note(ui, "Snapshots");
        }
        for (pin, _) in pinned {
            let rival = Rival::Materials(pin.name.clone(), pin.document.materials.clone());
            entry(ui, &pin.name, rival);
        }
        let help = "The next click on a preset says what B is.";
        if widgets::entry(ui, "Choose a preset…", help) {
            desk.shared.viewing.picks = Some(Pick::Rival);
            desk.actions.push(Action::Reveal(Pane::Presets));
        }
    });
    let response = shown.response.accessible_name("Compare with");
    response.on_hover_text("What B is");
    desk.actions.extend(chosen.map(Action::CompareWith));
}

fn views(ui: &mut Ui, desk: &mut Desk) {
    let compare = &mut desk.shared.compare;
    for &view in View::ALL {
        let response = ui.selectable_label(compare.view == view, view.label());
        if response.on_hover_text(view.help()).clicked() {
            compare.view = view;
        }
    }
    let compared = compare.compared();
    match compare.view {
        View::Flicker => {
            let style = NumberStyle::plain(0.25..=8.0, " Hz", 0.02, 2);
            let hz = &mut compare.flicker_hz;
            let response = widgets::sized(ui, 64.0, |ui| widgets::number(ui, hz, &style));
            let response = response.accessible_name("Flicker rate");
            response.on_hover_text("Changes a second");
        }
        View::Difference => {
            let own = compared.as_ref().map_or(1.0, |of| of.scale);
            let scale = compare.scale.unwrap_or(own);
            let style = NumberStyle::plain(1e-4..=1e4, "", f64::from(scale) * 0.01, 4);
            let response = widgets::sized(ui, 72.0, |ui| {
                widgets::number_following(ui, &mut compare.scale, own, &style)
            });
            let response = response.accessible_name("Difference scale");
            response.on_hover_text("The difference of radiance that has the full colour");
            let mut is_automatic = compare.scale.is_none();
            ui.weak("full colour");
            if ui.checkbox(&mut is_automatic, "Auto").changed() {
                compare.scale = (!is_automatic).then_some(scale);
            }
        }
        View::Wipe | View::SideBySide => {}
    }
    let Some(compared) = compared else { return };
    widgets::at_right(ui, |ui| {
        let [a, b] = compared.samples;
        let help = format!(
            "Root mean square of (B − A) over A, with at least 0.1 for A. A has {a} samples per pixel and B {b}, \
             drawn with the same random numbers."
        );
        let text = format!("RMS {:.2} %", 100.0 * compared.rms);
        ui.label(text).on_hover_text(help);
    });
}
