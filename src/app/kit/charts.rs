//! Charts that panels share.

use std::ops::RangeInclusive;

use egui::*;
use egui_plot::{AxisHints, GridInput, GridMark, Line, Plot, PlotPoint, PlotTransform};

use crate::kit::words::{duration, percent_short};
pub(crate) use crate::plot::number as short;

/// The share of an axis at either end in which there are no labels: half of a label's height in a small chart.
const LABEL_GAP: f64 = 0.05;
/// Half of a character's width as a share of a small chart's.
const HALF_CHARACTER: f64 = 0.0135;
/// Least distances between two labels of an axis, points. What is not drawn in full is not drawn at all: egui's own labels
/// fade as they come near each other, until they can't be read.
const LABEL_SPACING: [f32; 2] = [36.0, 19.0];
/// Powers of ten along an axis of which each gets a label.
const POWERS_MAX: f64 = 6.5;

/// A plot that stands still; what a number on either axis is called is up to the chart.
pub fn still<'a, F>(name: &str, height: f32, in_words: [F; 2]) -> Plot<'a>
where
    F: Fn(f64) -> String + Clone + 'a,
{
    let formatter = |axis: usize| {
        let in_words = in_words[axis].clone();
        move |mark: GridMark, range: &RangeInclusive<f64>| {
            let label = in_words(mark.value);
            let length = if axis == 0 { label.chars().count() } else { 0 };
            let fits = is_within(mark.value, range, length);
            if fits { label } else { String::new() }
        }
    };
    let spacing = |axis: usize| Rangef::new(LABEL_SPACING[axis] - 0.5, LABEL_SPACING[axis]);
    let across = AxisHints::new_x().label_spacing(spacing(0)).formatter(formatter(0));
    let upwards = AxisHints::new_y().label_spacing(spacing(1)).formatter(formatter(1));
    Plot::new(name.to_owned())
        .height(height)
        .allow_drag(false)
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_boxed_zoom(false)
        .allow_double_click_reset(false)
        .show_background(false)
        .custom_x_axes(vec![across])
        .custom_y_axes(vec![upwards])
        .set_margin_fraction([0.07, 0.07].into())
}

/// A plot of logarithms to base 10 that stands still: seconds to the right, shares upwards; `axes` are the titles.
pub fn log_log(name: &str, axes: [&str; 2], height: f32, margin: [f32; 2]) -> Plot<'static> {
    let in_words: [fn(f64) -> String; 2] = [|x| duration(10.0_f64.powf(x)), |y| percent_short(10.0_f64.powf(y))];
    still(name, height, in_words)
        .x_axis_label(axes[0])
        .y_axis_label(axes[1])
        .x_grid_spacer(decades)
        .y_grid_spacer(decades)
        .set_margin_fraction(margin.into())
}

/// Least height of a chart, points.
pub const HEIGHT_MIN: f32 = 110.0;

/// Height of a chart: a share of the width that is left, but no more than the panel has beside the rest of its contents,
/// points.
pub fn height(ui: &Ui, share: f32, rest: f32) -> f32 {
    let room = ui.clip_rect().height() - rest;
    (share * ui.available_width()).min(room).clamp(HEIGHT_MIN, 420.0)
}

/// A line through points.
pub fn line(name: impl Into<String>, points: Vec<[f64; 2]>, color: Color32, width: f32) -> Line<'static> {
    Line::new(name, points).color(color).width(width)
}

/// How near to a point the pointer must be to take it, points.
const REACH: f32 = 14.0;

/// The point of a plot that is nearest to a place on the screen, if it is near.
pub fn nearest(points: &[[f64; 2]], transform: &PlotTransform, at: Pos2) -> Option<usize> {
    let distance = |[x, y]: &[f64; 2]| transform.position_from_point(&PlotPoint::new(*x, *y)).distance(at);
    let near = points.iter().map(distance).enumerate();
    let (index, distance) = near.min_by(|(_, a), (_, b)| a.total_cmp(b))?;
    (distance <= REACH).then_some(index)
}

/// The first round number that is not below this one: where an axis ends so that its last label is always seen.
pub fn rounded_up(value: f64) -> f64 {
    let power = 10.0_f64.powf(value.max(1e-9).log10().floor());
    let digits = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];
    let is_above = |digit: &f64| digit * power >= value * (1.0 - 1e-9);
    digits.into_iter().find(is_above).unwrap_or(10.0) * power
}

/// A line for each power of ten of an axis that counts them from 0, to either side; for every other one where they are
/// many.
pub fn powers(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let step = if high - low > POWERS_MAX { 2 } else { 1 };
    let marks = (low.ceil() as i32..=high.floor() as i32).filter(|power| power % step == 0);
    let mark = |power: i32| GridMark {
        value: power.into(),
        step_size: step.into(),
    };
    marks.map(mark).collect()
}

/// Whether a label of this many characters along its axis stays within the chart: other things are drawn beside it.
fn is_within(value: f64, range: &RangeInclusive<f64>, characters: usize) -> bool {
    let gap = LABEL_GAP.max(HALF_CHARACTER * characters as f64) * (range.end() - range.start());
    (range.start() + gap..=range.end() - gap).contains(&value)
}

/// A line for each power of ten, fainter ones for its 2 and 5: those that lie in the chart, as labels of others would be
/// drawn beside it.
fn decades(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let (first, last) = (low.floor() as i32, high.ceil() as i32);
    let marks = (first..=last).flat_map(|decade| {
        [(1.0_f64, 1.0), (2.0, 0.3), (5.0, 0.3)].map(|(digit, step_size)| GridMark {
            value: f64::from(decade) + digit.log10(),
            step_size,
        })
    });
    marks.filter(|mark| (low..=high).contains(&mark.value)).collect()
}
