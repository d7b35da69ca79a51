//! Two axes with their marks, and what is drawn between them.

use super::drawing::{CENTER, Drawing, Point, RIGHT, TOP};
use super::lobe_view::Axis;

/// Marks of a logarithmic axis, at least.
const TICKS_MIN: usize = 4;

/// Where values are in a drawing.
pub struct Frame<'a> {
    axes: [&'a Axis; 2],
    /// Left and right, bottom and top.
    ends: [[f64; 2]; 2],
}

impl Frame<'_> {
    /// Where a pair of values is; at an end of its axis where it is beyond.
    pub fn at(&self, values: [f64; 2]) -> Point {
        [0, 1].map(|i| {
            let (axis, [start, end]) = (self.axes[i], self.ends[i]);
            let whole = axis.radius(axis.range[1]).max(f64::MIN_POSITIVE);
            start + (end - start) * axis.radius(values[i]) / whole
        })
    }
}

impl Drawing {
    /// Draws axes of about so many `parts`, none where it is 0, between top left and bottom right.
    pub fn framed<'a>(
        &mut self,
        title: &str,
        axes: [&'a Axis; 2],
        parts: [f64; 2],
        [[left, top], [right, bottom]]: [Point; 2],
    ) -> Frame<'a> {
        let frame = Frame {
            axes,
            ends: [[left, right], [bottom, top]],
        };
        let middle = [0.5 * (left + right), 0.5 * (top + bottom)];
        let (ink, faint) = (self.colors.ink, self.colors.faint);
        self.text(title, [middle[0], top - 24.0], 22.0, CENTER);
        for tick in ticks(axes[0], parts[0]) {
            let [x, _] = frame.at([tick, 0.0]);
            self.line([[x, top], [x, bottom]], faint, 1.0);
            self.text(number(tick), [x, bottom + 5.0], 14.0, TOP);
        }
        for tick in ticks(axes[1], parts[1]) {
            let [_, y] = frame.at([0.0, tick]);
            self.line([[left, y], [right, y]], faint, 1.0);
            self.text(number(tick), [left - 8.0, y], 14.0, RIGHT);
        }
        self.line([[left, top], [left, bottom], [right, bottom]], ink, 1.0);
        self.text(axes[0].label.as_str(), [middle[0], bottom + 34.0], 15.0, CENTER);
        self.upright_text(&axes[1].label, [left - 60.0, middle[1]], 15.0);
        frame
    }
}

/// Round values of an axis.
fn ticks(axis: &Axis, parts: f64) -> Vec<f64> {
    let [low, high] = axis.range;
    if parts == 0.0 {
        return Vec::new();
    }
    if axis.is_logarithmic {
        for digits in [&[1.0][..], &[1.0, 2.0, 5.0], &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0]] {
            let decades = low.log10().floor() as i32..=high.log10().ceil() as i32;
            let round = decades.flat_map(|power| digits.iter().map(move |digit| digit * 10.0_f64.powi(power)));
            let round: Vec<f64> = round.filter(|value| (low..=high).contains(value)).collect();
            if round.len() >= TICKS_MIN {
                return round;
            }
        }
    }
    let step = round_step(high - low, parts);
    let [first, last] = [(low / step - 1e-9).ceil(), (high / step + 1e-9).floor()].map(|tick| tick as i64);
    (first..=last).map(|tick| step * tick as f64).collect()
}

/// A round step that divides a range into at most so many parts.
pub fn round_step(value: f64, parts: f64) -> f64 {
    let rough = value / parts;
    let power = 10.0_f64.powf(rough.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * power);
    steps
        .into_iter()
        .find(|step| *step >= rough * 0.999)
        .unwrap_or(10.0 * power)
}

/// A number as short as it can be read.
pub fn number(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e5).contains(&size) {
        let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
        return format!("{rounded:e}");
    }
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Three digits of a number.
pub fn short(value: f64) -> String {
    number(format!("{value:.2e}").parse().unwrap_or(value))
}
