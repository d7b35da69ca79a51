//! The rows that panels are made of: a label, which explains and resets, and a control, which is named after it.

use std::ops::RangeInclusive;

use egui::text::LayoutJob;
use egui::{
    Align, Color32, DragValue, Layout, Rect, Response, RichText, Sense, Shape, TextFormat, TextStyle, TextureHandle,
    Ui, UiBuilder, Vec2,
};

use crate::app::kit::keys::{fulfil_request, hold_arrows, note_requested, requested};
use crate::app::kit::theme::{self, ROW_HEIGHT};
use crate::named::Named;
use crate::optics::tone::{linear_from_srgb, srgb_from_linear};
use crate::optics::vector::vec3;

/// The share of a row that its label takes.
const LABEL_SHARE: f32 = 0.40;
/// The least width of a label, points.
const LABEL_MIN: f32 = 84.0;
/// Width of a colour's swatch beside its code at least, points.
const SWATCH_MIN: f32 = 26.0;
/// Width of a colour's hexadecimal field, points.
const HEX_WIDTH: f32 = 68.0;

/// What a row is called and explains.
#[derive(Clone, Copy, Debug, Default)]
pub struct Name<'a> {
    /// The name for screen readers and tests; unique in the window.
    pub full: &'a str,
    pub label: &'a str,
    /// A symbol behind it, or empty.
    pub symbol: &'a str,
    /// What it does to the image.
    pub help: &'a str,
}

impl<'a> Name<'a> {
    /// Without a symbol.
    pub fn new(full: &'a str, label: &'a str, help: &'a str) -> Self {
        Self {
            full,
            label,
            symbol: "",
            help,
        }
    }
}

/// What happened to a row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RowResponse {
    /// Its value was changed by the control.
    pub changed: bool,
    /// It is to go back to its default.
    pub reset: bool,
}

/// A label and a control that fills the rest of the row. Double-clicking the label, or its menu, resets.
pub fn row(ui: &mut Ui, name: Name<'_>, control: impl FnOnce(&mut Ui) -> Response) -> RowResponse {
    ui.horizontal(|ui| {
        let is_requested = fulfil_request(ui, name.full);
        let label_width = (ui.available_width() * LABEL_SHARE).max(LABEL_MIN);
        let label = row_label(ui, name, label_width);
        let width = ui.available_width().max(40.0);
        let layout = Layout::left_to_right(Align::Center);
        let control = ui
            .allocate_ui_with_layout(Vec2::new(width, ROW_HEIGHT), layout, control)
            .inner;
        let changed = control.changed();
        let control = control.accessible_name(name.full);
        if is_requested {
            note_requested(ui, &control);
        }
        if !name.help.is_empty() {
            control.on_hover_text(name.help);
        }
        let mut reset = label.double_clicked();
        label.context_menu(|ui| {
            if ui.button("Reset to default").clicked() {
                reset = true;
                ui.close();
            }
        });
        RowResponse { changed, reset }
    })
    .inner
}

fn row_label(ui: &mut Ui, name: Name<'_>, width: f32) -> Response {
    let mut job = LayoutJob::default();
    let font = TextStyle::Body.resolve(ui.style());
    let format = |color: Color32| TextFormat::simple(font.clone(), color);
    job.append(name.label, 0.0, format(ui.visuals().text_color()));
    if !name.symbol.is_empty() && name.symbol != name.label {
        let mut with_symbol = job.clone();
        with_symbol.append(name.symbol, 6.0, format(ui.visuals().weak_text_color()));
        // A part of a symbol says nothing.
        if ui.painter().layout_job(with_symbol.clone()).size().x <= width {
            job = with_symbol;
        }
    }
    let layout = Layout::left_to_right(Align::Center);
    // Not a stop of the tab key: a press of a key on it would do nothing.
    let label = egui::Label::new(job).truncate().selectable(false).sense(Sense::CLICK);
    let response = ui.allocate_ui_with_layout(Vec2::new(width, ROW_HEIGHT), layout, |ui| {
        ui.set_min_width(width);
        ui.add(label)
    });
    let help = if name.help.is_empty() { name.label } else { name.help };
    response.inner.on_hover_ui(|ui| {
        ui.set_max_width(ui.spacing().tooltip_width);
        ui.label(help);
        ui.label(RichText::new("Double-click to reset").weak().small());
    })
}

/// How a number is edited.
#[derive(Clone, Debug)]
pub struct NumberStyle<'a> {
    /// The values that it may take.
    pub range: RangeInclusive<f64>,
    /// What the bar spans; `None` for no bar.
    pub bar: Option<[f64; 2]>,
    /// Unit behind the number, with its space where one belongs.
    pub unit: &'a str,
    /// Change per point of dragging where there is no bar.
    pub speed: f64,
    /// Most digits behind the point.
    pub decimals: usize,
}

impl<'a> NumberStyle<'a> {
    /// A number without a bar.
    pub fn plain(range: RangeInclusive<f64>, unit: &'a str, speed: f64, decimals: usize) -> Self {
        Self {
            range,
            bar: None,
            unit,
            speed,
            decimals,
        }
    }

    /// The same with a bar that spans this, if anything.
    pub fn with_bar(self, bar: impl Into<Option<[f64; 2]>>) -> Self {
        let bar = bar.into();
        Self { bar, ..self }
    }
}

/// A number as a bar to drag (with shift: finely) or to type into.
pub fn number<N: egui::emath::Numeric>(ui: &mut Ui, value: &mut N, style: &NumberStyle<'_>) -> Response {
    number_or(ui, value, style, None)
}

/// The same, with a word in place of 0.
pub fn number_or<N: egui::emath::Numeric>(
    ui: &mut Ui,
    value: &mut N,
    style: &NumberStyle<'_>,
    zero: Option<&'static str>,
) -> Response {
    let size = Vec2::new(ui.available_width(), ROW_HEIGHT);
    let rect = Rect::from_min_size(ui.next_widget_position() - Vec2::new(0.0, 0.5 * size.y), size);
    let background = ui.painter().add(Shape::Noop);
    let speed = style
        .bar
        .map_or(style.speed, |[low, high]| (high - low) / f64::from(size.x.max(40.0)));
    let fills = ui.visuals().widgets.clone();
    let span = style.bar.map(|[low, high]| {
        let share = |value: f64| ((value - low) / (high - low)).clamp(0.0, 1.0) as f32;
        // Signed numbers fill from zero.
        [share(0.0_f64.clamp(low, high)), share(value.to_f64())]
    });
    let response = ui
        .scope(|ui| {
            let widgets = &mut ui.visuals_mut().widgets;
            for state in [&mut widgets.inactive, &mut widgets.hovered, &mut widgets.active] {
                state.weak_bg_fill = Color32::TRANSPARENT;
            }
            let drag = DragValue::new(value)
                .range(style.range.clone())
                .speed(speed)
                .custom_formatter(|value, _| match zero {
                    Some(word) if value == 0.0 => word.to_owned(),
                    _ => trimmed(value, style.decimals),
                })
                .suffix(style.unit.to_owned());
            ui.add_sized(size, drag)
        })
        .inner;
    let rect = if response.rect.is_positive() {
        response.rect
    } else {
        rect
    };
    let state = if response.is_pointer_button_down_on() || response.has_focus() {
        &fills.active
    } else if response.hovered() {
        &fills.hovered
    } else {
        &fills.inactive
    };
    let mut shapes = vec![Shape::rect_filled(rect, state.corner_radius, state.weak_bg_fill)];
    if let Some([from, to]) = span {
        let x = |share: f32| egui::lerp(rect.x_range(), share);
        let filled = Rect::from_x_y_ranges(x(from.min(to))..=x(from.max(to)), rect.y_range());
        let color = theme::accent(ui.visuals().dark_mode).gamma_multiply(if response.hovered() { 0.62 } else { 0.5 });
        shapes.push(bar(rect, filled, color, state.corner_radius));
    }
    ui.painter().set(background, Shape::Vec(shapes));
    response
}

/// A number with at most this many decimals; trailing zeros beyond the second are dropped.
fn trimmed(value: f64, decimals: usize) -> String {
    let mut text = format!("{value:.decimals$}");
    let least = text.len().saturating_sub(decimals.saturating_sub(2));
    while decimals > 2 && text.len() > least && text.ends_with('0') {
        text.pop();
    }
    if text.trim_start_matches(['-', '0', '.']).is_empty() {
        text.trim_start_matches('-').to_owned()
    } else {
        text
    }
}

/// The filled part of a field.
fn bar(field: Rect, filled: Rect, color: Color32, radius: egui::CornerRadius) -> Shape {
    let right = if filled.right() >= field.right() - 1.0 {
        radius.ne
    } else {
        0
    };
    let left = if filled.left() <= field.left() + 1.0 && filled.width() >= 3.0 {
        radius.nw
    } else {
        0
    };
    let corners = egui::CornerRadius {
        nw: left,
        sw: left,
        ne: right,
        se: right,
    };
    Shape::rect_filled(filled, corners, color)
}

/// What the picker's own arithmetic changes of a colour at most, with some room.
const PICKER_ROUNDING: f32 = 1e-5;

/// A linear colour: a swatch that opens a picker, and its sRGB code to type.
pub fn color(ui: &mut Ui, name: &str, linear: &mut [f32; 3]) -> Response {
    let spacing = ui.spacing().item_spacing.x;
    let beside_code = ui.available_width() - HEX_WIDTH - spacing;
    // In a narrow panel there is no room for the code: the picker shows the numbers.
    let has_code = beside_code >= SWATCH_MIN;
    let swatch_width = if has_code { beside_code } else { ui.available_width() };
    // The picker goes over hue and saturation, which rounds, even when it is not touched, and reports that as a change.
    let mut picked = *linear;
    let swatch = ui
        .scope(|ui| {
            ui.spacing_mut().interact_size.x = swatch_width;
            ui.color_edit_button_rgb(&mut picked)
        })
        .inner;
    if std::iter::zip(picked, *linear).any(|(new, old)| (new - old).abs() > PICKER_ROUNDING) {
        *linear = picked;
    }
    // A colour like the panel's would not be seen as a field.
    let line = ui.visuals().widgets.noninteractive.bg_stroke;
    let radius = ui.visuals().widgets.inactive.corner_radius;
    ui.painter()
        .rect_stroke(swatch.rect, radius, line, egui::StrokeKind::Inside);
    show_focus(ui, &swatch);
    let mut response = swatch.clone();
    if has_code && hex_field(ui, name, linear) {
        response.mark_changed();
    }
    response
}

fn hex_field(ui: &mut Ui, name: &str, linear: &mut [f32; 3]) -> bool {
    let id = ui.make_persistent_id((name, "hex"));
    let shown = hex_of(*linear);
    let typed: Option<String> = ui.data(|data| data.get_temp(id));
    let mut text = typed.unwrap_or_else(|| shown.clone());
    let field = egui::TextEdit::singleline(&mut text)
        .id(id.with("field"))
        .font(TextStyle::Monospace)
        .desired_width(HEX_WIDTH)
        .margin(Vec2::new(4.0, 3.0));
    let response = ui.add(field).accessible_name(format!("{name}, sRGB code"));
    if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, text.clone()));
    } else {
        ui.data_mut(|data| data.remove::<String>(id));
    }
    let parsed = response.changed().then(|| linear_of(&text)).flatten();
    if let Some(parsed) = parsed.filter(|parsed| hex_of(*parsed) != shown) {
        *linear = parsed;
        return true;
    }
    false
}

/// `#rrggbb` in sRGB.
pub fn hex_of(linear: [f32; 3]) -> String {
    let [r, g, b] = srgb_of(linear);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The sRGB bytes of a linear colour.
pub fn srgb_of([r, g, b]: [f32; 3]) -> [u8; 3] {
    let encoded = srgb_from_linear(vec3(r, g, b)).to_f32();
    encoded.map(|x| (255.0 * x.clamp(0.0, 1.0) + 0.5) as u8)
}

fn linear_of(text: &str) -> Option<[f32; 3]> {
    let digits = text.trim().trim_start_matches('#');
    if digits.len() != 6 || !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
        return None;
    }
    let byte = |i: usize| u8::from_str_radix(&digits[2 * i..2 * i + 2], 16).ok();
    let [r, g, b] = [byte(0)?, byte(1)?, byte(2)?].map(|byte| f32::from(byte) / 255.0);
    Some(linear_from_srgb(vec3(r, g, b)).to_f32())
}

/// Three numbers side by side, with what each is called.
pub fn triple<N: egui::emath::Numeric>(
    ui: &mut Ui,
    name: &str,
    values: &mut [N; 3],
    range: RangeInclusive<f64>,
    parts: [&str; 3],
) -> Response {
    let spacing = ui.spacing().item_spacing.x;
    let width = ((ui.available_width() - 2.0 * spacing) / 3.0).max(30.0);
    let mut whole: Option<Response> = None;
    for (value, part) in values.iter_mut().zip(parts) {
        let drag = DragValue::new(value).range(range.clone()).speed(0.01).max_decimals(3);
        let response = ui
            .add_sized(Vec2::new(width, ROW_HEIGHT), drag)
            .accessible_name(format!("{name}, {part}"));
        whole = Some(match whole {
            Some(whole) => whole.union(response),
            None => response,
        });
    }
    whole.unwrap_or_else(|| ui.label(""))
}

/// One of several: (value, label, help).
pub fn choice<T: PartialEq + Clone>(ui: &mut Ui, id: &str, value: &mut T, choices: &[(T, &str, &str)]) -> Response {
    let current = choices.iter().find(|(choice, ..)| choice == value);
    let mut changed = false;
    let width = ui.available_width();
    let shown = egui::ComboBox::from_id_salt(id)
        .width(width)
        .truncate()
        .selected_text(current.map_or("", |(_, label, _)| *label).to_owned())
        .show_ui(ui, |ui| {
            for (choice, label, help) in choices {
                let item = ui.selectable_label(choice == value, *label);
                let item = if help.is_empty() {
                    item
                } else {
                    item.on_hover_text(*help)
                };
                if item.clicked() {
                    // By the keyboard, too, which egui alone would leave it open for.
                    ui.close();
                    changed |= choice != value;
                    *value = choice.clone();
                }
            }
        });
    let mut response = shown.response;
    changed |= step_by_keys(ui, &response, value, choices);
    if changed {
        response.mark_changed();
    }
    response
}

/// The same as a menu within a menu; true where another one is chosen.
pub fn choice_menu<T: PartialEq + Clone>(ui: &mut Ui, label: &str, value: &mut T, choices: &[(T, &str, &str)]) -> bool {
    let before = value.clone();
    ui.menu_button(label, |ui| {
        for (choice, label, help) in choices {
            if ui.radio(choice == value, *label).on_hover_text(*help).clicked() {
                *value = choice.clone();
                // By the keyboard, too, which egui alone would leave it open for.
                ui.close();
            }
        }
    });
    *value != before
}

/// Up and down choose the neighbour, as in other programs.
fn step_by_keys<T: PartialEq + Clone>(
    ui: &Ui,
    response: &Response,
    value: &mut T,
    choices: &[(T, &str, &str)],
) -> bool {
    if !response.has_focus() {
        return false;
    }
    hold_arrows(ui, response, false, true);
    let pressed = |key| ui.input_mut(|input| input.count_and_consume_key(egui::Modifiers::NONE, key));
    let (down, up) = (pressed(egui::Key::ArrowDown), pressed(egui::Key::ArrowUp));
    let at = choices.iter().position(|(choice, ..)| choice == value).unwrap_or(0);
    let wanted = (at + down).saturating_sub(up).min(choices.len().saturating_sub(1));
    let Some((choice, ..)) = choices.get(wanted).filter(|_| wanted != at) else {
        return false;
    };
    *value = choice.clone();
    true
}

/// The heading of a group of rows, which opens and closes it.
pub fn group(ui: &mut Ui, title: &str, body: impl FnOnce(&mut Ui)) {
    group_open(ui, title, None, body);
}

/// The same, opened or closed by the program in this frame.
pub fn group_open(ui: &mut Ui, title: &str, opens: Option<bool>, body: impl FnOnce(&mut Ui)) {
    let request = requested(ui)
        .is_some_and(|requested| requested.group == title)
        .then_some(true);
    let header = RichText::new(title).strong();
    let shown = egui::CollapsingHeader::new(header)
        .id_salt(title)
        .default_open(opens.unwrap_or(true))
        .open(request.or(opens))
        .show_unindented(ui, |ui| {
            ui.add_space(2.0);
            body(ui);
            ui.add_space(theme::GAP);
        });
    show_focus(ui, &shown.header_response);
}

/// A frame around what has the keys, where egui draws it as if it had not.
fn show_focus(ui: &Ui, response: &Response) {
    if response.has_focus() {
        let stroke = egui::Stroke::new(1.0, theme::accent(ui.visuals().dark_mode));
        ui.painter()
            .rect_stroke(response.rect, 3.0, stroke, egui::StrokeKind::Inside);
    }
}

/// Content that appears and disappears by itself, such as answers of other threads, above controls that stay. egui
/// distinguishes controls by their order: without this those below would be others once it came, and a click, a drag or
/// the keys that one of them had would be lost.
pub fn comes_and_goes<R>(ui: &mut Ui, content: impl FnOnce(&mut Ui) -> R) -> R {
    let mut inside = ui.new_child(UiBuilder::new());
    let result = content(&mut inside);
    let taken = inside.min_rect();
    if taken.height() > 0.0 {
        ui.advance_cursor_after_rect(taken);
    } else {
        // Nothing takes no space, not even that between two widgets, but counts as one as well.
        ui.skip_ahead_auto_ids(1);
    }
    result
}

/// An image with a name beside it, to choose.
pub struct PictureRow<'a> {
    pub name: &'a str,
    /// What it is called where only one thing may have a name.
    pub full_name: &'a str,
    /// `None` until it is there.
    pub picture: Option<&'a TextureHandle>,
    /// Of the image, points.
    pub size: Vec2,
    /// Stands in for the image.
    pub color: Color32,
    pub is_current: bool,
}

impl PictureRow<'_> {
    pub fn show(&self, ui: &mut Ui) -> Response {
        let size = Vec2::new(ui.available_width(), self.size.y + 4.0);
        let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, self.is_current, self.full_name));
        let visuals = ui.style().interact_selectable(&response, self.is_current);
        if self.is_current || response.hovered() || response.has_focus() {
            ui.painter()
                .rect_filled(rect, visuals.corner_radius, visuals.weak_bg_fill);
        }
        let place = Rect::from_min_size(rect.left_top() + Vec2::new(4.0, 2.0), self.size);
        match self.picture {
            Some(picture) => egui::Image::new(picture).corner_radius(3.0).paint_at(ui, place),
            None => {
                let line = ui.visuals().widgets.noninteractive.bg_stroke;
                ui.painter()
                    .rect(place, 3.0, self.color, line, egui::StrokeKind::Inside);
            }
        }
        let font = TextStyle::Body.resolve(ui.style());
        let mut job = LayoutJob::simple_singleline(self.name.to_owned(), font, visuals.text_color());
        let left = place.right() + 10.0;
        job.wrap = egui::text::TextWrapping::truncate_at_width((rect.right() - left - 4.0).max(1.0));
        let galley = ui.painter().layout_job(job);
        let at = egui::pos2(left, rect.center().y - 0.5 * galley.size().y);
        ui.painter().galley(at, galley, visuals.text_color());
        response
    }
}

/// A field for a new name, which has the keys. `Some(None)`: left as it was.
pub fn name_field(ui: &mut Ui, name: &mut String) -> Option<Option<String>> {
    let is_done = text_field(ui, "New name", name)?;
    let name = name.trim().to_owned();
    Some((is_done && !name.is_empty()).then_some(name))
}

/// A field for words, which has the keys. `Some`: whether they are to count.
pub fn text_field(ui: &mut Ui, name: &str, text: &mut String) -> Option<bool> {
    let field = ui
        .add(egui::TextEdit::singleline(text).desired_width(f32::INFINITY))
        .accessible_name(name);
    if ui.input(|input| input.key_pressed(egui::Key::Escape)) {
        return Some(false);
    }
    if field.lost_focus() {
        return Some(true);
    }
    if !field.has_focus() {
        field.scroll_to_me(Some(Align::Center));
    }
    field.request_focus();
    None
}

/// Why work beside the window came to nothing, where it did.
pub fn failure(ui: &mut Ui, why: Option<String>) {
    if let Some(why) = why {
        ui.add(egui::Label::new(RichText::new(why).color(ui.visuals().error_fg_color)).wrap());
    }
}

/// A button with help; whether it was pressed.
pub fn pressed(ui: &mut Ui, text: impl Into<String>, help: &str) -> bool {
    ui.button(text.into()).on_hover_text(help).clicked()
}

/// Contents of a row from its right end.
pub fn at_right<R>(ui: &mut Ui, contents: impl FnOnce(&mut Ui) -> R) -> R {
    ui.with_layout(Layout::right_to_left(Align::Center), contents).inner
}

/// The choices of a closed list.
pub fn choices<T: Named>() -> Vec<(T, &'static str, &'static str)> {
    T::ALL
        .iter()
        .map(|choice| (*choice, choice.label(), choice.help()))
        .collect()
}

/// A note in weak text.
pub fn note(ui: &mut Ui, text: impl Into<String>) {
    ui.label(RichText::new(text).weak());
}
