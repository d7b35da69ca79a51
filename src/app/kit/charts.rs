//! Charts that panels share.

use std::ops::RangeInclusive;

use egui_plot::{GridInput, GridMark, Plot};

use crate::app::kit::words::{duration, percent_short};

/// The share of an axis at either end in which there are no labels: half of a label's height in a low chart.
const LABEL_GAP: f64 = 0.05;

/// A plot that stands still, of logarithms to base 10: seconds to the right, shares upwards; `axes` are the titles.
pub(in crate::app) fn log_log(name: &str, axes: [&str; 2], height: f32, margin: [f32; 2]) -> Plot<'static> {
    Plot::new(name)
        .height(height)
        .allow_drag(false)
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_boxed_zoom(false)
        .show_background(false)
        .x_axis_label(axes[0])
        .y_axis_label(axes[1])
        .x_grid_spacer(decades)
        .y_grid_spacer(decades)
        .x_axis_formatter(|mark: GridMark, range: &RangeInclusive<f64>| {
            label_within(mark.value, range, || duration(10.0_f64.powf(mark.value)))
        })
        .y_axis_formatter(|mark: GridMark, range: &RangeInclusive<f64>| {
            label_within(mark.value, range, || percent_short(10.0_f64.powf(mark.value)))
        })
        .set_margin_fraction(margin.into())
}

/// A mark's label, unless it is so near an end of the axis that it would be drawn over what stands beside the chart.
fn label_within(value: f64, range: &RangeInclusive<f64>, label: impl FnOnce() -> String) -> String {
    let gap = LABEL_GAP * (range.end() - range.start());
    if (range.start() + gap..=range.end() - gap).contains(&value) {
        label()
    } else {
        String::new()
    }
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
            let label = |value| label_within(value, &range, || "label".to_owned());
            assert_eq!(label(0.5 * (bounds.0 + bounds.1)), "label");
            assert_eq!([label(bounds.0), label(bounds.1)], ["", ""]);
        }
    }
}
