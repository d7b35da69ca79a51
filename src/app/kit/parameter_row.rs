//! The row of a parameter, of a material or of a document: the control that suits its kind.

use egui::*;

use crate::{
    document::{Kind, Parameter, Value, parameter::Precision, parameter::RowStyle},
    kit::{theme::ROW_HEIGHT, widgets, widgets::Name, widgets::NumberStyle},
};

/// Whether a parameter can be edited in a row; what depends on the scene has controls of its own.
pub fn has_row<T>(parameter: &Parameter<T>) -> bool {
    match &parameter.kind {
        Kind::Curve => false,
        // The f-number stands for it.
        _ if parameter.key == "camera.aperture" => false,
        Kind::Optional { kind, at_first, .. } => at_first.is_some() || matches!(**kind, Kind::Toggle),
        _ => true,
    }
}

/// A square behind a row's control, which is shown by a function.
pub type Beside<'a> = Option<&'a mut dyn FnMut(&mut Ui)>;

/// Shows the row of a parameter of something, under a name that is unique in the window; true where it was edited.
pub fn edit<T: Default>(ui: &mut Ui, parameter: &Parameter<T>, full: &str, of: &mut T, beside: Beside) -> bool {
    edit_from(ui, parameter, full, of, (parameter.default_value(), beside))
}

/// The same, reset to a value of its own.
pub fn edit_from<T: Default>(
    ui: &mut Ui,
    parameter: &Parameter<T>,
    full: &str,
    of: &mut T,
    (default, beside): (Value, Beside),
) -> bool {
    let mut value = parameter.get(of);
    let name = Name {
        full,
        label: parameter.label,
        symbol: parameter.symbol,
        help: parameter.help,
    };
    let is_edited = widgets::value_row(ui, name, &mut value, default, |ui, value| {
        let Some(beside) = beside else {
            return control(ui, parameter, full, value);
        };
        let width = ui.available_width() - ROW_HEIGHT - ui.spacing().item_spacing.x;
        let response = widgets::sized(ui, width.max(1.0), |ui| control(ui, parameter, full, value));
        beside(ui);
        response
    });
    // A picker's colour may be out of range for a moment.
    is_edited && parameter.set(of, value).is_ok()
}

/// The control of a parameter, under a name that is unique in the window.
pub fn control<T>(ui: &mut Ui, parameter: &Parameter<T>, name: &str, value: &mut Value) -> Response {
    of_kind(ui, &parameter.kind, &parameter.row, name, value)
}

fn of_kind(ui: &mut Ui, kind: &Kind, row: &RowStyle, full: &str, value: &mut Value) -> Response {
    match (kind, value) {
        (Kind::Number { range, unit, precision }, Value::Number(x)) if *precision == Precision::Whole => {
            let (whole, mut n) = (RowStyle { decimals: 0, ..*row }, *x as u32);
            let response = number(ui, &mut n, *range, unit, &whole);
            *x = n.into();
            response
        }
        (Kind::Number { range, unit, .. }, Value::Number(x)) => number(ui, x, *range, unit, row),
        (Kind::Color { most }, Value::Color(linear)) => {
            // A colour of at most 1 is picked; what it is multiplied by stays.
            let strength = linear.iter().fold(1.0_f32, |most, x| most.max(*x));
            let shown = linear.map(|x| x / strength);
            let mut picked = shown;
            let response = widgets::color(ui, full, &mut picked);
            if picked != shown {
                *linear = picked.map(|x| (x * strength).clamp(0.0, *most));
            }
            response
        }
        (Kind::Triple { range }, Value::Triple(values)) => {
            let range = f64::from(range[0])..=f64::from(range[1]);
            widgets::triple(ui, full, values, range, ["red", "green", "blue"])
        }
        (Kind::Place { range }, Value::Place(place)) => {
            widgets::triple(ui, full, place, range[0]..=range[1], ["x", "y", "z"])
        }
        (Kind::Choice(choices), Value::Choice(name)) => {
            let choices = choices.iter().map(|choice| (choice.name, choice.label, choice.help));
            widgets::choice(ui, full, name, &choices.collect::<Vec<_>>())
        }
        (Kind::Toggle, Value::Toggle(is_on)) => ui.checkbox(is_on, ""),
        (Kind::Optional { kind, .. }, value) if matches!(**kind, Kind::Toggle) => {
            let choices = [
                (Value::Absent, "Automatic", "As the program sees fit."),
                (Value::Toggle(true), "On", ""),
                (Value::Toggle(false), "Off", ""),
            ];
            widgets::choice(ui, full, value, &choices)
        }
        (Kind::Optional { kind, at_first, .. }, value) => {
            optional(ui, kind, row, full, value, at_first.as_ref().unwrap_or(&Value::Absent))
        }
        (Kind::Curve, Value::Curve(points)) => ui.label(format!("{} points", points.len())),
        // A test of the tables keeps kinds and values together.
        _ => ui.label("not shown"),
    }
}

/// A switch and, where it is on, the value beside it.
fn optional(ui: &mut Ui, kind: &Kind, row: &RowStyle, full: &str, value: &mut Value, at_first: &Value) -> Response {
    let mut is_on = *value != Value::Absent;
    let mut switch = ui.checkbox(&mut is_on, "");
    if switch.changed() {
        *value = if is_on { at_first.clone() } else { Value::Absent };
    }
    if *value != Value::Absent {
        let control = of_kind(ui, kind, row, full, value).accessible_name(format!("{full} value"));
        if control.changed() {
            switch.mark_changed();
        }
    }
    switch
}

fn number<N: egui::emath::Numeric>(
    ui: &mut Ui,
    value: &mut N,
    [low, high]: [f64; 2],
    unit: &str,
    row: &RowStyle,
) -> Response {
    let space = if unit.is_empty() || unit == "°" { "" } else { " " };
    let unit = format!("{space}{unit}");
    if !row.is_percent {
        let style = NumberStyle::plain(low..=high, &unit, row.step, row.decimals).with_bar(row.bar);
        return widgets::number(ui, value, &style);
    }
    let style = NumberStyle::plain(100.0 * low..=100.0 * high, " %", row.step, row.decimals)
        .with_bar(row.bar.map(|bar| bar.map(|end| 100.0 * end)));
    let of_percent = |percent: f64| N::from_f64((0.01 * percent).clamp(low, high));
    widgets::number_as(ui, value, &style, |value| 100.0 * value.to_f64(), of_percent)
}
