//! A curve drawn by hand: the density of D is linear between the nodes of a table.

use super::*;
use crate::optics::{real::inlined, table::NODE_LENGTH, table::look_up_number};

/// What is special about the curve.
pub const TRAITS: CurveTraits = CurveTraits {
    formula: "drawn",
    integral: Integral::Table,
    reach: None,
    plotted_max: f64::INFINITY,
};

/// Intervals of a custom curve's table, equal in D.
pub const CUSTOM_INTERVALS: usize = 64;
/// Numbers of a custom curve's table. Each interval has four: the cumulative distribution and the density where it begins,
/// the density where it ends, and D's maximum.
pub const CUSTOM_LENGTH: usize = NODE_LENGTH * CUSTOM_INTERVALS;

inlined! {
    /// The distance at which the cumulative distribution reaches ξ: a quadratic equation in the interval that bisection finds.
    pub fn distance<T: Real>(table: &[f32], xi: T) -> T {
        let c = T::from_f64;
        // Six halvings of 64 intervals; `low` counts those that end below ξ.
        let mut low = T::ZERO;
        let mut step = CUSTOM_INTERVALS / 2;
        while step > 0 {
            let middle = low + c(step as f64);
            let begin = look_up_number(table, 0, middle);
            low = T::select(xi.less(begin), low, middle);
            step /= 2;
        }
        let width = distance_max::<T>(table) * c(1.0 / CUSTOM_INTERVALS as f64);
        let (left, right) = (look_up_number(table, 1, low), look_up_number(table, 2, low));
        let missing = (xi - look_up_number(table, 0, low)).max(T::ZERO);
        let root = (left * left + c(2.0) * (right - left) / width * missing).safe_sqrt();
        let step = c(2.0) * missing / (left + root).max(c(1e-12));
        width * low + step.min(width)
    }

    pub fn distance_max<T: Real>(table: &[f32]) -> T {
        T::from_f64(f64::from(table[3]))
    }

    /// h(D).
    pub fn h<T: Real>(table: &[f32], distance: T) -> T {
        density(table, distance) / distance.max(T::from_f64(1e-6))
    }

    /// The density of D, linear between the nodes.
    fn density<T: Real>(table: &[f32], distance: T) -> T {
        let c = T::from_f64;
        let last = c(CUSTOM_INTERVALS as f64);
        let position = (distance / distance_max(table) * last).clamp(T::ZERO, last);
        let low = position.floor().min(last - T::ONE);
        let fraction = position - low;
        look_up_number(table, 1, low) * (T::ONE - fraction) + look_up_number(table, 2, low) * fraction
    }
}

/// A custom curve's table from the density of D at equidistant nodes over [0, `distance_max`] (65 values, not negative,
/// any scale: normalised here). Returns `None` where the density is zero everywhere or not finite.
pub fn custom_table(distance_max: f64, density: &[f64]) -> Option<Vec<f32>> {
    let width = distance_max / CUSTOM_INTERVALS as f64;
    let mut cumulative = vec![0.0; CUSTOM_INTERVALS + 1];
    for i in 0..CUSTOM_INTERVALS {
        cumulative[i + 1] = cumulative[i] + 0.5 * width * (density[i] + density[i + 1]);
    }
    let total = cumulative[CUSTOM_INTERVALS];
    if !(total.is_finite() && total > 0.0 && distance_max.is_finite() && density.iter().all(|f| *f >= 0.0)) {
        return None;
    }
    let interval = |i: usize| {
        [
            cumulative[i] / total,
            density[i] / total,
            density[i + 1] / total,
            distance_max,
        ]
    };
    let numbers = (0..CUSTOM_INTERVALS).flat_map(interval);
    Some(numbers.map(|number| number as f32).collect())
}
