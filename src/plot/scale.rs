//! Axes with round numbers on them, whether linear or logarithmic and however short.

use std::ops::Range;

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};

use super::figure::round_step;
use crate::plot::lobe_view::Axis;

/// Fewer round values on a logarithmic axis are too few to read it by.
const TICKS_MIN: usize = 4;

/// Where values lie along an axis.
#[derive(Clone, Debug)]
pub(super) struct Scale {
    range: [f64; 2],
    is_logarithmic: bool,
    ticks: Vec<f64>,
}

impl Scale {
    /// An axis with about as many ticks as `parts`.
    pub(super) fn new(axis: &Axis, parts: f64) -> Self {
        Self {
            range: axis.range,
            is_logarithmic: axis.is_logarithmic,
            ticks: ticks(axis, parts),
        }
    }

    /// From one value to another, without ticks.
    pub(super) fn bare(range: [f64; 2]) -> Self {
        Self {
            range,
            is_logarithmic: false,
            ticks: Vec::new(),
        }
    }
}

impl Ranged for Scale {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (first, last): (i32, i32)) -> i32 {
        // What is too small for a logarithm lies at the axis' beginning.
        let place = |x: f64| {
            if self.is_logarithmic {
                x.max(self.range[0]).log10()
            } else {
                x
            }
        };
        let [low, high] = self.range.map(place);
        let share = if high > low {
            (place(*value) - low) / (high - low)
        } else {
            0.5
        };
        (f64::from(first) + share * f64::from(last - first)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.range[0]..self.range[1]
    }
}

/// The values that are written at an axis.
fn ticks(axis: &Axis, parts: f64) -> Vec<f64> {
    let [low, high] = axis.range;
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
