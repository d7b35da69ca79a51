//! A curve drawn by hand: the density of D is linear between the nodes of a table.

use super::{CurveTraits, Integral};
use crate::optics::real::Real;

/// What is special about the curve.
pub const TRAITS: CurveTraits = CurveTraits {
    formula: "drawn",
    integral: Integral::Table,
    plotted_max: f64::INFINITY,
};

/// Intervals of a custom curve's table, equal in D.
pub const CUSTOM_INTERVALS: usize = 64;
/// Numbers of a custom curve's table: D's maximum, then at each node the cumulative distribution, then the density.
pub const CUSTOM_LENGTH: usize = 1 + 2 * (CUSTOM_INTERVALS + 1);

/// The distance at which the cumulative distribution reaches ξ: a quadratic equation in the interval that bisection finds.
#[inline(always)]
pub fn distance<T: Real>(table: &[f32], xi: T) -> T {
    let c = T::from_f64;
    // Six halvings of 64 intervals; `low` counts the nodes that lie below ξ.
    let mut low = T::zero();
    let mut step = CUSTOM_INTERVALS / 2;
    while step > 0 {
        let middle = low + c(step as f64);
        let node = T::look_up(&table[1..], middle);
        low = T::select(xi.less(node), low, middle);
        step /= 2;
    }
    let width = distance_max::<T>(table) * c(1.0 / CUSTOM_INTERVALS as f64);
    let (left, right) = (
        T::look_up(&table[CUSTOM_INTERVALS + 2..], low),
        T::look_up(&table[CUSTOM_INTERVALS + 3..], low),
    );
    let missing = (xi - T::look_up(&table[1..], low)).max(T::zero());
    let root = (left * left + c(2.0) * (right - left) / width * missing).safe_sqrt();
    let step = c(2.0) * missing / (left + root).max(c(1e-12));
    width * low + step.min(width)
}

/// D's maximum.
#[inline(always)]
pub fn distance_max<T: Real>(table: &[f32]) -> T {
    T::from_f64(f64::from(table[0]))
}

/// h(D).
#[inline(always)]
pub fn h<T: Real>(table: &[f32], distance: T) -> T {
    density(table, distance) / distance.max(T::from_f64(1e-6))
}

/// The density of D, linear between the nodes.
#[inline(always)]
fn density<T: Real>(table: &[f32], distance: T) -> T {
    let c = T::from_f64;
    let last = c(CUSTOM_INTERVALS as f64);
    let position = (distance / distance_max(table) * last).clamp(T::zero(), last);
    let low = position.floor().min(last - T::one());
    let nodes = &table[CUSTOM_INTERVALS + 2..];
    let fraction = position - low;
    T::look_up(nodes, low) * (T::one() - fraction) + T::look_up(&nodes[1..], low) * fraction
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
    let mut table = vec![distance_max as f32];
    table.extend(cumulative.iter().map(|c| (c / total) as f32));
    table.extend(density.iter().map(|f| (f / total) as f32));
    Some(table)
}
