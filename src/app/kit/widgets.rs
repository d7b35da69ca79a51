//! The rows that panels are made of: a label, which explains and resets, and a control, which is named after it.

use std::ops::RangeInclusive;

use egui::*;
use egui::{emath::Numeric, text::LayoutJob};

use crate::{
    kit::{
        keys::{fulfil_request, hold_arrows, note_requested, requested},
        theme,
        theme::ROW_HEIGHT,
    },
    named::Named,
    optics::tone::{linear_from_srgb, srgb_from_linear},
    optics::vector::vec3,
};

/// The share of a row that its label takes.
const LABEL_SHARE: f32 = 0.40;
/// The least width of a label, points.
const LABEL_MIN: f32 = 64.0;
/// Width of a colour's swatch beside its code at least, points.
const SWATCH_MIN: f32 = 26.0;
/// Width of a colour's hexadecimal field, points.
const HEX_WIDTH: f32 = 68.0;

/// What a row is called and explains.
#[derive(Clone, Copy, Default)]
pub struct Name<'a> {
    /// The name for screen readers and tests; unique in the window.
    pub full: &'a str,
    pub label: &'a str,
    /// A symbol behind it, or empty.
    pub symbol: &'a str,
    /// What it does to the image.
    pub help: &'a str,
}

impl<'a> From<[&'a str; 3]> for Name<'a> {
    fn from([full, label, help]: [&'a str; 3]) -> Self {
        let symbol = "";
        Self {
            full,
            label,
            symbol,
            help,
        }
    }
}

/// A label and a control that fills the rest of the row; true where the control changed what it shows.
pub fn row<'a>(ui: &mut Ui, name: impl Into<Name<'a>>, control: impl FnOnce(&mut Ui) -> Response) -> bool {
    resettable(ui, name, control)[0]
}

/// Such a row that double-clicking the label, or its menu, resets: whether it was changed, and is to be reset.
fn resettable<'a>(ui: &mut Ui, name: impl Into<Name<'a>>, control: impl FnOnce(&mut Ui) -> Response) -> [bool; 2] {
    let name = name.into();
    ui.horizontal(|ui| {
        let is_requested = fulfil_request(ui, name.full);
        let label_width = (ui.available_width() * LABEL_SHARE).max(LABEL_MIN);
        let label = row_label(ui, name, label_width);
        let width = ui.available_width().max(40.0);
        let control = sized(ui, width, control);
        let changed = control.changed();
        let control = control.accessible_name(name.full);
        if is_requested {
            note_requested(ui, &control);
        }
        explained(control, name.help);
        let mut reset = label.double_clicked();
        label.context_menu(|ui| reset |= entry(ui, "Reset to default", ""));
        [changed, reset]
    })
    .inner
}

/// The row of a value with its default; true where it is another afterwards.
pub fn value_row<'a, T>(
    ui: &mut Ui,
    name: impl Into<Name<'a>>,
    value: &mut T,
    default: T,
    control: impl FnOnce(&mut Ui, &mut T) -> Response,
) -> bool {
    let [changed, reset] = resettable(ui, name, |ui| control(ui, value));
    if reset {
        *value = default;
    }
    changed || reset
}

/// The row of a number.
pub fn number_row<N: Numeric>(ui: &mut Ui, name: [&str; 3], value: &mut N, default: N, style: &NumberStyle) -> bool {
    value_row(ui, name, value, default, |ui, value| number(ui, value, style))
}

/// The row of a closed list.
pub fn choice_row<T: Named + Default>(ui: &mut Ui, name: [&str; 3], value: &mut T) -> bool {
    value_row(ui, name, value, T::default(), |ui, value| {
        choice(ui, name[0], value, &choices())
    })
}

/// Contents of a row's height and of a width, points.
pub fn sized<R>(ui: &mut Ui, width: f32, contents: impl FnOnce(&mut Ui) -> R) -> R {
    let layout = Layout::left_to_right(Align::Center);
    ui.allocate_ui_with_layout(Vec2::new(width, ROW_HEIGHT), layout, contents)
        .inner
}

/// With help, where there is any.
pub fn explained(response: Response, help: &str) -> Response {
    match help {
        "" => response,
        _ => response.on_hover_text(help),
    }
}

fn row_label(ui: &mut Ui, name: Name, width: f32) -> Response {
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
    // Not a stop of the tab key: a press of a key on it would do nothing.
    let label = Label::new(job).truncate().selectable(false).sense(Sense::CLICK);
    let response = sized(ui, width, |ui| {
        ui.set_min_width(width);
        ui.add(label)
    });
    let help = if name.help.is_empty() { name.label } else { name.help };
    response.on_hover_ui(|ui| {
        ui.set_max_width(ui.spacing().tooltip_width);
        ui.label(help);
        ui.label(RichText::new("Double-click to reset").weak().small());
    })
}

/// How a number is edited.
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
    /// A word in place of 0.
    pub zero: Option<&'static str>,
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
            zero: None,
        }
    }

    /// The same with a bar that spans this, if anything.
    pub fn with_bar(self, bar: impl Into<Option<[f64; 2]>>) -> Self {
        let bar = bar.into();
        Self { bar, ..self }
    }
}

/// A number as a bar to drag (with shift: finely) or to type into.
pub fn number<N: Numeric>(ui: &mut Ui, value: &mut N, style: &NumberStyle) -> Response {
    let size = Vec2::new(ui.available_width(), ROW_HEIGHT);
    // Set once it is known whether the pointer is over it and what the bar fills.
    let field = ui.painter().add(Shape::Noop);
    let mut speed = style.speed;
    let span = style.bar.map(|[low, high]| {
        speed = (high - low) / f64::from(size.x.max(40.0));
        let share = |value: f64| ((value - low) / (high - low)).clamp(0.0, 1.0) as f32;
        // Signed numbers fill from zero.
        [share(0.0_f64.clamp(low, high)), share(value.to_f64())]
    });
    let drag = DragValue::new(value)
        .range(style.range.clone())
        .speed(speed)
        .custom_formatter(|value, _| match style.zero {
            Some(word) if value == 0.0 => word.to_owned(),
            _ => trimmed(value, style.decimals),
        })
        .suffix(style.unit.to_owned());
    let response = ui.scope(|ui| {
        let widgets = &mut ui.visuals_mut().widgets;
        for state in [&mut widgets.inactive, &mut widgets.hovered, &mut widgets.active] {
            state.weak_bg_fill = Color32::TRANSPARENT;
        }
        ui.add_sized(size, drag)
    });
    let response = response.inner;
    let (rect, state) = (response.rect, ui.style().interact(&response));
    let mut shapes = vec![Shape::rect_filled(rect, state.corner_radius, state.weak_bg_fill)];
    if let Some([from, to]) = span {
        let x = |share: f32| lerp(rect.x_range(), share);
        let filled = Rect::from_x_y_ranges(x(from.min(to))..=x(from.max(to)), rect.y_range());
        let color = theme::accent(ui).gamma_multiply(if response.hovered() { 0.62 } else { 0.5 });
        shapes.push(bar(rect, filled, color, state.corner_radius));
    }
    ui.painter().set(field, Shape::Vec(shapes));
    response
}

/// A number that stands for a value, such as its percentage.
pub fn number_as<T: Copy>(
    ui: &mut Ui,
    value: &mut T,
    style: &NumberStyle,
    shown: impl FnOnce(T) -> f64,
    of_shown: impl FnOnce(f64) -> T,
) -> Response {
    let mut edited = shown(*value);
    let response = number(ui, &mut edited, style);
    if response.changed() {
        *value = of_shown(edited);
    }
    response
}

/// A number that follows another one until it is changed.
pub fn number_following<N: Numeric>(ui: &mut Ui, value: &mut Option<N>, otherwise: N, style: &NumberStyle) -> Response {
    let mut edited = value.unwrap_or(otherwise);
    let response = number(ui, &mut edited, style);
    if response.changed() {
        *value = Some(edited);
    }
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

/// The filled part of a field, round where it reaches the field's ends.
fn bar(field: Rect, filled: Rect, color: Color32, radius: CornerRadius) -> Shape {
    let (mut left, mut right) = (0, 0);
    if filled.right() >= field.right() - 1.0 {
        right = radius.ne;
    }
    if filled.left() <= field.left() + 1.0 && filled.width() >= 3.0 {
        left = radius.nw;
    }
    let corners = CornerRadius {
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
    let swatch = ui.scope(|ui| {
        ui.spacing_mut().interact_size.x = swatch_width;
        ui.color_edit_button_rgb(&mut picked)
    });
    let mut swatch = swatch.inner;
    if std::iter::zip(picked, *linear).any(|(new, old)| (new - old).abs() > PICKER_ROUNDING) {
        *linear = picked;
    }
    // A colour like the panel's would not be seen as a field.
    let line = ui.visuals().widgets.noninteractive.bg_stroke;
    let radius = ui.visuals().widgets.inactive.corner_radius;
    ui.painter().rect_stroke(swatch.rect, radius, line, StrokeKind::Inside);
    show_focus(ui, &swatch);
    if has_code && hex_field(ui, name, linear) {
        swatch.mark_changed();
    }
    swatch
}

fn hex_field(ui: &mut Ui, name: &str, linear: &mut [f32; 3]) -> bool {
    let id = ui.make_persistent_id((name, "hex"));
    let shown = hex_of(*linear);
    let typed: Option<String> = ui.data(|data| data.get_temp(id));
    let mut text = typed.unwrap_or_else(|| shown.clone());
    let field = TextEdit::singleline(&mut text)
        .id(id.with("field"))
        .font(TextStyle::Monospace)
        .desired_width(HEX_WIDTH)
        .margin(Vec2::new(4.0, 3.0));
    let response = ui.add(field).accessible_name(format!("{name}, sRGB code"));
    let parsed = linear_of(&text).filter(|parsed| response.changed() && hex_of(*parsed) != shown);
    if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, text));
    } else {
        ui.data_mut(|data| data.remove::<String>(id));
    }
    *linear = parsed.unwrap_or(*linear);
    parsed.is_some()
}

/// `#rrggbb` in sRGB.
fn hex_of(linear: [f32; 3]) -> String {
    let [r, g, b, _] = shown(linear).to_array();
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A linear colour as the screen shows it.
pub fn shown([r, g, b]: [f32; 3]) -> Color32 {
    let encoded = srgb_from_linear(vec3(r, g, b)).to_f32();
    rgb(encoded.map(|x| (255.0 * x.clamp(0.0, 1.0) + 0.5) as u8))
}

/// A colour by its sRGB bytes.
pub fn rgb([r, g, b]: [u8; 3]) -> Color32 {
    Color32::from_rgb(r, g, b)
}

fn linear_of(text: &str) -> Option<[f32; 3]> {
    let digits = text.trim().trim_start_matches('#');
    let code = u32::from_str_radix(digits, 16).ok().filter(|_| digits.len() == 6)?;
    let [_, r, g, b] = code.to_be_bytes().map(|byte| f32::from(byte) / 255.0);
    Some(linear_from_srgb(vec3(r, g, b)).to_f32())
}

/// Least width of a number of three digits behind the point, and the space around it, points.
const TRIPLE_MIN: f32 = 38.0;
const TRIPLE_SPACING: f32 = 3.0;

/// Three numbers with what each is called: side by side, or where there is no room one below the other.
pub fn triple<N: Numeric>(
    ui: &mut Ui,
    name: &str,
    values: &mut [N; 3],
    range: RangeInclusive<f64>,
    parts: [&str; 3],
) -> Response {
    let whole = ui.available_width();
    let third = (whole - 2.0 * TRIPLE_SPACING) / 3.0;
    let has_room = third >= TRIPLE_MIN;
    let size = Vec2::new(if has_room { third } else { whole }, ROW_HEIGHT);
    let numbers = |ui: &mut Ui| {
        let spacing = ui.spacing_mut();
        (spacing.item_spacing.x, spacing.button_padding.x) = (TRIPLE_SPACING, TRIPLE_SPACING);
        spacing.interact_size.x = size.x;
        let responses = values.iter_mut().zip(parts).map(|(value, part)| {
            let drag = DragValue::new(value).range(range.clone()).speed(0.01).max_decimals(3);
            ui.add_sized(size, drag).accessible_name(format!("{name}, {part}"))
        });
        responses.reduce(|whole, response| whole.union(response))
    };
    let shown = if has_room {
        ui.horizontal(numbers)
    } else {
        ui.vertical(numbers)
    };
    shown.inner.unwrap_or(shown.response)
}

/// One of several: (value, label, help).
pub fn choice<T: PartialEq + Clone>(ui: &mut Ui, id: &str, value: &mut T, choices: &[(T, &str, &str)]) -> Response {
    let before = value.clone();
    let at = choices.iter().position(|(choice, ..)| *choice == before);
    let shown = ComboBox::from_id_salt(id)
        .width(ui.available_width())
        .truncate()
        .selected_text(at.map_or("", |at| choices[at].1))
        .show_ui(ui, |ui| {
            for (choice, label, help) in choices {
                let item = ui.selectable_label(*choice == before, *label);
                if explained(item, help).clicked() {
                    // By the keyboard, too, which egui alone would leave it open for.
                    ui.close();
                    *value = choice.clone();
                }
            }
        });
    let mut response = shown.response;
    if response.has_focus() {
        // Up and down choose the neighbour, as in other programs.
        hold_arrows(ui, &response, false, true);
        let pressed = |key| ui.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, key));
        let (down, up) = (pressed(Key::ArrowDown), pressed(Key::ArrowUp));
        let wanted = (at.unwrap_or(0) + down).saturating_sub(up);
        if let Some((choice, ..)) = choices.get(wanted.min(choices.len().saturating_sub(1)))
            && down + up > 0
        {
            *value = choice.clone();
        }
    }
    if *value != before {
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

/// The heading of a group of rows, which opens and closes it.
pub fn group(ui: &mut Ui, title: &str, body: impl FnOnce(&mut Ui)) {
    group_open(ui, title, None, body);
}

/// The same, opened or closed by the program in this frame.
pub fn group_open(ui: &mut Ui, title: &str, opens: Option<bool>, body: impl FnOnce(&mut Ui)) {
    let is_requested = requested(ui).is_some_and(|requested| requested.group == title);
    // egui's heading would be as wide as its text.
    let header = WidgetText::from(RichText::new(title).strong());
    let width = ui.available_width() - ui.spacing().indent - ui.spacing().button_padding.x;
    let header = header.into_galley(ui, Some(TextWrapMode::Truncate), width, TextStyle::Button);
    let is_cut = header.elided;
    let mut shown = CollapsingHeader::new(header)
        .id_salt(title)
        .default_open(opens.unwrap_or(true))
        .open(is_requested.then_some(true).or(opens))
        .show_unindented(ui, |ui| {
            ui.add_space(2.0);
            body(ui);
            ui.add_space(theme::GAP);
        });
    if is_cut {
        shown.header_response = shown.header_response.on_hover_text(title);
    }
    show_focus(ui, &shown.header_response);
}

/// A frame around what has the keys, where egui draws it as if it had not.
pub fn show_focus(ui: &Ui, response: &Response) {
    if response.has_focus() {
        frame(ui, response.rect);
    }
}

pub fn frame(ui: &Ui, rect: Rect) {
    let stroke = Stroke::new(1.0, theme::accent(ui));
    ui.painter().rect_stroke(rect, 3.0, stroke, StrokeKind::Inside);
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

/// A field for a new name, which has the keys. `Some(None)`: left as it was.
pub fn name_field(ui: &mut Ui, name: &mut String) -> Option<Option<String>> {
    let field = wide_field(ui, name, "New name");
    if ui.input(|input| input.key_pressed(Key::Escape)) {
        return Some(None);
    }
    if field.lost_focus() {
        return Some(Some(name.trim().to_owned()).filter(|name| !name.is_empty()));
    }
    if !field.has_focus() {
        field.scroll_to_me(Some(Align::Center));
        // What is typed replaces the old name.
        select(ui.ctx(), field.id, [0, name.chars().count()]);
    }
    field.request_focus();
    None
}

/// Selects a field's text from one place to another.
pub fn select(ctx: &Context, field: Id, places: [usize; 2]) {
    let [from, to] = places.map(text::CCursor::new);
    let mut state = text_edit::TextEditState::load(ctx, field).unwrap_or_default();
    state.cursor.set_char_range(Some(text::CCursorRange::two(from, to)));
    state.store(ctx, field);
}

/// A field for words over the width that is left, and what it is called.
pub fn wide_field(ui: &mut Ui, text: &mut String, name: &str) -> Response {
    let field = TextEdit::singleline(text).desired_width(f32::INFINITY);
    ui.add(field).accessible_name(name)
}

/// Why work beside the window came to nothing, where it did.
pub fn failure(ui: &mut Ui, why: impl Into<Option<String>>) {
    if let Some(why) = why.into() {
        ui.colored_label(ui.visuals().error_fg_color, why);
    }
}

/// What is to be looked at.
pub fn warning(ui: &mut Ui, text: impl Into<String>) -> Response {
    ui.colored_label(ui.visuals().warn_fg_color, text.into())
}

/// A text in one line, as far as it goes.
pub fn line(ui: &mut Ui, text: impl Into<WidgetText>) -> Response {
    ui.add(Label::new(text).truncate())
}

/// Says what something that is drawn by hand is.
pub fn describe(response: &Response, role: Role, name: &str) {
    response.widget_info(|| WidgetInfo::labeled(role, true, name));
}

/// Contents of which the identity does not follow from what stands before them, which comes and goes.
pub fn known_by<R>(ui: &mut Ui, id: impl std::hash::Hash + std::fmt::Debug, contents: impl FnOnce(&mut Ui) -> R) -> R {
    let builder = UiBuilder::new().scope_id(Id::unique(id));
    ui.scope_builder(builder, contents).inner
}

/// A button with help; whether it was pressed.
pub fn pressed(ui: &mut Ui, text: impl Into<String>, help: &str) -> bool {
    ui.button(text.into()).on_hover_text(help).clicked()
}

/// A button that can be pressed where it is possible, and else says why not; whether it was pressed.
pub fn pressed_if(ui: &mut Ui, is_possible: bool, text: impl Into<String>, help: &str, why_not: &str) -> bool {
    let button = ui.add_enabled(is_possible, Button::new(text.into()));
    let button = explained(button, help);
    match why_not {
        "" => button.clicked(),
        _ => button.on_disabled_hover_text(why_not).clicked(),
    }
}

/// An entry of a menu, which closes that, by the keyboard, too, for which egui waits for a click; whether it was chosen.
pub fn entry(ui: &mut Ui, text: impl Into<String>, help: &str) -> bool {
    let is_chosen = explained(ui.button(text.into()), help).clicked();
    if is_chosen {
        ui.close();
    }
    is_chosen
}

/// A button that brings a file back that was removed, where there is one; whether it was pressed.
pub fn restores(ui: &mut Ui, removed: Option<&std::path::Path>) -> bool {
    let name = removed.and_then(|path| path.file_stem());
    name.is_some_and(|name| ui.button(format!("Restore {}", name.to_string_lossy())).clicked())
}

/// Contents of a row from its right end.
pub fn at_right<R>(ui: &mut Ui, contents: impl FnOnce(&mut Ui) -> R) -> R {
    ui.with_layout(Layout::right_to_left(Align::Center), contents).inner
}

/// The choices of a closed list.
pub fn choices<T: Named>() -> Vec<(T, &'static str, &'static str)> {
    let choices = T::ALL.iter();
    choices.map(|choice| (*choice, choice.label(), choice.help())).collect()
}

/// A colour, in a frame: one like the panel's would not be seen.
pub fn swatch(ui: &mut Ui, size: Vec2, color: Color32) {
    let (place, _) = ui.allocate_exact_size(size, Sense::hover());
    let line = ui.visuals().widgets.noninteractive.bg_stroke;
    ui.painter().rect(place, 3.0, color, line, StrokeKind::Inside);
}

/// Whether a click chooses something beside what is chosen.
pub fn is_beside_others(ui: &Ui) -> bool {
    ui.input(|input| input.modifiers.command || input.modifiers.shift)
}

/// The rank to which parts fit into a room with all that rank before them, points.
pub fn fitting<R: Ord + Copy>(mut parts: Vec<(R, f32)>, room: f32) -> Option<R> {
    parts.sort_by_key(|(rank, _)| *rank);
    let mut left = room;
    let fits = |of_rank: &&[(R, f32)]| {
        left -= of_rank.iter().map(|(_, width)| width).sum::<f32>();
        left >= 0.0
    };
    let of_ranks = parts.chunk_by(|a, b| a.0 == b.0).take_while(fits);
    of_ranks.last().map(|of_rank| of_rank[0].0)
}

/// A note in weak text.
pub fn note(ui: &mut Ui, text: impl Into<String>) {
    ui.label(RichText::new(text).weak());
}
