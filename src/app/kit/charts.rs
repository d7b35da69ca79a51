//! Charts that panels share.

use std::ops::RangeInclusive;

use egui_plot::{AxisHints, GridInput, GridMark, Plot};

use crate::app::kit::words::{duration, percent_short};

/// The share of an axis at either end in which there are no labels: half of a label's height in a small chart.
const LABEL_GAP: f64 = 0.05;
/// Half of a character's width as a share of a small chart's.
const HALF_CHARACTER: f64 = 0.0135;
/// Least distances between two labels of an axis, points. What is not drawn in full is not drawn at all: egui's own labels
/// fade as they come near each other, until they can't be read.
const LABEL_SPACING: [f32; 2] = [36.0, 19.0];
/// The margin around what is drawn, as shares of it: the first and the last label stay within the chart.
const MARGIN: [f32; 2] = [0.07, 0.07];

/// A plot that stands still; what a number on either axis is called is up to the chart.
pub(in crate::app) fn still<'a>(name: &str, height: f32, in_words: [fn(f64) -> String; 2]) -> Plot<'a> {
    let formatter = |axis: usize| {
        move |mark: GridMark, range: &RangeInclusive<f64>| {
            let label = in_words[axis](mark.value);
            let length = if axis == 0 { label.chars().count() } else { 0 };
            let fits = is_within(mark.value, range, length);
            if fits { label } else { String::new() }
        }
    };
    let spacing = |axis: usize| egui::Rangef::new(LABEL_SPACING[axis] - 0.5, LABEL_SPACING[axis]);
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
        .set_margin_fraction(MARGIN.into())
}

/// A plot of logarithms to base 10 that stands still: seconds to the right, shares upwards; `axes` are the titles.
pub(in crate::app) fn log_log(name: &str, axes: [&str; 2], height: f32, margin: [f32; 2]) -> Plot<'static> {
    still(
        name,
        height,
        [|x| duration(10.0_f64.powf(x)), |y| percent_short(10.0_f64.powf(y))],
    )
    .x_axis_label(axes[0])
    .y_axis_label(axes[1])
    .x_grid_spacer(decades)
    .y_grid_spacer(decades)
    .set_margin_fraction(margin.into())
}

/// A number on an axis.
pub(in crate::app) fn short(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) {
        format!("{}", (value * 1e4).round() / 1e4)
    } else {
        format!("{value:.0e}")
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_stay_within_their_chart() {
        for bounds in [(-1.7, 0.4), (0.05, 0.2), (-3.0, 3.0)] {
            let marks = decades(GridInput {
                bounds,
                base_step_size: 1.0,
            });
            let range = bounds.0..=bounds.1;
            for mark in &marks {
                assert!(range.contains(&mark.value), "{mark:?} beside {bounds:?}");
            }
            let within = |value| is_within(value, &range, 5);
            assert!(within(0.5 * (bounds.0 + bounds.1)));
            assert!(!within(bounds.0) && !within(bounds.1));
        }
        // Wide labels end sooner: 34 points at 14 points from the end of a chart of 265.
        assert!(is_within(0.947, &(0.0..=1.0), 1) && !is_within(0.947, &(0.0..=1.0), "50 ms".len()));
    }
}
