//! Draws from many weights in constant time: alias tables (Walker 1977, Vose 1991), their entries in the rows of a grid.

use crate::optics::real::{Real, Scalar};

/// An entry of an alias table: drawing an entry uniformly, and keeping it or taking its alias, chooses each index in
/// proportion to its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AliasEntry {
    /// The probability, in [0, 1], that a draw of this entry is kept.
    pub threshold: f32,
    /// The entry to take instead when it is not kept.
    pub alias_index: u32,
}

/// Vose's table. An entry of weight 0 is never chosen, unless all are 0: then each is always kept.
pub fn alias_table(weights: &[f64]) -> Vec<AliasEntry> {
    let total: f64 = weights.iter().sum();
    let heaviest = (0..weights.len()).max_by(|&a, &b| weights[a].total_cmp(&weights[b]));
    let entry = |index: usize| {
        // Rounding may leave an entry of weight 0 without a giver.
        let is_kept = weights[index] > 0.0 || total <= 0.0;
        AliasEntry {
            threshold: if is_kept { 1.0 } else { 0.0 },
            alias_index: if is_kept { index } else { heaviest.unwrap_or(index) } as u32,
        }
    };
    let mut entries: Vec<AliasEntry> = (0..weights.len()).map(entry).collect();
    if total <= 0.0 {
        return entries;
    }
    let scale = weights.len() as f64 / total;
    let mut scaled: Vec<f64> = weights.iter().map(|weight| weight * scale).collect();
    let (mut small, mut large): (Vec<u32>, Vec<u32>) =
        (0..weights.len() as u32).partition(|&index| scaled[index as usize] < 1.0);
    while let (Some(&giver), Some(taker)) = (large.last(), small.pop()) {
        let (giver_index, taker_index) = (giver as usize, taker as usize);
        entries[taker_index].threshold = scaled[taker_index] as f32;
        entries[taker_index].alias_index = giver;
        scaled[giver_index] -= 1.0 - scaled[taker_index];
        if scaled[giver_index] < 1.0 {
            large.pop();
            small.push(giver);
        }
    }
    // Entries left in either list are 1 up to rounding, which their thresholds already are.
    entries
}

/// Index of the grid cell (`size` is columns and rows) of a position in [0, 1)², and the position inside it, in [0, 1]². Two
/// numbers select the cell, since one of 24 bits would leave few bits per entry of a large table.
pub fn grid_place<T: Scalar>(xi: [T; 2], size: [u32; 2]) -> (u32, [T; 2]) {
    let (cells, place) = grid_places(xi, size);
    (cells[0], place)
}

/// The same for each lane.
#[inline(always)]
pub fn grid_places<T: Real>(xi: [T; 2], size: [u32; 2]) -> (T::Each<u32>, [T; 2]) {
    let [column, x] = split(xi[0], size[0]);
    let [row, y] = split(xi[1], size[1]);
    let (columns, rows) = (column.to_integers(), row.to_integers());
    let cell = |lane| rows[lane] as u32 * size[0] + columns[lane] as u32;
    (T::each(cell), [x, y])
}

/// The whole and the fractional part of `xi` × `count`, the whole part below `count`.
#[inline(always)]
fn split<T: Real>(xi: T, count: u32) -> [T; 2] {
    let scaled = xi * T::from_f64(f64::from(count));
    let whole = scaled.floor().min(T::from_f64(f64::from(count - 1)));
    [whole, (scaled - whole).min(T::ONE)]
}
