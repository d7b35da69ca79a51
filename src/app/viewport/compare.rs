//! A and B in the viewport: wipe, side by side, difference, flicker; and the bar that says what they are.

use std::time::Duration;

use egui::{Align, Align2, Color32, CursorIcon, Key, Layout, Rect, Response, Sense, Ui, UiBuilder, pos2, vec2};

use super::{ShownTexture, Viewport, placed};
use crate::analysis::difference::diverging;
use crate::app::actions::{Action, Command};
use crate::app::desk::Desk;
use crate::app::kit::icons::{self, Icon};
use crate::app::kit::keys::hold_arrows;
use crate::app::kit::theme;
use crate::app::kit::widgets::{self, NumberStyle};
use crate::app::services::compare::{BEFORE, Compared, Rival, View};
use crate::optics::lobe::Lobe;
use crate::render::worker::Picture;
use crate::store::PRESETS;

/// Half the width in which the divider can be taken hold of, points.
const GRIP: f32 = 5.0;
/// How far an arrow key moves the divider, as a share of the width.
const KEY_STEP: f32 = 0.01;
/// Width and height of the legend's bar, points.
const LEGEND: egui::Vec2 = vec2(160.0, 10.0);

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
    /// Shows A, `a`, and B where there is an image of it; returns where what the pointer is over is shown.
    pub fn compared(&mut self, ui: &mut Ui, area: Rect, a: &Picture, desk: &mut Desk<'_>) -> Rect {
        let resolution = desk.shared.viewing.resolution;
        let place = placed(area_of_a(area, desk.shared.compare.view), a, resolution);
        let Some(b) = desk.shared.compare.picture() else {
            self.picture.paint(ui, place, place, a, 0);
            label(ui, place, Align2::RIGHT_TOP, "B …");
            return place;
        };
        let generation = desk.shared.compare.generation;
        let [name_a, name_b] = desk.compared_names();
        let [name_a, name_b] = [format!("A  {name_a}"), format!("B  {name_b}")];
        match desk.shared.compare.view {
            View::Wipe => {
                let x = egui::lerp(place.x_range(), desk.shared.compare.divider);
                let (left, right) = (place.with_max_x(x), place.with_min_x(x));
                self.picture.paint(ui, left, place, a, 0);
                self.rival.paint(ui, right, place, &b, generation);
                label(ui, left, Align2::LEFT_TOP, &name_a);
                label(ui, right, Align2::RIGHT_TOP, &name_b);
            }
            View::SideBySide => {
                let [left, right] = halves(area);
                let right_place = placed(right, &b, resolution);
                self.picture.paint(ui, left, place, a, 0);
                self.rival.paint(ui, right, right_place, &b, generation);
                label(ui, left, Align2::LEFT_TOP, &name_a);
                label(ui, right, Align2::LEFT_TOP, &name_b);
                let pointer = ui.input(|input| input.pointer.press_origin().or(input.pointer.hover_pos()));
                if pointer.is_some_and(|at| right.contains(at)) {
                    return right_place;
                }
            }
            View::Difference => match desk.shared.compare.compared() {
                Some(compared) => {
                    self.difference.paint_difference(ui, place, &compared, generation);
                    legend(ui, place, &compared);
                }
                None => self.picture.paint(ui, place, place, a, 0),
            },
            View::Flicker => {
                let hz = f64::from(desk.shared.compare.flicker_hz.max(0.1));
                let turns = ui.input(|input| input.time) * hz;
                ui.ctx()
                    .request_repaint_after(Duration::from_secs_f64((1.0 - turns.fract()) / hz));
                if (turns as u64).is_multiple_of(2) {
                    self.picture.paint(ui, place, place, a, 0);
                    label(ui, place, Align2::LEFT_TOP, &name_a);
                } else {
                    self.rival.paint(ui, place, place, &b, generation);
                    label(ui, place, Align2::LEFT_TOP, &name_b);
                }
            }
        }
        place
    }

    /// The divider over the image. To be shown after what turns the camera, so that it is before that.
    pub fn divider(ui: &mut Ui, place: Rect, desk: &mut Desk<'_>) {
        let compare = &mut desk.shared.compare;
        let x = egui::lerp(place.x_range(), compare.divider);
        let rect = Rect::from_x_y_ranges(x - GRIP..=x + GRIP, place.y_range());
        let response = ui.interact(rect, ui.scope_id().with("divider"), Sense::drag());
        let share = f64::from(compare.divider);
        response.widget_info(|| egui::WidgetInfo::slider(true, share, "Divider"));
        let response = response.on_hover_cursor(CursorIcon::ResizeHorizontal);
        if response.dragged()
            && let Some(at) = response.interact_pointer_pos()
        {
            compare.divider = ((at.x - place.left()) / place.width().max(1.0)).clamp(0.0, 1.0);
        }
        compare.divider = (compare.divider + KEY_STEP * arrows(ui, &response)).clamp(0.0, 1.0);
        let is_held = response.hovered() || response.dragged() || response.has_focus();
        let color = if is_held {
            theme::accent(ui.visuals().dark_mode)
        } else {
            Color32::from_white_alpha(200)
        };
        let x = egui::lerp(place.x_range(), compare.divider);
        let painter = ui.painter_at(place);
        painter.vline(
            x,
            place.y_range(),
            egui::Stroke::new(3.0, Color32::from_black_alpha(110)),
        );
        painter.vline(x, place.y_range(), egui::Stroke::new(1.0, color));
        let grip = Rect::from_center_size(pos2(x, place.center().y), vec2(6.0, 34.0));
        painter.rect_filled(grip, 3.0, color);
    }
}

/// Steps by the arrow keys, where the divider has the focus.
fn arrows(ui: &Ui, response: &Response) -> f32 {
    if !response.has_focus() {
        return 0.0;
    }
    hold_arrows(ui, response, true, false);
    let count = |key| ui.input(|input| input.num_presses(key)) as f32;
    count(Key::ArrowRight) - count(Key::ArrowLeft)
}

/// A name over a corner of the image.
fn label(ui: &Ui, clip: Rect, corner: Align2, text: &str) {
    let painter = ui.painter_at(clip);
    let font = egui::TextStyle::Body.resolve(ui.style());
    let galley = painter.layout_no_wrap(text.to_owned(), font, Color32::WHITE);
    let size = galley.size() + vec2(14.0, 6.0);
    let rect = corner.align_size_within_rect(size, clip.shrink(8.0));
    painter.rect_filled(rect, 3.0, Color32::from_black_alpha(150));
    painter.galley(rect.min + vec2(7.0, 3.0), galley, Color32::WHITE);
}

/// What the colours of the difference mean.
fn legend(ui: &Ui, place: Rect, compared: &Compared) {
    let painter = ui.painter_at(place);
    let font = egui::TextStyle::Small.resolve(ui.style());
    let size = LEGEND + vec2(24.0, 40.0);
    let frame = Align2::LEFT_BOTTOM.align_size_within_rect(size, place.shrink(8.0));
    painter.rect_filled(frame, 3.0, Color32::from_black_alpha(190));
    let bar = Rect::from_min_size(frame.min + vec2(12.0, 19.0), LEGEND);
    let steps = 64;
    for step in 0..steps {
        let share = (step as f32 + 0.5) / steps as f32;
        let [r, g, b] = diverging(2.0 * share - 1.0);
        let left = bar.left() + bar.width() * step as f32 / steps as f32;
        let part = Rect::from_min_size(
            pos2(left, bar.top()),
            vec2(bar.width() / steps as f32 + 0.5, bar.height()),
        );
        painter.rect_filled(part, 0.0, Color32::from_rgb(r, g, b));
    }
    let text = |at, align, text: String| {
        painter.text(at, align, text, font.clone(), Color32::from_gray(220));
    };
    text(
        bar.left_top() - vec2(0.0, 3.0),
        Align2::LEFT_BOTTOM,
        "A brighter".to_owned(),
    );
    text(
        bar.right_top() - vec2(0.0, 3.0),
        Align2::RIGHT_BOTTOM,
        "B brighter".to_owned(),
    );
    let scale = compared.scale;
    text(
        bar.left_bottom() + vec2(0.0, 3.0),
        Align2::LEFT_TOP,
        format!("−{scale:.3}"),
    );
    text(bar.center_bottom() + vec2(0.0, 3.0), Align2::CENTER_TOP, "0".to_owned());
    text(
        bar.right_bottom() + vec2(0.0, 3.0),
        Align2::RIGHT_TOP,
        format!("+{scale:.3}"),
    );
}

impl ShownTexture {
    fn paint_difference(&mut self, ui: &Ui, place: Rect, compared: &Compared, generation: u64) {
        let image = || egui::ColorImage::from_rgba_unmultiplied(compared.size, &compared.rgba);
        self.upload(ui, [generation, compared.serial], image);
        self.show(ui, place, place);
    }
}

/// What A and B are, how they are shown, how far they are apart, and what can be done with B.
pub fn bar(ui: &mut Ui, bar: Rect, desk: &mut Desk<'_>) {
    ui.painter().rect_filled(bar, 0.0, ui.visuals().panel_fill);
    let (upper, lower) = bar.split_top_bottom_at_fraction(0.5);
    in_row(ui, upper, |ui| contestants(ui, desk));
    in_row(ui, lower, |ui| views(ui, desk));
}

fn in_row(ui: &mut Ui, row: Rect, add: impl FnOnce(&mut Ui)) {
    let builder = UiBuilder::new()
        .max_rect(row.shrink2(vec2(8.0, 0.0)))
        .layout(Layout::left_to_right(Align::Center));
    let mut inside = ui.new_child(builder);
    inside.set_clip_rect(row.intersect(ui.clip_rect()));
    add(&mut inside);
}

fn contestants(ui: &mut Ui, desk: &mut Desk<'_>) {
    ui.weak("A");
    ui.add(egui::Label::new(desk.material().name).truncate());
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
            let response = ui.button(text).on_hover_text(command.help());
            if response.clicked() {
                desk.act(command);
            }
        }
    });
}

fn rivals(ui: &mut Ui, desk: &mut Desk<'_>) {
    let material = desk.material();
    let current = desk.shared.compare.rival.clone();
    let mut chosen = None;
    let combo = egui::ComboBox::from_id_salt("rival")
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
        let pinned = &desk.shared.snapshots.pinned;
        if !pinned.is_empty() {
            widgets::note(ui, "Snapshots");
        }
        for pin in pinned {
            entry(
                ui,
                &pin.name,
                Rival::Materials(pin.name.clone(), pin.document.materials.clone()),
            );
        }
        widgets::note(ui, "Presets");
        let own = desk.shared.library.own.iter();
        let own = own.filter_map(|shown| shown.entry.material.as_ref().ok());
        for preset in own.chain(PRESETS.iter()) {
            entry(ui, &preset.name, Rival::Material(Box::new(preset.clone())));
        }
    });
    shown
        .response
        .accessible_name("Compare with")
        .on_hover_text("What B is");
    desk.actions.extend(chosen.map(Action::CompareWith));
}

fn views(ui: &mut Ui, desk: &mut Desk<'_>) {
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
            super::header::sized(ui, 64.0, |ui| {
                let response = widgets::number(ui, &mut compare.flicker_hz, &style);
                response
                    .accessible_name("Flicker rate")
                    .on_hover_text("Changes a second");
            });
        }
        View::Difference => {
            let mut scale = compare.scale.or(compared.as_ref().map(|of| of.scale)).unwrap_or(1.0);
            let style = NumberStyle::plain(1e-4..=1e4, "", f64::from(scale) * 0.01, 4);
            super::header::sized(ui, 72.0, |ui| {
                let response = widgets::number(ui, &mut scale, &style);
                if response.changed() {
                    compare.scale = Some(scale);
                }
                response
                    .accessible_name("Difference scale")
                    .on_hover_text("The difference of radiance that has the full colour");
            });
            let mut is_automatic = compare.scale.is_none();
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
        ui.label(format!("RMS {:.2} %", 100.0 * compared.rms))
            .on_hover_text(help);
    });
}
